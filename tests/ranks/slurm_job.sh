#!/bin/bash
# docs/ranks.sbatch starts a run, starts it again where a job died before its first checkpoint, resumes it after one,
# and leaves time for the last checkpoint: slurm_job.sh EPAFI EPAFI_MPI FOLDER SCRIPT SCENE. Slurm's options of mpirun
# are recorded, two processes run.
set -u
alone=$1 shared=$2 folder=$3 script=$4 scene=$5
. "$(dirname "$0")/common.sh"
bad=0
fail() { echo "FAILED: $*"; bad=1; }
rm -rf "$folder"; mkdir -p "$folder/bin"
export REAL_MPIRUN EPAFI_MPI=$shared RECORD=$folder/record
REAL_MPIRUN=$(command -v mpirun)
cat > "$folder/bin/mpirun" <<'STANDIN'
#!/bin/bash
echo "$@" >> "$RECORD"
while [ "$1" != epafi-mpi ]; do shift; done
shift
OMP_NUM_THREADS=1 exec "$REAL_MPIRUN" --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 -n 2 "$EPAFI_MPI" "$@"
STANDIN
chmod +x "$folder/bin/mpirun"
export PATH=$folder/bin:$PATH
sed 's/duration = 0.4/duration = 0.01/; s/n = 10000/n = 100/' "$scene" > "$folder/bed.toml"
cd "$folder" || exit 1
job() { # seconds that the job may last
  SLURM_CPUS_PER_TASK=3 SLURM_JOB_END_TIME=$(($(date +%s) + $1)) bash "$script" bed.toml > log 2>&1 ||
    fail "the job: $(tail -2 log)"
}
job 2400
grep -q "slot:PE=3 .* epafi-mpi run bed.toml -o out/bed --force --quiet --time-limit 2[23][0-9][0-9]s" record ||
  fail "first job: $(tail -1 record)"
want=$(hash_of out/bed)
[ -n "$want" ] || fail "no run"
rm out/bed/checkpoint.h5
job 2400
[ "$(hash_of out/bed)" = "$want" ] || fail "begun again: another state"
"$alone" run bed.toml --steps 50 --quiet --force -t 1 -o out/bed 2> log || fail "cut: $(tail -1 log)"
job 2400
grep -q "epafi-mpi resume out/bed --quiet" record || fail "not resumed: $(tail -1 record)"
[ "$(hash_of out/bed)" = "$want" ] || fail "resumed: another state"
exit $bad
