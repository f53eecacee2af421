#!/bin/bash
# clang-tidy 14 with the checks of .clang-tidy over engine, detection, laws, viz_export and scenes:
#   tidy.sh BUILD [PATTERN]
# BUILD is a built folder of the `clang` preset (clang-tidy reads its precompiled header), PATTERN chooses among its
# units. Findings go to stdout; exit code 1 where there is one.
set -u
build=$(cd "$1" && pwd) pattern=${2:-.}
cd "$build" || exit 2
units=$(sed -n 's/.*"file": "\(.*\)".*/\1/p' compile_commands.json |
  grep -E '/(engine|detection|laws|viz_export|scenes)/' |
  grep -vE '/(tests|perf|scenes/python)/|cmake_pch' | grep -E "$pattern")
for unit in $units; do echo "$unit"; done |
  xargs -P 2 -n 1 clang-tidy-14 -p "$build" --quiet --warnings-as-errors='*' > tidy.log 2> tidy.err
bad=$?
grep -vE '^[0-9]+ warnings?( and [0-9]+ errors?)? generated|^$' tidy.log
echo "$(echo "$units" | wc -l) units, $(grep -cE '(error|warning): ' tidy.log) findings"
exit $((bad != 0))
