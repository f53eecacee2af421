#!/bin/bash
# Runs that are cut off go on as if they had not been: faults.sh PROGRAM FOLDER STEPS SCENE...
# Each scene is run for STEPS steps straight, and again with SIGINT, SIGTERM and SIGKILL at random times (three each), a
# time limit and a full disk; every cut run is resumed to the end. State hash, energies, measures.csv, the frames and
# the snapshots of run.h5 must be equal.
set -u
program=$1 folder=$2 steps=$3; shift 3
export OMP_WAIT_POLICY=passive
bad=0 cuts=0
say() { echo "$*"; }
fail() { say "FAILED: $*"; bad=$((bad + 1)); }
hash_of() { sed -n 's/.*"state_hash": "\([0-9a-f]*\)".*/\1/p' "$1/summary.json" 2>/dev/null; }
energies_of() { grep -A8 '"energy": {' "$1/summary.json" | grep -E 'kinetic|potential|elastic|dissipated|"work"'; }

finish() { # folder: resumes until the run is whole
  local tries=0
  while [ $tries -lt 5 ]; do
    "$program" resume "$1" --until "$end" --quiet > "$1.log" 2>&1 && return 0
    tries=$((tries + 1))
  done
  return 1
}
compare() { # what, folder
  local have want
  have=$(hash_of "$2") want=$(hash_of "$folder/straight")
  [ "$have" = "$want" ] || { fail "$1: hash $have, straight $want"; return; }
  [ "$(energies_of "$2")" = "$(energies_of "$folder/straight")" ] || fail "$1: energies differ"
  [ ! -f "$folder/straight/measures.csv" ] || cmp -s "$2/measures.csv" "$folder/straight/measures.csv" ||
    fail "$1: measures.csv differs"
  diff -rq "$2/frames" "$folder/straight/frames" > "$2.diff" 2>&1 || fail "$1: frames differ: $(head -1 "$2.diff")"
  cmp -s "$2/frames.pvd" "$folder/straight/frames.pvd" || fail "$1: frames.pvd differs"
  "$program" export "$2" --format csv > "$2.log" 2>&1 || fail "$1: run.h5 cannot be read: $(tail -1 "$2.log")"
  cmp -s "$2/snapshots.csv" "$folder/straight.csv" || fail "$1: the snapshots of run.h5 differ"
}

for scene in "$@"; do
  rm -rf "$folder"; mkdir -p "$folder"
  begin=$(date +%s%N)
  "$program" run "$scene" --steps "$steps" --quiet -o "$folder/straight" > "$folder/log" 2>&1 ||
    { fail "$scene: straight run: $(tail -1 "$folder/log")"; continue; }
  cp "$folder/straight/measures.csv" "$folder/kept.csv" 2>/dev/null
  "$program" export "$folder/straight" --format csv > /dev/null 2>&1
  mv "$folder/straight/snapshots.csv" "$folder/straight.csv"
  mv "$folder/kept.csv" "$folder/straight/measures.csv" 2>/dev/null
  span=$((($(date +%s%N) - begin) / 1000000))
  end=$(sed -n 's/.*"simulated_time": \([0-9.e+-]*\).*/\1/p' "$folder/straight/summary.json" | head -1)
  dt=$(sed -n 's/.*"time_step": \([0-9.e+-]*\).*/\1/p' "$folder/straight/summary.json" | head -1)
  often=$(awk "BEGIN { print $dt * ($steps < 20 ? 1 : int($steps / 20)) }")
  for signal in INT TERM KILL; do
    for turn in 1 2 3; do
      out=$folder/cut_${signal}_$turn what="$scene, SIG$signal $turn"
      "$program" run "$scene" --steps "$steps" --quiet -o "$out" --set "run.checkpoint_interval=$often" \
        > "$out.log" 2>&1 &
      pid=$!
      sleep "$(awk -v s=$span -v r=$RANDOM 'BEGIN { printf "%.3f", 0.001 * s * (0.1 + 0.8 * r / 32768) }')"
      kill -s $signal $pid 2>/dev/null
      wait $pid 2>/dev/null; code=$?
      cuts=$((cuts + (code != 0)))
      case $signal-$code in
        *-0|INT-130|TERM-143|KILL-137) ;;
        *) fail "$what: exit code $code: $(tail -1 "$out.log")" ;;
      esac
      if [ ! -f "$out/checkpoint.h5" ]; then # killed before the first: says so, and a new run is needed
        [ $signal = KILL ] || [ ! -f "$out/run.h5" ] || fail "$what: no checkpoint" # or cut while it was read
        "$program" resume "$out" --quiet > "$out.log" 2>&1 && fail "$what: resumed without a checkpoint"
        continue
      fi
      [ $code = 0 ] || finish "$out" || fail "$what: not resumed: $(tail -1 "$out.log")"
      compare "$what" "$out"
    done
  done
  out=$folder/limited
  "$program" run "$scene" --steps "$steps" --quiet -o "$out" --time-limit 1s > "$out.log" 2>&1; code=$?
  [ $code = 0 ] || [ $code = 75 ] || fail "$scene, time limit: exit code $code"
  [ $code = 0 ] || finish "$out" || fail "$scene, time limit: not resumed"
  compare "$scene, time limit" "$out"
  disk=$folder/disk; mkdir -p "$disk"
  if mount -t tmpfs -o size=300k tmpfs "$disk" 2>/dev/null; then
    "$program" run "$scene" --steps "$steps" --quiet -o "$disk/run" --set "run.checkpoint_interval=$often" \
      > "$folder/disk.log" 2>&1
    code=$?
    if [ $code != 0 ]; then
      [ $code = 3 ] || fail "$scene, full disk: exit code $code: $(tail -1 "$folder/disk.log")"
      grep -qiE "space|full" "$folder/disk.log" ||
        fail "$scene, full disk: no word of it: $(tail -1 "$folder/disk.log")"
      mount -o remount,size=200m "$disk"
      if [ -f "$disk/run/checkpoint.h5" ]; then
        "$program" resume "$disk/run" --until "$end" --quiet > "$folder/disk.log" 2>&1 ||
          fail "$scene, full disk: not resumed: $(tail -1 "$folder/disk.log")"
        compare "$scene, full disk" "$disk/run"
      fi
    fi
    umount "$disk"
  else
    say "$scene: no disk to fill here (mount refused)"
  fi
done
say "$cuts runs cut off, $bad failures"
[ $bad = 0 ]
