# Shared by the tests of ranks.
hash_of() { sed -n 's/.*"state_hash": "\([0-9a-f]*\)".*/\1/p' "$1/summary.json" 2>/dev/null; }
ranks_of() { tr -d '\n' < "$1/summary.json" | sed -n 's/.*"ranks": {\([^}]*\)}.*/\1/p' | tr -s ' '; }
if [ "$(id -u)" -eq 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi
export OMP_WAIT_POLICY=passive OMPI_MCA_btl_vader_single_copy_mechanism=none
on_ranks() { # ranks threads command... ; within `patience` seconds, if that is set
  local ranks=$1; export OMP_NUM_THREADS=$2; shift 2
  timeout -s KILL "${patience:-0}" mpirun --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 -n "$ranks" "$@"
}
