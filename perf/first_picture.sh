#!/usr/bin/env bash
# From a clean clone to the first picture by the README's commands, by the clock: clone, set-up and build, smallest
# scene, first picture.
#   perf/first_picture.sh [--ccache] [FOLDER]
# Without --ccache nothing of an earlier build is used. FOLDER (default: a temporary one, removed again) must not exist.
set -euo pipefail
export CCACHE_DISABLE=1
if [ "${1:-}" = --ccache ]; then
  unset CCACHE_DISABLE
  shift
fi
source=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
if [ $# -gt 0 ]; then
  folder=$1
else
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
begin=$(date +%s.%N)
last=$begin
stamp() {  # what was done, seconds of it, seconds since the start
  local now
  now=$(date +%s.%N)
  awk -v what="$1" -v a="$last" -v b="$begin" -v now="$now" \
    'BEGIN { printf "%-44s %8.1f s %8.1f s\n", what, now - a, now - b }'
  last=$now
}
printf '%-44s %10s %10s\n' step seconds total
git clone --quiet "$source" "$folder/epafi"
cd "$folder/epafi"
stamp "clone"
./epafi list shapes >/dev/null 2>"$folder/build.log" || { tail -20 "$folder/build.log"; exit 1; }
stamp "set-up and build (the first command does it)"
./epafi run scenes/library/impact/chung_ooi_1.toml -q --json >"$folder/first.json"
stamp "first number: an impact"
./epafi run scenes/library/tutorials/03_stack.toml -q
./epafi report out/03_stack >/dev/null
stamp "first picture: a stack and its report"
ls -l out/03_stack/report.html
