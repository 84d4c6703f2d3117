#!/usr/bin/env bash
# Builds the fuzz target of the native core in build/fuzz and runs it: native.sh SECONDS [CORPUS]
# CXX=clang++ gives libFuzzer; any GCC the driver in native_driver.cpp.
set -euo pipefail
cd "$(dirname "$0")/../.."
cxx=${CXX:-c++} out=build/fuzz
flags=(-std=c++20 -O1 -g -Wall -Wextra -Wno-psabi -fno-omit-frame-pointer -fno-sanitize-recover=all
  -ffp-contract=off -fno-math-errno -fno-trapping-math -Ifgenv/native)
objects=()
mkdir -p "$out"

compile() { # compile NAME SOURCE FLAGS...
  local object=$out/$1.o source=$2
  shift 2
  objects+=("$object")
  if [ -e "$object" ] && [ -z "$(find "$source" fgenv/native tests/fuzz/native.sh -newer "$object" -print -quit)" ]; then
    return
  fi
  "$cxx" "${flags[@]}" "$@" -c "$source" -o "$object"
}

if "$cxx" --version | grep -q clang; then
  watch=(-fsanitize=address,undefined,fuzzer-no-link) link=(-fsanitize=address,undefined,fuzzer)
else
  watch=(-fsanitize=address,undefined -fsanitize-coverage=trace-pc) link=(-fsanitize=address,undefined)
  compile native_driver tests/fuzz/native_driver.cpp
fi
compile native tests/fuzz/native.cpp "${watch[@]}"
isas=(baseline)
[ "$(uname -m)" = x86_64 ] && isas+=(v3)
for source in fgenv/native/*.cpp; do
  name=$(basename "$source" .cpp)
  case $name in
    bind_* | arrays | parallel) ;; # the boundary to Python, which the other targets fuzz
    kernel_*)
      for isa in "${isas[@]}"; do
        march=()
        [ "$isa" = v3 ] && march=(-march=x86-64-v3)
        compile "$name-$isa" "$source" -DFGENV_ISA="$isa" "${march[@]}" "${watch[@]}"
      done ;;
    *) compile "$name" "$source" "${watch[@]}" ;;
  esac
done
"$cxx" "${link[@]}" "${objects[@]}" -o "$out/native"
nice -n 10 "$out/native" -max_total_time="$1" "${@:2}"
