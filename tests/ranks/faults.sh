#!/bin/bash
# What goes wrong on several ranks ends all of them with the right code: faults.sh EPAFI EPAFI_MPI FOLDER BED IMPULSES
set -u
alone=$1 shared=$2 folder=$3 bed=$4 impulses=$5
. "$(dirname "$0")/common.sh"
bad=0
fail() { echo "FAILED: $*"; bad=1; }
small=(--set params.n=200)
rm -rf "$folder"; mkdir -p "$folder"
"$alone" run "$bed" "${small[@]}" --steps 300 --quiet -t 1 -o "$folder/straight" 2> "$folder/log" || fail "the straight run: $(tail -1 "$folder/log")"
want=$(hash_of "$folder/straight")

# cut off on two ranks, gone on with on three, then by one process
on_ranks 2 1 "$shared" run "$bed" "${small[@]}" --steps 100 --quiet -o "$folder/cut" > "$folder/log" 2>&1 || fail "cut run: $(tail -1 "$folder/log")"
on_ranks 3 1 "$shared" resume "$folder/cut" --steps 100 --quiet > "$folder/log" 2>&1 || fail "resumed on three: $(tail -1 "$folder/log")"
"$alone" resume "$folder/cut" --steps 100 --quiet -t 1 > "$folder/log" 2>&1 || fail "resumed alone: $(tail -1 "$folder/log")"
[ "$(hash_of "$folder/cut")" = "$want" ] || fail "after 2, 3 and 1 ranks: state $(hash_of "$folder/cut"), straight $want"
"$alone" export "$folder/cut" --format csv > /dev/null 2>&1 || fail "run.h5 of several ranks cannot be read"

# the same where impulses are found for all contacts together
"$alone" run "$impulses" --steps 200 --quiet -t 1 -o "$folder/struck" 2> "$folder/log" || fail "impulses, straight: $(tail -1 "$folder/log")"
on_ranks 2 1 "$shared" run "$impulses" --steps 70 --quiet -o "$folder/struck2" > "$folder/log" 2>&1 || fail "impulses on two: $(tail -1 "$folder/log")"
on_ranks 3 1 "$shared" resume "$folder/struck2" --steps 60 --quiet > "$folder/log" 2>&1 || fail "impulses on three: $(tail -1 "$folder/log")"
"$alone" resume "$folder/struck2" --steps 70 --quiet -t 1 > "$folder/log" 2>&1 || fail "impulses alone: $(tail -1 "$folder/log")"
[ "$(hash_of "$folder/struck2")" = "$(hash_of "$folder/struck")" ] || fail "impulses after 2, 3 and 1 ranks: another state"

# cut in each of three stages, gone on with on other numbers; changed by a resume
acts=$(dirname "$0")/acts.toml
"$alone" run "$acts" --quiet -t 1 -o "$folder/acts" 2> "$folder/log" || fail "acts, straight: $(tail -1 "$folder/log")"
on_ranks 2 1 "$shared" run "$acts" --steps 50 --quiet -o "$folder/acts2" > "$folder/log" 2>&1 || fail "acts on two: $(tail -1 "$folder/log")"
on_ranks 3 1 "$shared" resume "$folder/acts2" --steps 90 --quiet > "$folder/log" 2>&1 || fail "acts on three: $(tail -1 "$folder/log")"
on_ranks 2 1 "$shared" resume "$folder/acts2" --steps 100 --quiet > "$folder/log" 2>&1 || fail "acts on two again: $(tail -1 "$folder/log")"
"$alone" resume "$folder/acts2" --quiet -t 1 > "$folder/log" 2>&1 || fail "acts alone: $(tail -1 "$folder/log")"
[ "$(hash_of "$folder/acts2")" = "$(hash_of "$folder/acts")" ] || fail "acts after 2, 3, 2 and 1 ranks: another state"
change=(--set world.gravity=[0,0,-5] --until 0.02 --quiet)
"$alone" resume "$folder/acts" -t 1 "${change[@]}" > "$folder/log" 2>&1 || fail "changed alone: $(tail -1 "$folder/log")"
on_ranks 3 1 "$shared" resume "$folder/acts2" "${change[@]}" > "$folder/log" 2>&1 || fail "changed on three: $(tail -1 "$folder/log")"
[ "$(hash_of "$folder/acts2")" = "$(hash_of "$folder/acts")" ] || fail "acts, changed: another state"

# springs, and a cell that follows its pressure
for scene in springs pressed_cell; do
  "$alone" run "$(dirname "$0")/$scene.toml" --quiet -t 1 -o "$folder/$scene" 2> "$folder/log" || fail "$scene, straight: $(tail -1 "$folder/log")"
  on_ranks 2 1 "$shared" run "$(dirname "$0")/$scene.toml" --steps 300 --quiet -o "$folder/${scene}_2" > "$folder/log" 2>&1 || fail "$scene on two: $(tail -1 "$folder/log")"
  on_ranks 3 1 "$shared" resume "$folder/${scene}_2" --steps 350 --quiet > "$folder/log" 2>&1 || fail "$scene on three: $(tail -1 "$folder/log")"
  "$alone" resume "$folder/${scene}_2" --quiet -t 1 > "$folder/log" 2>&1 || fail "$scene alone: $(tail -1 "$folder/log")"
  [ "$(hash_of "$folder/${scene}_2")" = "$(hash_of "$folder/$scene")" ] || fail "$scene after 2, 3 and 1 ranks: another state"
