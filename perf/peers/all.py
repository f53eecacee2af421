#!/usr/bin/env python3
"""All comparisons with other codes of this folder, one after the other, and their tables in one: what every code takes
beside what it gets right.

  /usr/bin/python3 perf/peers/all.py [--quick] [--out out/peers] [--program ./epafi]

Beds of 10 000 and 100 000 spheres and a hopper (LAMMPS, LIGGGHTS, YADE), stacks, unequal masses, a pyramid and a pile
of polyhedra without smoothing (Bullet, ODE, MuJoCo), polyhedra by a smooth law (YADE), pairs of convex bodies with
exact answers; the heads of the single scripts say what is measured how. Within a script all codes take turns in one
run; codes that are not installed have no row. Engines that are no package of Debian (Box3D, Jolt, coal, MuJoCo 3) are
not run: their figures of another machine (elsewhere/) stand in italics. Writes table.md; `tools/figures.py --take
out/peers --machine NAME` puts the times on the pages. Some 40 minutes;
--quick: a tenth of the steps, to see that all is in place.
"""
import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
PARTS = [  # heading, script, options, options of a quick run
    ("Bed of 10 000 spheres", "bed.py", ["--n=10000", "--steps=1000", "--repeats=3"],
     ["--n=1000", "--steps=200", "--repeats=1"]),
    ("Bed of 100 000 spheres", "bed.py", ["--n=100000", "--steps=150", "--warm=50", "--repeats=3"], None),
    ("Hopper", "hopper.py", ["--steps=2000", "--warm=400", "--repeats=2"], ["--steps=200", "--warm=100"]),
    ("Stacks and piles", "rigid.py", ["--repeats=1"], ["--cases", "stack-20", "mass-10000", "--seconds=1"]),
    ("Polyhedra by a smooth law", "polyhedra.py", ["--n=27", "--warm=1500", "--steps=100"],
     ["--n=8", "--warm=200", "--steps=20"]),
    ("Convex pairs", "narrow.py", ["--repeats=5"], ["--repeats=1"]),
]

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--quick", action="store_true")
parser.add_argument("--out", default="out/peers")
parser.add_argument("--program", default="./epafi")
o = parser.parse_args()
tables, failed = [], []
for heading, script, options, quick in PARTS:
    if o.quick and quick is None:
        continue
    folder = os.path.join(o.out, heading.lower().replace(" ", "_"))
    command = [sys.executable, os.path.join(HERE, script), *(quick if o.quick else options), "--out", folder,
               "--program", o.program]
    if subprocess.run(command).returncode != 0:
        failed.append(heading)
        continue
    with open(os.path.join(folder, "table.md")) as file:
        tables.append("## %s\n\n%s" % (heading, file.read()))
with open(os.path.join(o.out, "table.md"), "w") as file:
    file.write("\n".join(tables))
print("\n" + "\n".join(tables))
sys.exit("failed: " + ", ".join(failed) if failed else 0)
