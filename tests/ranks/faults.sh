#!/bin/bash
# What goes wrong on several ranks ends all of them with the right code: faults.sh EPAFI EPAFI_MPI FOLDER BED IMPULSES
set -u
alone=$1 shared=$2 folder=$3 bed=$4 impulses=$5
. "$(dirname "$0")/common.sh"
bad=0
fail() { echo "FAILED: $*"; bad=1; }
try() { # what it is called, the command: succeeds, or its last line is told
  local what=$1; shift
  "$@" > "$folder/log" 2>&1 || fail "$what: $(tail -1 "$folder/log")"
}
one() { try "$1" "$alone" "${@:2}" --quiet -t 1; }
many() { try "$1" on_ranks "$2" 1 "$shared" "${@:3}" --quiet; }
same() { # two runs, what is told of others
  [ "$(hash_of "$folder/$1")" = "$(hash_of "$folder/$2")" ] || fail "$3: another state"
}
small=(--set params.n=200)
rm -rf "$folder"; mkdir -p "$folder"
one "the straight run" run "$bed" "${small[@]}" --steps 300 -o "$folder/straight"

# cut off on two ranks, gone on with on three, then by one process
many "cut run" 2 run "$bed" "${small[@]}" --steps 100 -o "$folder/cut"
many "resumed on three" 3 resume "$folder/cut" --steps 100
one "resumed alone" resume "$folder/cut" --steps 100
same cut straight "after 2, 3 and 1 ranks"
try "run.h5 of several ranks" "$alone" export "$folder/cut" --format csv

# the same where impulses are found for all contacts together
one "impulses, straight" run "$impulses" --steps 200 -o "$folder/struck"
many "impulses on two" 2 run "$impulses" --steps 70 -o "$folder/struck2"
many "impulses on three" 3 resume "$folder/struck2" --steps 60
one "impulses alone" resume "$folder/struck2" --steps 70
same struck2 struck "impulses after 2, 3 and 1 ranks"

# cut in each of three stages, gone on with on other numbers; changed by a resume
acts=$(dirname "$0")/acts.toml
one "acts, straight" run "$acts" -o "$folder/acts"
many "acts on two" 2 run "$acts" --steps 50 -o "$folder/acts2"
many "acts on three" 3 resume "$folder/acts2" --steps 90
many "acts on two again" 2 resume "$folder/acts2" --steps 100
one "acts alone" resume "$folder/acts2"
same acts2 acts "acts after 2, 3, 2 and 1 ranks"
change=(--set world.gravity=[0,0,-5] --until 0.02)
one "changed alone" resume "$folder/acts" "${change[@]}"
many "changed on three" 3 resume "$folder/acts2" "${change[@]}"
same acts2 acts "acts, changed"

# springs, and a cell that follows its pressure
for scene in springs pressed_cell; do
  file=$(dirname "$0")/$scene.toml
  one "$scene, straight" run "$file" -o "$folder/$scene"
  many "$scene on two" 2 run "$file" --steps 300 -o "$folder/${scene}_2"
  many "$scene on three" 3 resume "$folder/${scene}_2" --steps 350
  one "$scene alone" resume "$folder/${scene}_2"
  same ${scene}_2 $scene "$scene after 2, 3 and 1 ranks"
done

# a wrong scene, one message of rank 0, exit code 2
rails=$(dirname "$bed")/../wheel_rail/curve.toml
on_ranks 3 1 "$shared" run "$rails" -o "$folder/refused" > "$folder/log" 2>&1
[ $? -eq 2 ] || fail "a scene that is refused: exit code $?"
refusal='curve.toml:[0-9]*:[0-9]*: error: .* over several processes; take threads: .* without `mpi N`, with -t N'
grep -q "$refusal" "$folder/log" || fail "no line that refuses: $(cat "$folder/log")"
for threads in 1 2; do  # what the line tells to take
  try "refused scene alone" "$alone" run "$rails" --steps 20 -t $threads --quiet -o "$folder/rails$threads"
done
same rails1 rails2 "refused scene by one and two threads"
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
one "two spheres" run "$folder/two.toml" -o "$folder/two"
many "two spheres on four ranks" 4 run "$folder/two.toml" -o "$folder/four"
same four two "two spheres on four ranks"

# a body leaves the domain: exit code 4, the state is saved
sed 's/^\(world = { .*\) }$/\1, domain = { min = [-0.1, -0.1, 0], max = [0.0005, 0.1, 1] } }/' \
  "$folder/two.toml" > "$folder/lost.toml"
sed -i 's/position = \[0.021/position = [-0.021/' "$folder/lost.toml"
"$alone" run "$folder/lost.toml" --quiet -t 1 -o "$folder/lost1" > "$folder/lost1.log" 2>&1
code=$?
[ $code -eq 4 ] || fail "the program alone loses a body: exit code $code: $(tail -1 "$folder/lost1.log")"
on_ranks 3 1 "$shared" run "$folder/lost.toml" --quiet -o "$folder/lost3" > "$folder/lost3.log" 2>&1
code=$?
[ $code -eq 4 ] || fail "a lost body: exit code $code"
[ "$(grep -c 'left the domain in step' "$folder/lost3.log")" = 1 ] ||
  fail "a lost body is told once: $(cat "$folder/lost3.log")"
cmp <(grep 'left the domain' "$folder/lost1.log") <(grep 'left the domain' "$folder/lost3.log") ||
  fail "the message is another one"
[ -f "$folder/lost3/checkpoint.h5" ] || fail "a lost body: no checkpoint"

# a killed rank ends the run; its checkpoint goes on elsewhere with the same bits
long=("${small[@]}" --set run.checkpoint_interval=0.01)
on_ranks 3 1 "$shared" run "$bed" "${long[@]}" --quiet -o "$folder/killed" > "$folder/log" 2>&1 &
starter=$!
for _ in $(seq 200); do [ -f "$folder/killed/checkpoint.h5" ] && break; sleep 0.1; done
victim=$(ps -eo pid,args | awk -v folder="$folder/killed" '
  $0 ~ "epafi-mpi run" && index($0, folder) && !/mpirun/ { print $1 }' | tail -1)
[ -n "$victim" ] && kill -KILL "$victim"
wait $starter
code=$?
[ $code -ne 0 ] || fail "a killed rank: exit code 0"
left=$(ps -eo args | awk -v folder="$folder/killed" '$0 ~ "epafi-mpi run" && index($0, folder) && !/awk/' | wc -l)
[ "$left" -eq 0 ] || fail "$left processes are left of a run with a killed rank"
many "a killed run, resumed" 2 resume "$folder/killed" --steps 1
at=$(sed -n 's/.*"steps": \([0-9]*\),.*/\1/p' "$folder/killed/summary.json" | head -1)
one "a run to step $at" run "$bed" "${long[@]}" --steps "$at" -o "$folder/same"
same killed same "a killed run, resumed to step $at"
exit $bad