done

# a wrong scene, one message of rank 0, exit code 2
rails=$(dirname "$bed")/../wheel_rail/curve.toml
on_ranks 3 1 "$shared" run "$rails" -o "$folder/refused" > "$folder/log" 2>&1
[ $? -eq 2 ] || fail "a scene that is refused: exit code $?"
[ "$(grep -c 'curve.toml:[0-9]*:[0-9]*: error: .* over several processes; take threads: .* without `mpi N`, with -t N' "$folder/log")" -ge 1 ] \
  || fail "no line that refuses: $(cat "$folder/log")"
for threads in 1 2; do  # what the line tells to take
  "$alone" run "$rails" --steps 20 -t $threads --quiet -o "$folder/rails$threads" > "$folder/log" 2>&1 || fail "refused scene alone: $(cat "$folder/log")"
done
[ "$(hash_of "$folder/rails1")" = "$(hash_of "$folder/rails2")" ] || fail "threads do not give the bits of one"
on_ranks 3 1 "$shared" run "$folder/absent.toml" > "$folder/log" 2>&1
code=$?
"$alone" run "$folder/absent.toml" > /dev/null 2>&1
[ $code -eq $? ] || fail "a scene that is not there: exit code $code"

# more ranks than bodies
cat > "$folder/two.toml" <<SCENE
run = { duration = 0.004, time_step = 1e-5 }
world = { gravity = [0, 0, -9.81] }
material.m = { density = 1000.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.6, friction = 0.5, smooth = { law = "hertz-mindlin" } }
[[body]]
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
[[body]]
shape = { sphere = { radius = 0.01 } }
material = "m"
position = [0, 0, 0.0101]
velocity = [0.4, 0, -0.5]
[[body]]
shape = { sphere = { radius = 0.01 } }
material = "m"
position = [0.021, 0, 0.0101]
SCENE
"$alone" run "$folder/two.toml" --quiet -t 1 -o "$folder/two" 2> "$folder/log" || fail "two spheres: $(tail -1 "$folder/log")"
on_ranks 4 1 "$shared" run "$folder/two.toml" --quiet -o "$folder/four" > "$folder/log" 2>&1 || fail "two spheres on four ranks: $(tail -1 "$folder/log")"
[ "$(hash_of "$folder/four")" = "$(hash_of "$folder/two")" ] || fail "two spheres on four ranks: another state"

# a body leaves the domain: exit code 4, the state is saved
sed 's/^world = .*/world = { gravity = [0, 0, -9.81], domain = { min = [-0.1, -0.1, 0], max = [0.0005, 0.1, 1] } }/' "$folder/two.toml" > "$folder/lost.toml"
sed -i 's/position = \[0.021/position = [-0.021/' "$folder/lost.toml"
"$alone" run "$folder/lost.toml" --quiet -t 1 -o "$folder/lost1" > "$folder/lost1.log" 2>&1
code=$?
[ $code -eq 4 ] || fail "the program alone loses a body: exit code $code: $(tail -1 "$folder/lost1.log")"
on_ranks 3 1 "$shared" run "$folder/lost.toml" --quiet -o "$folder/lost3" > "$folder/lost3.log" 2>&1
code=$?
[ $code -eq 4 ] || fail "a lost body: exit code $code"
[ "$(grep -c 'left the domain in step' "$folder/lost3.log")" = 1 ] || fail "a lost body is told once: $(cat "$folder/lost3.log")"
[ "$(grep 'left the domain' "$folder/lost1.log")" = "$(grep 'left the domain' "$folder/lost3.log")" ] || fail "the message is another one"
[ -f "$folder/lost3/checkpoint.h5" ] || fail "a lost body: no checkpoint"

# a killed rank ends the run; its checkpoint goes on elsewhere with the same bits
on_ranks 3 1 "$shared" run "$bed" "${small[@]}" --set run.checkpoint_interval=0.01 --quiet -o "$folder/killed" > "$folder/log" 2>&1 &
starter=$!
for _ in $(seq 200); do [ -f "$folder/killed/checkpoint.h5" ] && break; sleep 0.1; done
victim=$(ps -eo pid,ppid,args | awk -v folder="$folder/killed" '$0 ~ "epafi-mpi run" && index($0, folder) && !/mpirun/ { print $1 }' | tail -1)
[ -n "$victim" ] && kill -KILL "$victim"
wait $starter
code=$?
[ $code -ne 0 ] || fail "a killed rank: exit code 0"
left=$(ps -eo args | awk -v folder="$folder/killed" '$0 ~ "epafi-mpi run" && index($0, folder) && !/awk/' | wc -l)
[ "$left" -eq 0 ] || fail "$left processes are left of a run with a killed rank"
on_ranks 2 1 "$shared" resume "$folder/killed" --quiet --steps 1 > "$folder/log" 2>&1 || fail "a killed run cannot be resumed: $(tail -1 "$folder/log")"
at=$(sed -n 's/.*"steps": \([0-9]*\),.*/\1/p' "$folder/killed/summary.json" | head -1)
"$alone" run "$bed" "${small[@]}" --set run.checkpoint_interval=0.01 --steps "$at" --quiet -t 1 -o "$folder/same" > "$folder/log" 2>&1
[ "$(hash_of "$folder/killed")" = "$(hash_of "$folder/same")" ] || fail "a killed run, resumed to step $at: another state"
exit $bad
