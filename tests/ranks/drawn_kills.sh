#!/bin/bash
# A run that is killed again and again, one of its processes or all of them at a moment drawn at random, and goes on
# with another number of processes, ends in the state of one that is not:
#   drawn_kills.sh EPAFI EPAFI_MPI FOLDER KILLS SEED ...
set -u
alone=$1 shared=$2 folder=$3 kills=$4; shift 4
here=$(dirname "$0") bad=0 hits=0
. "$here/common.sh"
fail() { echo "FAILED: seed $seed: $*"; bad=1; }
processes_of() { # those of a run in this folder, without mpirun
  ps -eo pid,args |
    awk -v folder="$1 " '/epafi-mpi (run|resume)/ && index($0 " ", folder) && !/mpirun|awk/ { print $1 }'
}
saved() { [ -f "$out/checkpoint.h5" ]; }
is_met() { saved && [ -n "$(processes_of "$out")" ]; }
# Starts the run, or goes on with it, on so many ranks, the rest as options.
go_on() {
  local ranks=$1; shift
  if saved; then on_ranks "$ranks" 1 "$shared" resume "$out" --until $until --quiet "$@"
  else on_ranks "$ranks" 1 "$shared" run "$scene" --until $until --quiet --force -o "$out" "$@"
  fi > "$folder/log" 2>&1
}
until=0.08 # before the end of every drawn scene: a resumed run may go beyond it
patience=40 # mpirun may wait for ever where all of its processes died at once
rm -rf "$folder"; mkdir -p "$folder"; cp "$here/net.obj" "$folder"
for seed in "$@"; do
  RANDOM=$seed scene=$folder/$seed.toml out=$folder/$seed
  awk -v seed="$seed" -f "$here/draw_scene.awk" |
    sed 's/checkpoint_interval = 0.02/checkpoint_interval = 0.002/' > "$scene"
  OMP_NUM_THREADS=1 "$alone" run "$scene" --until $until --quiet -o "$folder/alone_$seed" > "$folder/log" 2>&1 ||
    { fail "alone: $(tail -1 "$folder/log")"; continue; }
  for _ in $(seq "$kills"); do
    go_on $((2 + RANDOM % 3)) &
    starter=$!
    for _ in $(seq 200); do is_met && break; kill -0 $starter 2> /dev/null || break; sleep 0.02; done
    sleep 0.$((RANDOM % 4))
    mapfile -t all < <(processes_of "$out")
    if [ ${#all[@]} -gt 0 ]; then
      hits=$((hits + 1))
      if [ $((RANDOM % 2)) -eq 0 ]; then kill -KILL "${all[@]}"; else kill -KILL "${all[RANDOM % ${#all[@]}]}"; fi
    fi 2> /dev/null
    wait $starter
  done
  left=$(processes_of "$out" | wc -l)
  [ "$left" -eq 0 ] || fail "$left processes are left"
  ranks=$((1 + RANDOM % 4))
  go_on $ranks || fail "to the end on $ranks: $(tail -1 "$folder/log")"
  [ "$(hash_of "$out")" = "$(hash_of "$folder/alone_$seed")" ] || fail "another state after $ranks ranks"
done
echo "$hits of $(($# * kills)) kills met a run"
[ $hits -gt 0 ] || { echo "FAILED: no run was killed"; bad=1; }
exit $bad
