#!/bin/sh
# Performance profile (Dolan and More 2002) of all solvers over friction-contact problems: the share of problems that a
# solver brings to the tolerance within tau times the time of the quickest.
#   perf/performance_profile.sh OUT PROBLEM...           (OUT.csv rows of `epafi solve`, OUT.svg the chart)
#   TOLERANCE=1e-6 LIMIT=1s METHODS=all EPAFI=build/bin/epafi; ROWS=old.csv draws from rows that are there;
#   SICONOS=siconos.csv adds another code's rows (problem,solver,tol,info,iters,ms,res,...), measured in the same run.
set -e
out=$1; shift
tolerance=${TOLERANCE:-1e-6}
if [ -n "$ROWS" ]; then test "$ROWS" = "$out.csv" || cp "$ROWS" "$out.csv"
else "${EPAFI:-build/bin/epafi}" solve --method "${METHODS:-all}" --tolerance "$tolerance" --time-limit "${LIMIT:-1s}" \
  --out "$out.csv" "$@"; fi
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
# problem method ms of what was solved
awk -F, 'NR > 1 { n[$1] = 1; if ($3 == "solved") print $1, $2, $5 }' "$out.csv" > "$work/rows"
if [ -n "$SICONOS" ]; then
  awk -F, -v tol="$tolerance" '
    NR > 1 && $7 != "" && $7 + 0 <= tol + 0 { k = $1 " Siconos-" $2; if (!(k in t) || $6 < t[k]) t[k] = $6 }
    END { for (k in t) print k, t[k] }' "$SICONOS" >> "$work/rows"
fi
total=$(awk -F, 'NR > 1 { print $1 }' "$out.csv" | sort -u | wc -l)
awk '{ print $2 }' "$work/rows" | sort | uniq -c | sort -rn | awk '{ print $2 }' > "$work/solvers"
plot=""; k=0
while read -r solver; do
  awk -v s="$solver" '
    NR == FNR { if (!($1 in best) || $3 < best[$1]) best[$1] = $3; next }
    $2 == s { print $3 / best[$1] }' "$work/rows" "$work/rows" | sort -g |
    awk -v n="$total" '{ print $1, NR / n } END { print 1e5, NR / n }' > "$work/$solver.dat"
  plot="$plot${plot:+, }'$work/$solver.dat' with steps linewidth 2 dashtype $((k / 8 + 1)) title '$solver'"
  k=$((k + 1))  # eight colours, then the next dash
done < "$work/solvers"
gnuplot <<END
set terminal svg size 900,600 background 'white'
set output '$out.svg'
set logscale x
set xrange [1:1e5]
set yrange [0:1]
set key outside right noenhanced
set grid
set xlabel 'time / time of the quickest'
set ylabel 'share of $total problems solved to $tolerance'
plot $plot
END
echo "$out.svg: $total problems"
