#!/bin/bash
# Where memory does not do, the program says so and ends with code 3: memory.sh PROGRAM FOLDER SCENE... [-- SCENE...]
# The limit of address space (ulimit -v) grows from the least under which the program starts, by 3 % at a time, until
# the run goes through; every run before must be refused with a message, never end by a signal. What `epafi check` says
# of the memory is compared with the peak of 2000 steps, also for the scenes behind --: within 20 % and 2 MB.
set -u
program=$1 folder=$2; shift 2
export OMP_WAIT_POLICY=passive
bad=0 refused=0
fail() { echo "FAILED: $*"; bad=$((bad + 1)); }
rm -rf "$folder"; mkdir -p "$folder"
least=20000
until (ulimit -v $least; "$program" list schemes > /dev/null 2>&1); do least=$((least + 1000)); done

grow() {  # SCENE THREADS
  local limit=$least code what
  while :; do
    rm -rf "$folder/run"
    (ulimit -v $limit; exec "$program" run "$1" --steps 50 -q -t "$2" -o "$folder/run") > "$folder/log" 2>&1; code=$?
    [ $code = 0 ] && break
    refused=$((refused + 1))
    what="$(basename "$1"), $2 threads, $limit kB"
    [ $code = 3 ] || fail "$what: exit code $code: $(tail -1 "$folder/log")"
    grep -qiE "memory|threads" "$folder/log" || fail "$what: no word of memory: $(tail -1 "$folder/log")"
    limit=$((limit + limit / 33))
    [ $limit -lt 8000000 ] || { fail "$what: does not go through"; break; }
  done
}

compare() {  # SCENE
  "$program" run "$1" --steps 2000 -q -o "$folder/run" --force > "$folder/log" 2>&1
  local peak said
  peak=$(sed -n 's/.*"peak_memory_bytes": \([0-9]*\).*/\1/p' "$folder/run/summary.json")
  said=$("$program" check "$1" | sed -n 's/.*memory *about \([0-9]*\) MB.*/\1/p')
  echo "$(basename "$1"): said $said MB, peak $((peak / 1000000)) MB"
  awk -v s="$said" -v p="$peak" 'BEGIN { p /= 1e6; exit !(s - p <= 0.2 * p + 2 && p - s <= 0.2 * p + 2) }' ||
    fail "$1: $said MB said, peak $peak bytes"
}

limited=yes
for scene in "$@"; do
  [ "$scene" = -- ] && { limited=; continue; }
  [ -n "$limited" ] && { grow "$scene" 1; grow "$scene" 2; }
  compare "$scene"
done
echo "$refused runs refused, $bad failures"
[ $bad = 0 ]
