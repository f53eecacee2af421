#!/bin/bash
# Scenes drawn at random have the same files on any number of ranks:
#   drawn_scenes.sh EPAFI EPAFI_MPI FOLDER "RANKSxTHREADS ..." SEED ...
set -u
alone=$1 shared=$2 folder=$3 cases=$4; shift 4
here=$(dirname "$0") bad=0
mkdir -p "$folder" && cp "$here/net.obj" "$folder"
for seed in "$@"; do
  awk -v seed="$seed" -f "$here/draw_scene.awk" > "$folder/$seed.toml"
  "$here/same_bits.sh" "$alone" "$shared" "$folder/$seed" "$cases" 700 "$folder/$seed.toml" ||
    { echo "FAILED: seed $seed"; bad=1; }
done
exit $bad
