#!/bin/bash
# A case of a study may use all places that the threads of the program are bound to: places.sh PROGRAM SCENE FOLDER
set -u
unset OMP_PROC_BIND OMP_PLACES GOMP_CPU_AFFINITY
program=$1 scene=$2 folder=$3
rm -rf "$folder"
all=$(OMP_DISPLAY_ENV=true OMP_PROC_BIND=true \
  "$program" sweep "$scene" --set run.duration=1e-4 --case 0 -t 1 -o "$folder" 2>&1 | grep "OMP_PLACES =" | head -1)
case=$(grep -h "OMP_PLACES =" "$folder"/*/log.txt)
[[ -n $all && $case == "$all" ]] || { echo "FAILED in a case: '$case', not '$all'"; exit 1; }
