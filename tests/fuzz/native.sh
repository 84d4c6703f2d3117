#!/usr/bin/env bash
# Builds the fuzz target of the native core in build/fuzz and runs it: native.sh SECONDS [CORPUS]
# CXX=clang++ gives libFuzzer; any GCC the driver in native_driver.cpp.
set -euo pipefail
cd "$(dirname "$0")/../.."
cxx=${CXX:-c++} out=build/fuzz
flags=(-std=c++20 -O1 -g -Wall -Wextra -Wshadow -Wconversion -Werror -Wno-psabi -fno-omit-frame-pointer -fno-sanitize-recover=all
  -ffp-contract=off -fno-math-errno -fno-trapping-math -Ifgenv/native)
mkdir -p "$out"

. tests/native_objects.sh

if "$cxx" --version | grep -q clang; then
  watch=(-fsanitize=address,undefined,fuzzer-no-link) link=(-fsanitize=address,undefined,fuzzer)
else
  watch=(-fsanitize=address,undefined -fsanitize-coverage=trace-pc) link=(-fsanitize=address,undefined)
  compile native_driver tests/fuzz/native_driver.cpp
fi
compile native tests/fuzz/native.cpp "${watch[@]}"
compile_core "${watch[@]}"
"$cxx" "${link[@]}" "${objects[@]}" -o "$out/native"
nice -n 10 "$out/native" -max_total_time="$1" "${@:2}"
