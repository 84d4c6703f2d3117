#!/usr/bin/env bash
# Compiles the core with clang's warnings as errors, without code generation. Without clang, says so.
# -Wno-sign-conversion: with GCC, -Wconversion does not include it; indices are int32_t throughout.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v clang++ >/dev/null || { echo 'no clang++ on this machine: its warnings were not looked at'; exit 0; }
python=.venv-dev/bin/python
flags=$("$python" -c 'import nanobind, sysconfig; print("-isystem", nanobind.include_dir(), "-isystem", sysconfig.get_path("include"))')
git ls-files 'fgenv/native/*.cpp' | xargs -P 2 -n 4 clang++ -std=c++20 -fsyntax-only -DFGENV_ISA=baseline -Ifgenv/native \
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Werror -Wno-psabi $flags
echo "clang++ has no warning in $(git ls-files 'fgenv/native/*.cpp' | wc -l) files"
