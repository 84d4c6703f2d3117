#!/usr/bin/env bash
# Builds race.cpp with the thread sanitizer in build/threads and runs it; then once without locks,
# which must be told. Ends with 0 where this compiler has no thread sanitizer, and says so.
set -euo pipefail
cd "$(dirname "$0")/../.."
cxx=${CXX:-c++} out=build/threads
flags=(-std=c++20 -O1 -g -Wall -Wextra -Wno-psabi -fno-omit-frame-pointer -fsanitize=thread -pthread
  -ffp-contract=off -fno-math-errno -fno-trapping-math -Ifgenv/native)
objects=()
mkdir -p "$out"

echo 'int main() {}' >"$out/empty.cpp"
if ! "$cxx" -fsanitize=thread "$out/empty.cpp" -o "$out/empty" 2>/dev/null; then
  echo "$cxx has no thread sanitizer: races were not looked for"
  exit 0
fi

compile() { # compile NAME SOURCE FLAGS...
  local object=$out/$1.o source=$2
  shift 2
  objects+=("$object")
  if [ -e "$object" ] && [ -z "$(find "$source" fgenv/native tests/threads/race.sh -newer "$object" -print -quit)" ]; then
    return
  fi
  "$cxx" "${flags[@]}" "$@" -c "$source" -o "$object"
}

run() { # the sanitizer wants a plain layout of memory
  local plain=()
  setarch "$(uname -m)" -R true 2>/dev/null && plain=(setarch "$(uname -m)" -R)
  TSAN_OPTIONS="halt_on_error=1 exitcode=66" nice -n 10 "${plain[@]}" timeout 300 "$out/race" "$@"
}

compile race tests/threads/race.cpp
isas=(baseline)
[ "$(uname -m)" = x86_64 ] && isas+=(v3)
for source in fgenv/native/*.cpp; do
  name=$(basename "$source" .cpp)
  case $name in
    bind_* | arrays | parallel) ;; # the boundary to Python
    kernel_*)
      for isa in "${isas[@]}"; do
        march=()
        [ "$isa" = v3 ] && march=(-march=x86-64-v3)
        compile "$name-$isa" "$source" -DFGENV_ISA="$isa" "${march[@]}"
      done ;;
    *) compile "$name" "$source" ;;
  esac
done
"$cxx" -fsanitize=thread -pthread "${objects[@]}" -o "$out/race"
run
status=0
run unlocked >"$out/unlocked.log" 2>&1 || status=$?
if [ "$status" -eq 0 ] || ! grep -q 'data race' "$out/unlocked.log"; then
  echo "without locks no race was told (status $status): see $out/unlocked.log" >&2
  exit 1
fi
echo 'without locks the sanitizer tells a data race, as it should'
