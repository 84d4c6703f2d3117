#!/usr/bin/env bash
# The import contracts fail on a planted import: planners must not import envs, nor envs the agents.
set -euo pipefail
cd "$(dirname "$0")/.."
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
mkdir "$copy/fgenv"
cp -rL fgenv/*.py fgenv/{collision,robots,scenarios,envs,planners,agents,paper,view,bench,cli,testing} "$copy/fgenv/"
cp pyproject.toml "$copy/"
plant() { # plant FILE IMPORT
  echo "import $2" >>"$copy/$1"
  if (cd "$copy" && PYTHONPATH=$copy "$OLDPWD/.venv-dev/bin/lint-imports" --no-cache >/dev/null); then
    echo "the contracts accept 'import $2' in $1" >&2
    exit 1
  fi
  cp -L "${1}" "$copy/$1"
}
plant fgenv/planners/problem.py fgenv.envs.simulator
plant fgenv/envs/rewards.py fgenv.agents.policies.goto
plant fgenv/robots/configuration_space.py fgenv.robots.robot
echo 'three planted imports were refused'
