#!/usr/bin/env python3
"""Distance or depth of convex pairs with exact answers, beside libraries that are no package of Debian.

  /usr/bin/python3 perf/peers/narrow.py [--corpus tests/data/convex_pairs.bin] [--repeats 5] [--out out/peers_narrow]
  [--program ./epafi]

Runs `epafi narrow` by those of its methods that give distances and judges the answers by the signed distances of the
file (tests/data/README.md). Prints, and writes to table.md: mean time of a cold query [ns] (median of the repeats),
queries without an answer, pairs taken for apart or overlapping that are not (by more than 1e-6 and 1e-12 of the smaller
body's radius), and of depths and distances beyond 1e-9 of it those off by more than 1e-6 and by more than 1 %. coal,
MuJoCo 3, openGJK, Box3D and Jolt are not run: their figures of another machine (elsewhere/narrow.csv) stand below in
italics; only their errors can be compared.
"""
import argparse
import csv
import os
import statistics
import struct
import subprocess

from runs import write_table

HERE = os.path.dirname(os.path.abspath(__file__))
METHODS = ["auto", "gjk-epa"]  # sat gives no distances

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--corpus", default="tests/data/convex_pairs.bin")
parser.add_argument("--repeats", type=int, default=5)
parser.add_argument("--out", default="out/peers_narrow")
parser.add_argument("--program", default="./epafi")
o = parser.parse_args()
os.makedirs(o.out, exist_ok=True)


def read_exact(name):
    """Radius of the smaller body and signed distance of each pair."""
    with open(name, "rb") as file:
        data = file.read()
    assert data[:4] == b"CXP1", "%s is no file of convex pairs" % name
    pairs, kinds = struct.unpack_from("<II", data, 4)
    at, exact = 12, []
    for _ in range(kinds):
        at += 1 + data[at]
    for _ in range(pairs):
        vertices, triangles = sum(data[at + 2 : at + 4]), sum(data[at + 4 : at + 6])
        at += 8 + 8 * (6 + 3 * vertices) + 3 * triangles
        exact.append(struct.unpack_from("<dd", data, at))
        at += 8 * 11
    return exact


def judge(exact, answers):
    """The columns after the time."""
    failed = wrong = wrong_fine = 0
    off = {"depth": [], "distance": []}
    for (size, sigma), answer in zip(exact, answers):
        if answer["status"] != "ok":
            failed += 1
            continue
        d = float(answer["distance"])
        unlike = (d < 0) != (sigma < 0)
        wrong += unlike and abs(sigma) > 1e-6 * size
        wrong_fine += unlike and abs(sigma) > 1e-12 * size
        if abs(sigma) > 1e-9 * size:
            off["depth" if sigma < 0 else "distance"].append(abs(d - sigma) / abs(sigma))
    counts = ["%d of %d" % (sum(e > limit for e in errors), len(errors)) for errors in off.values()
              for limit in (1e-6, 1e-2)]
    return [str(failed), str(wrong), str(wrong_fine), *counts]


def run(method):
    """Mean time of a query [ns] and the answers."""
    name = os.path.join(o.out, "answers.csv")
    subprocess.run([o.program, "narrow", o.corpus, "--method", method, "-o", name], check=True,
                   stdout=subprocess.DEVNULL)
    with open(name) as file:
        answers = list(csv.DictReader(line for line in file if line[0] != "#"))
    return statistics.mean(float(a["ns"]) for a in answers), answers


def main():
    exact = read_exact(o.corpus)
    lines = ["| library | ns | failed | wrong class, 1e-6 | 1e-12 | depth off by 1e-6 | by 1 % | distance off by 1e-6 "
             "| by 1 % |", "|---" * 9 + "|"]
    seen = {m: [] for m in METHODS}
    for _ in range(o.repeats):
        for m in METHODS:
            seen[m].append(run(m))
    for m, results in seen.items():
        assert len(results[-1][1]) == len(exact)
        ns = statistics.median(r[0] for r in results)
        lines.append("| Epafi %s, %d pairs | %.0f | %s |" %
                     (m, len(exact), ns, " | ".join(judge(exact, results[-1][1]))))
    with open(os.path.join(HERE, "elsewhere", "narrow.csv")) as file:
        for r in csv.DictReader(line for line in file if line[0] != "#"):
            cells = list(r.values())
            lines.append("| *%s, 1630 pairs* | *%s* | %s |" % (cells[0], cells[1], " | ".join(cells[2:])))
    write_table(lines, o.out, "narrow.csv")


main()
