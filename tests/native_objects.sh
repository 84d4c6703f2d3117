# Compiles the native core without its boundary to Python, for drivers in C++; to be sourced with
# `cxx`, `flags` and `out` (a folder) set. `objects` holds what is to be linked.
# Two compilers run at a time, with ccache where it is installed.
objects=() running=0 launcher=()
! command -v ccache >/dev/null || launcher=(ccache)

finish() { # finish N: wait until at most N compilers run; fails if one failed
  while [ "$running" -gt "$1" ]; do
    wait -n
    running=$((running - 1))
  done
}

compile() { # compile NAME SOURCE FLAGS...: once, until a source is newer
  local object=$out/$1.o source=$2
  shift 2
  objects+=("$object")
  if [ -e "$object" ] && [ -z "$(find "$source" fgenv/native tests/native_objects.sh -newer "$object" -print -quit)" ]; then
    return
  fi
  finish 1
  "${launcher[@]}" "$cxx" "${flags[@]}" "$@" -c "$source" -o "$object" &
  running=$((running + 1))
}

compile_core() { # compile_core FLAGS...: each kernel once for each instruction set, as the module has them
  local source name isa march isas=(baseline)
  [ "$(uname -m)" = x86_64 ] && isas+=(v3)
  for source in $(find fgenv/native -name '*.cpp'); do
    name=$(basename "$source" .cpp)
    case ${source#fgenv/native/} in
      bind/*) ;; # the boundary
      */kernel_*)
        for isa in "${isas[@]}"; do
          march=()
          [ "$isa" = v3 ] && march=(-march=x86-64-v3)
          compile "$name-$isa" "$source" -DFGENV_ISA="$isa" "${march[@]}" "$@"
        done ;;
      *) compile "$name" "$source" "$@" ;;
    esac
  done
  finish 0
}
