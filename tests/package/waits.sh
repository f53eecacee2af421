#!/bin/bash
# How long the program has threads spin before they sleep, as GNU OpenMP says it, and that those it binds keep all
# their places when it starts again for that: waits.sh PROGRAM
set -u
unset OMP_WAIT_POLICY GOMP_SPINCOUNT OMP_PROC_BIND OMP_PLACES GOMP_CPU_AFFINITY
bad=0
spins() {  # WANTED [NAME=VALUE]
  local said
  said=$(env ${2:-NONE=0} OMP_DISPLAY_ENV=verbose "$program" --version 2>&1 | grep SPINCOUNT | tail -1)
  [[ $said == *"'$1'"* ]] || { echo "FAILED with ${2:-nothing set}: $said, not $1"; bad=1; }
}
program=$1
spins 10000
spins 77 GOMP_SPINCOUNT=77
spins 0 OMP_WAIT_POLICY=passive
keeps_places() {  # NAME=VALUE
  local said
  said=$(env OMP_DISPLAY_ENV=true "$1" "$program" --version 2>&1 | grep "OMP_PLACES =")
  [[ $(wc -l <<<"$said") == 2 && $(sort -u <<<"$said" | wc -l) == 1 ]] ||
    { echo "FAILED with $1, before and after:"; echo "$said"; bad=1; }
}
keeps_places OMP_PROC_BIND=true
keeps_places GOMP_CPU_AFFINITY="$(taskset -cp $$ | sed 's/.*: //')"
exit $bad
