#!/usr/bin/env bash
# The tests of the native core under the address and undefined-behavior sanitizers. The module is built a
# second time, for an environment that borrows the packages of .venv-dev. GCC's runtimes are preloaded
# because Python itself is built without them; a safe path keeps the sources in this folder from hiding the
# installed module. Tests with the marker `unsanitized` measure memory or start Python without the preload.
set -euo pipefail
cd "$(dirname "$0")/.."
compiler=${CXX:-c++}
asan=$("$compiler" -print-file-name=libasan.so)
stdcpp=$("$compiler" -print-file-name=libstdc++.so.6)
[ -e "$asan" ] || { echo "$compiler has no libasan.so: use GCC (CXX=g++)" >&2; exit 1; }

rm -rf .venv-asan
python3 -m venv .venv-asan
packages=$(.venv-dev/bin/python -c 'import sys; print(*(p for p in sys.path if "site-packages" in p), sep="\n")')
echo "$packages" >"$(.venv-asan/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/borrowed.pth"
.venv-asan/bin/pip install -q --no-deps . \
  --config-settings=build-dir=build/sanitize \
  --config-settings=cmake.build-type=Debug \
  --config-settings=install.strip=false \
  --config-settings=cmake.define.FGENV_SANITIZE=ON

LD_PRELOAD="$asan $stdcpp" \
  ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
  PYTHONMALLOC=malloc PYTHONSAFEPATH=1 \
  .venv-asan/bin/python -m pytest -q -n 2 -m 'native and not slow and not nightly and not unsanitized' --durations=20
