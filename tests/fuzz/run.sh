#!/bin/bash
# Fuzzes the readers: run.sh BUILD EXECUTIONS [READER...]   (readers: scene mesh problem run; Clang 14 with libFuzzer)
# The files that read are compiled again with address and undefined-behaviour checks and coverage; what they call comes
# from BUILD (Release). A crash, a leak, a run over 10 s or over 2 GB ends it with code 1 and leaves the input in
# BUILD/fuzz/READER-*. New inputs that reach new code are kept in BUILD/fuzz/READER.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd) runs=$2; shift 2
out=$build/fuzz; mkdir -p "$out"
export OMP_NUM_THREADS=1 ASAN_OPTIONS=allocator_may_return_null=1:detect_odr_violation=0
# HDF5 1.10 itself loses some hundred bytes where it gives up on a broken file
echo "leak:libhdf5" > "$out/leaks"
export LSAN_OPTIONS=suppressions=$out/leaks:print_suppressions=0
cat > "$out/flags" <<END
-std=c++20 -O1 -gline-tables-only -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=undefined
-fopenmp=libgomp
-ffp-contract=off -DEPAFI_CHECK_CONTRACTS -DTOML_HEADER_ONLY=0 -DFMT_SHARED -DEPAFI_VERSION=\\"0.1.0\\" -I$root
-isystem /usr/include/eigen3 -isystem /usr/include/hdf5/serial
END
unit() { # name, files: compiled as one; again where one of them or any header is newer
  local name=$1; shift
  for f in "$@"; do echo "#include \"$f\""; done > "$out/$name.cpp"
  if [ -e "$out/$name.o" ]; then
    [ -n "$(find "$@" -newer "$out/$name.o"; find $floors -name '*.h' -newer "$out/$name.o")" ] || return 0
  fi
  echo "compiling $name"; nice -n 10 clang++-14 @"$out/flags" -c "$out/$name.cpp" -o "$out/$name.o"
}
floors="engine detection laws scenes viz_export tests"
cd "$root"
unit reader $(ls scenes/reader/*.cpp)
unit files viz_export/hdf5/{hdf5_file,hdf5_driver,problem_file,run_file,stored_run,checkpoint}.cpp \
  viz_export/files/json_reader.cpp
unit meshes detection/shapes/{mesh_file,mesh_ply,triangle_mesh}.cpp detection/mass_properties.cpp engine/units/units.cpp
unit target tests/fuzz/fuzz_readers.cpp
objects="$out/reader.o $out/files.o $out/meshes.o $out/target.o"
library() { echo "$build/$1/libepafi_$1.a"; }
fresh=1
for o in $objects "$(library scenes)" "$(library viz_export)" "$(library detection)"; do
  [ "$out/fuzz_readers" -nt "$o" ] || fresh=0
done
[ $fresh = 1 ] || nice -n 10 clang++-14 -fsanitize=fuzzer,address,undefined -fopenmp=libgomp $objects \
  -Wl,-z,muldefs,--start-group "$(library scenes)" "$(library viz_export)" "$(library laws)" "$(library detection)" \
  "$(library engine)" -Wl,--end-group \
  -ltomlplusplus -lfmt -lhdf5_serial -lz -lgmp -lmpfr -o "$out/fuzz_readers"
for reader in ${*:-scene mesh problem run}; do
  mkdir -p "$out/$reader"
  most=2048  # MB at once; HDF5 itself asks for whatever a broken file says, gets nothing and reports it
  seeds="$root/tests/data/fuzz/$reader"
  case $reader in
    scene) longest=6000 seeds="$seeds $root/scenes/library $root/tests/data/broken" ;;
    run) longest=70000 most=100000000 ;;
    problem) longest=20000 most=100000000 ;;
    *) longest=20000 ;;
  esac
  echo "== $reader"
  FUZZ=$reader nice -n 10 "$out/fuzz_readers" -runs="$runs" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=$most \
    -max_len=$longest -print_final_stats=1 -artifact_prefix="$out/$reader-" "$out/$reader" $seeds \
    > "$out/$reader.log" 2>&1 ||
    { tail -40 "$out/$reader.log"; exit 1; }
  grep -E "stat::number_of_executed_units|stat::peak_rss|stat::average" "$out/$reader.log"
done
