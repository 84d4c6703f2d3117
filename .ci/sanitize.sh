# Address and undefined-behavior sanitizers; sourced by .ci/run. The module is built a second
# time, into a second environment, and the tests that lean on it run there. GCC's runtimes are
# preloaded because Python itself is built without them; a safe path keeps the sources in this
# folder from hiding the installed module; what a call costs, and what starts Python anew or waits
# for a limit of time, is not asked of such a build.

sanitize() {
  local compiler=${CXX:-c++} asan stdcpp
  local skipped='costs or same_bits or motions_are_equal or refused or kept_waiting'
  skipped+=' or goes_on_while or instruction_set'
  asan=$("$compiler" -print-file-name=libasan.so)
  stdcpp=$("$compiler" -print-file-name=libstdc++.so.6)
  [ -e "$asan" ] || { echo "$compiler has no libasan.so: use GCC (CXX=g++)" >&2; return 1; }
  python3 -m venv .venv-asan &&
    .venv-asan/bin/pip install -q '.[bench,dev,urdf]' \
      --config-settings=build-dir=build/sanitize \
      --config-settings=cmake.build-type=Debug \
      --config-settings=install.strip=false \
      --config-settings=cmake.define.FGENV_WERROR=ON \
      --config-settings=cmake.define.FGENV_SANITIZE=ON &&
    LD_PRELOAD="$asan $stdcpp" \
      ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
      PYTHONMALLOC=malloc PYTHONSAFEPATH=1 \
      .venv-asan/bin/pytest -q -k "not ($skipped)" \
      tests/collision tests/robots/test_{link_motion,robots,world_robots}.py \
      tests/envs/test_simulator.py tests/view/test_painter.py
}
