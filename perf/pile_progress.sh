#!/bin/sh
# How far every solver brings a problem in a given time, from a cold start: the residual after 1 s and after 10 s.
#   perf/pile_progress.sh OUT PROBLEM...
# OUT.csv: limit in seconds before the columns of `epafi solve`; OUT.svg: the chart.
#   LIMITS="1 10" METHODS=all EPAFI=build/bin/epafi; ROWS=old.csv draws from rows that are there.
set -e
out=$1; shift
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
if [ -z "$ROWS" ]; then
  : > "$out.csv"
  for limit in ${LIMITS:-1 10}; do
    "${EPAFI:-build/bin/epafi}" solve --method "${METHODS:-all}" --tolerance 1e-12 --time-limit "${limit}s" \
      --out "$work/rows" "$@" || true
    if [ -s "$out.csv" ]; then tail -n +2 "$work/rows"; else cat "$work/rows"; fi |
      awk -v l="$limit" 'NR == 1 && /^problem,/ { print "limit," $0; next } { print l "," $0 }' >> "$out.csv"
  done
elif [ "$ROWS" != "$out.csv" ]; then cp "$ROWS" "$out.csv"; fi
# one row per method and problem: residuals by limit
problems=$(awk -F, 'NR > 1 { print $2 }' "$out.csv" | sort -u)
n=$(echo "$problems" | wc -l)
plots=""
for p in $problems; do
  awk -F, -v p="$p" 'NR > 1 && $2 == p && $7 + 0 > 0 && $7 + 0 < 10 { r[$3, $1] = $7; m[$3] = 1; l[$1] = 1 }
    END { for (k in m) print k, ((k, 1) in r ? r[k, 1] : "nan"), ((k, 10) in r ? r[k, 10] : "nan") }' "$out.csv" |
    sort -k3,3g -k1,1 > "$work/$p.dat"
  plots="$plots
set title '$p' noenhanced
plot '$work/$p.dat' using (\$0-0.15):2 with impulses linewidth 5 linecolor rgb '#9ecae1' title 'after 1 s', \
  '' using (\$0+0.15):3:xtic(1) with impulses linewidth 5 linecolor rgb '#08519c' title 'after 10 s'"
done
gnuplot <<END
set terminal svg size 950,$((420 * n)) background 'white'
set output '$out.svg'
set multiplot layout $n,1
set logscale y
set xrange [-0.7:17.7]
set bmargin 9
set rmargin 8
set yrange [1e-13:1]
set format y '10^{%L}'
set xtics rotate by -40 noenhanced
set grid y
set ylabel 'residual (lower is better)'
set key top left opaque
$plots
END
echo "$out.svg"
