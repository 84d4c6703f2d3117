#!/usr/bin/env bash
# Fuzzing: .ci/fuzz.sh [SECONDS], for each target (20 by default). The native target is built with the
# sanitizers; the two of Python need atheris, which has wheels for Linux on x86-64 alone.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20}
tests/fuzz/native.sh "$seconds"
if ! .venv-dev/bin/python -c 'import atheris' 2>/dev/null; then
  echo 'no atheris on this machine: only the native core was fuzzed'
  exit 0
fi
for target in loader queries; do
  PYTHONPATH=tests nice -n 10 .venv-dev/bin/python -m "fuzz.$target" \
    -max_total_time="$seconds" -seed=1 -verbosity=0 -artifact_prefix=build/fuzz/
done
