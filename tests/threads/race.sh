#!/usr/bin/env bash
# Builds race.cpp with the thread sanitizer in build/threads and runs it; then once without locks,
# which must be told. Ends with 0 where this compiler has no thread sanitizer, and says so.
set -euo pipefail
cd "$(dirname "$0")/../.."
cxx=${CXX:-c++} out=build/threads
flags=(-std=c++20 -O1 -g -Wall -Wextra -Wshadow -Wconversion -Werror -Wno-psabi -fno-omit-frame-pointer -fsanitize=thread -pthread
  -ffp-contract=off -fno-math-errno -fno-trapping-math -Ifgenv/native)
mkdir -p "$out"

echo 'int main() {}' >"$out/empty.cpp"
if ! "$cxx" -fsanitize=thread "$out/empty.cpp" -o "$out/empty" 2>/dev/null; then
  echo "$cxx has no thread sanitizer: races were not looked for"
  exit 0
fi

. tests/native_objects.sh

run() { # the sanitizer wants a plain layout of memory
  local plain=()
  setarch "$(uname -m)" -R true 2>/dev/null && plain=(setarch "$(uname -m)" -R)
  TSAN_OPTIONS="halt_on_error=1 exitcode=66" nice -n 10 "${plain[@]}" timeout 300 "$out/race" "$@"
}

compile race tests/threads/race.cpp
compile_core
"$cxx" -fsanitize=thread -pthread "${objects[@]}" -o "$out/race"
run
status=0
run unlocked >"$out/unlocked.log" 2>&1 || status=$?
if [ "$status" -eq 0 ] || ! grep -q 'data race' "$out/unlocked.log"; then
  echo "without locks no race was told (status $status): see $out/unlocked.log" >&2
  exit 1
fi
echo 'without locks the sanitizer tells a data race, as it should'
