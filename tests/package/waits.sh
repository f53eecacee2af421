#!/bin/bash
# How long the program has threads spin before they sleep, as GNU OpenMP says it, and that those it binds keep all
# their places when it starts again for that, and cases of studies too: waits.sh PROGRAM SCENE FOLDER
set -u
unset OMP_WAIT_POLICY GOMP_SPINCOUNT OMP_PROC_BIND OMP_PLACES GOMP_CPU_AFFINITY
bad=0
spins() {  # WANTED [NAME=VALUE]
  local said
  said=$(env ${2:-NONE=0} OMP_DISPLAY_ENV=verbose "$program" --version 2>&1 | grep SPINCOUNT | tail -1)
  [[ $said == *"'$1'"* ]] || { echo "FAILED with ${2:-nothing set}: $said, not $1"; bad=1; }
}
program=$1 scene=$2 folder=$3
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
# a case does not start again, and tells them once
rm -rf "$folder"
all=$(OMP_DISPLAY_ENV=true OMP_PROC_BIND=true "$program" sweep "$scene" --set run.duration=1e-4 --case 0 -t 1 -o "$folder" \
  2>&1 | grep "OMP_PLACES =" | head -1)
case=$(grep -h "OMP_PLACES =" "$folder"/*/log.txt)
[[ -n $all && $case == "$all" ]] || { echo "FAILED in a case: '$case', not '$all'"; bad=1; }
exit $bad
