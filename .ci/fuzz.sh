# Fuzzing for about a minute; sourced by .ci/run. Each target's first lines tell how to run it for
# longer. The native target is built with the sanitizers; the two of Python need atheris, which has
# wheels for Linux on x86-64 alone.

fuzz() {
  local target
  tests/fuzz/native.sh 20 || return 1
  if ! "$bin/python" -c 'import atheris' 2>/dev/null; then
    echo 'no atheris on this machine: only the native core was fuzzed'
    return 0
  fi
  for target in loader queries; do
    PYTHONPATH=tests nice -n 10 "$bin/python" -m "fuzz.$target" \
      -max_total_time=20 -seed=1 -verbosity=0 -artifact_prefix=build/fuzz/ || return 1
  done
}
