#!/bin/bash
# The same bits on any number of ranks and threads:
#   same_bits.sh EPAFI EPAFI_MPI FOLDER "RANKSxTHREADS ..." STEPS SCENE [KEY=VALUE ...]
# State hash, rows of measures, frames and run.h5 of mpirun are those of the program alone.
set -u
alone=$1 shared=$2 folder=$3 cases=$4 steps=$5 scene=$6; shift 6
. "$(dirname "$0")/common.sh"
# Rows of measures to the byte; those of the ledger that processes sum up contact by contact to ten digits
# of the energies.
same_rows() {
  local by_contact=',energy,(elastic|dissipated|work|relative_error|viscous|frictional|plastic|adhesive),'
  [ -f "$1" ] || return 0
  cmp <(grep -vE "$by_contact" "$1") <(grep -vE "$by_contact" "$2") || return 1
  paste -d, <(grep -E "$by_contact" "$1") <(grep -E "$by_contact" "$2") |
    awk -F, '{ # relative_error is a difference of energies over the largest
               bound = $3 == "relative_error" ? 1e-26 : 1e-20 * ($4 ^ 2 + $8 ^ 2)
               if ($3 != $7 || ($4 - $8) ^ 2 > bound) { print; bad = 1 } } END { exit bad }'
}
changes=()
for change in "$@"; do changes+=(--set "$change"); done
rm -rf "$folder"; mkdir -p "$folder"
OMP_NUM_THREADS=1 "$alone" run "$scene" --steps "$steps" "${changes[@]}" --quiet -o "$folder/alone" 2> "$folder/log" ||
  { cat "$folder/log"; exit 1; }
want=$(hash_of "$folder/alone")
bad=0
for case in $cases; do
  ranks=${case%x*} threads=${case#*x}
  on_ranks "$ranks" "$threads" "$shared" run "$scene" --steps "$steps" "${changes[@]}" --quiet -o "$folder/$case" \
    > "$folder/$case.log" 2>&1 || { echo "FAILED: $case: exit code $?"; tail -5 "$folder/$case.log"; bad=1; continue; }
  have=$(hash_of "$folder/$case")
  echo "$case $have $(ranks_of "$folder/$case")"
  [ "$have" = "$want" ] || { echo "FAILED: $case: state $have, alone $want"; bad=1; }
  same_rows "$folder/alone/measures.csv" "$folder/$case/measures.csv" ||
    { echo "FAILED: $case: rows of measures"; bad=1; }
  diff -rq "$folder/alone/frames" "$folder/$case/frames" || bad=1
  if cmp -s "$folder/alone/measures.csv" "$folder/$case/measures.csv"; then
    cmp "$folder/alone/run.h5" "$folder/$case/run.h5" || bad=1
  fi
done
exit $bad
