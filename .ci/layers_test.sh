#!/usr/bin/env bash
# The import contracts fail on planted modules: an import against the layers, and an import cycle.
set -euo pipefail
cd "$(dirname "$0")/.."
clean() { rm -f planners/_planted.py fgenv/envs/_planted.py fgenv/robots/_planted_{a,b}.py; }
trap clean EXIT
refused() { # refused WHAT: lint-imports fails
  if PYTHONPATH=$PWD .venv-dev/bin/lint-imports --no-cache >/dev/null; then
    echo "the contracts accept $1" >&2
    exit 1
  fi
  clean
}
echo 'import fgenv.envs.simulator' >planners/_planted.py
refused 'a planner that imports envs'
echo 'import fgenv.agents.policies.goto' >fgenv/envs/_planted.py
refused 'an environment that imports agents'
echo 'import fgenv.robots._planted_b' >fgenv/robots/_planted_a.py
echo 'import fgenv.robots._planted_a' >fgenv/robots/_planted_b.py
refused 'an import cycle'
echo 'three planted imports were refused'
