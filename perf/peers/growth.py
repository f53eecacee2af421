#!/usr/bin/env python3
"""Time and memory of a bed of spheres by their number: copies of one settled bed, so that all have the same contacts.

  /usr/bin/python3 perf/peers/growth.py [--numbers 1000 10000 100000 400000 1000000] [--steps 300] [--repeats 3] [--out
  out/growth] [--program ./epafi]

Settles scenes/library/bed/bed.toml with 1000 and with 10 000 spheres, lays copies of the larger one side by side on the
floor, each the mirror image of its neighbours (a sphere that leant on a wall leans on its image; unmirrored copies fall
into each other's gaps), and runs them on one thread, the same steps for all, in turns. Prints, and writes to table.md:
nanoseconds per sphere and step by the clocks of the stages (median, smallest, largest; processor time of runs of 300
and of 10 steps, subtracted, gave 29 to 44 ns for 10 000), over that of 10 000; the peak of the whole process over the
number of spheres and what `epafi explain` predicts without program and room to grow; beside them what the runs got
right: the height of the centre of mass and the overlap in percent of the radius.
"""
import argparse
import json
import os
import statistics
import subprocess

import numpy
from runs import predicted, settled, write_csv, write_table

HEAD = """title = "Beds side by side"
run = { duration = %.9g, time_step = 5e-5, output_interval = 1e3 }
world = { gravity = [0, 0, -9.81] }
material.bead = { density = 2500, youngs_modulus = 5e6, poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.6, friction = 0.5, smooth = { law = "hertz-mindlin" } }
"""
WALL = ('[[body]]\nshape = { half_space = { normal = [%g, %g, %g] } }\nmaterial = "bead"\nfixed = true\n'
        'position = [%.17g, %.17g, 0]\n')
BODIES = ('[[bodies]]\nname = "bed"\nfile = "bodies.csv"\nmaterial = "bead"\n'
          '[[measure]]\nname = "middle"\nkind = "position"\nbody = "bed"\ninterval = 1e3\n')


def tiles(number, parts):
    """Copies of a bed as nearly square as the number allows: bodies, and the lengths of their floor."""
    bed, side = parts[1000 if number < 10000 else 10000]
    copies = number // len(bed)
    along = max(k for k in range(1, int(copies**0.5) + 1) if copies % k == 0)
    rows = numpy.stack([bed, bed * (-1, 1, 1, 1), bed * (1, -1, 1, 1), bed * (-1, -1, 1, 1)])
    copy = lambda i, j: rows[i % 2 + 2 * (j % 2)] + (side * (i + i % 2), side * (j + j % 2), 0, 0)
    return numpy.concatenate([copy(i, j) for i in range(copies // along)
                              for j in range(along)]), side * (copies // along), side * along


def write_scene(folder, number, parts, steps):
    bodies, x, y = tiles(number, parts)
    os.makedirs(folder, exist_ok=True)
    write_csv(os.path.join(folder, "bodies.csv"), bodies)
    with open(os.path.join(folder, "bed.toml"), "w") as f:
        f.write(HEAD % (5e-5 * (steps + 0.5)))
        for n, at in (((0, 0, 1), (0, 0)), ((1, 0, 0), (0, 0)), ((0, 1, 0), (0, 0)), ((-1, 0, 0), (x, y)),
                      ((0, -1, 0), (x, y))):
            f.write(WALL % (*n, *at))
        f.write(BODIES)
    return len(bodies)


def run(program, folder, n, steps):
    """Nanoseconds per sphere and step, and the run's summary."""
    command = [program, "run", "bed.toml", "-t", "1", "-q", "--force", "--least-output", "--steps", str(steps), "-o",
               "run"]
    subprocess.run(command, cwd=folder, check=True, stderr=subprocess.DEVNULL)
    with open(os.path.join(folder, "run", "summary.json")) as f:
        summary = json.load(f)
    return 1e9 * sum(summary["stage_seconds"].values()) / steps / n, summary


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--numbers", type=int, nargs="+", default=[1000, 10000, 100000, 400000, 1000000])
parser.add_argument("--steps", type=int, default=300)
parser.add_argument("--repeats", type=int, default=3)
parser.add_argument("--out", default="out/growth")
parser.add_argument("--program", default="./epafi")
o = parser.parse_args()
o.program, scene = os.path.abspath(o.program), os.path.abspath("scenes/library/bed/bed.toml")
os.makedirs(o.out, exist_ok=True)
beds = {n: (settled(o.program, scene, os.path.join(o.out, "settled_%d" % n), "params.n=%d" % n),
            (n * numpy.pi / 6 * 0.005**3 / 0.6) ** (1 / 3))
        for n in (1000, 10000)}
folders = [os.path.join(o.out, str(number)) for number in o.numbers]
sizes = [write_scene(folder, number, beds, o.steps) for folder, number in zip(folders, o.numbers)]
turns = [[run(o.program, folder, n, o.steps) for folder, n in zip(folders, sizes)] for _ in range(o.repeats)]
rows = [(n, [turn[k][0] for turn in turns], turns[-1][k][1]) for k, n in enumerate(sizes)]
base = next((statistics.median(t) for n, t, _ in rows if n == 10000), None)
lines = ["| spheres | ns per sphere and step | smallest, largest | over 10 000 | peak [B per sphere] | explain [B] | "
         "height [mm] | overlap [% of R] |", "|---" * 8 + "|"]
for (n, times, s), folder in zip(rows, folders):
    middle = statistics.median(times)
    lines.append("| %d | %.1f | %.1f, %.1f | %s | %.0f | %.0f | %.3f | %.2f |" % (
        n, middle, min(times), max(times), "%.2f" % (middle / base) if base else "", s["peak_memory_bytes"] / n,
        predicted(o.program, "bed.toml", folder) / n,
        1e3 * s["measures"]["middle"]["z"]["last"], 100 * s["overlap"]["max_relative"]))
write_table(lines, o.out)
