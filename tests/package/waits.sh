#!/bin/bash
# How long the program has threads spin before they sleep, as GNU OpenMP says it: waits.sh PROGRAM
set -u
unset OMP_WAIT_POLICY GOMP_SPINCOUNT
bad=0
spins() {  # WANTED [NAME=VALUE]
  local said
  said=$(env ${2:-NONE=0} OMP_DISPLAY_ENV=verbose "$program" --version 2>&1 | grep SPINCOUNT | tail -1)
  [[ $said == *"'$1'"* ]] || { echo "FAILED with ${2:-nothing set}: $said, not $1"; bad=1; }
}
program=$1
spins 10000
spins 77 GOMP_SPINCOUNT=77
spins 0 OMP_WAIT_POLICY=passive
exit $bad
