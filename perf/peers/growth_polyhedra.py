#!/usr/bin/env python3
"""Time and memory of a pile of convex polyhedra by their number: copies of one settled pile side by side.

  /usr/bin/python3 perf/peers/growth_polyhedra.py [--numbers 1000 5000 10000 20000 50000] [--warm 240] [--steps 60]
  [--set KEY=VALUE ...]
                                                  [--out out/growth_polyhedra] [--program ./epafi]

Settles scenes/library/pile/polyhedra.toml (1000 stones, pgs with 50 sweeps, dt 1/240 s) and sets copies on one floor,
walls of 0.2 m between them. The first `warm` steps, in which the copies settle anew, and the `steps` after them (the
same run resumed) are timed on one thread, without output. Prints, and writes to table.md: for both microseconds per
body and step and sweeps per step (fewer where the tolerance is met), the first over that of the smallest number,
milliseconds per step at the end, contacts per body, the peak of the process over the number of bodies and what `epafi
explain` predicts (without program, output, drawn surfaces and room to grow); beside them what the runs got right:
largest and mean overlap in percent of the radius, kinetic energy as a velocity (root of 2 E / m), bodies lost.
"""
import argparse
import os
import subprocess
import sys

from runs import predicted, resumed, without_output

HERE = os.path.dirname(os.path.abspath(__file__))
PILE = os.path.join(HERE, "..", "..", "scenes", "library", "pile")
SCENE = """title = "Piles side by side"
run = { duration = 100.0, output_interval = "= 1/24" }
world = { gravity = [0, 0, -9.81] }
material.stone = { density = 1000.0, youngs_modulus = "10 MPa", poissons_ratio = 0.2 }
contact = { method = "nonsmooth", restitution = 0.0, friction = 0.5, nonsmooth = { solver = "pgs", iterations = 50 } }
body = [%s]
[[bodies]]
name = "stones"
file = "tiles.polyset"
material = "stone"
"""
THICK = 0.2
WALL = ('{ shape = { half_space = { normal = [%g, %g, %g] } }, material = "stone", position = [%.17g, %.17g, 0], '
        'fixed = true }')
BETWEEN = ('{ shape = { box = { size = [%.17g, %.17g, 4] } }, material = "stone", position = [%.17g, %.17g, 2], '
           'fixed = true }')


def settled(program, out):
    """Of each of the 1000 bodies at rest the words of its first line and its other lines; the side of their box [m]."""
    run, polyset = os.path.join(out, "settled"), os.path.join(out, "settled.polyset")
    source = os.path.join(PILE, "poly_1000.polyset")
    if not os.path.exists(polyset):
        scene = os.path.join(PILE, "polyhedra.toml")
        step = "run.time_step=%.17g" % (1 / 240)
        subprocess.run([program, "run", scene, "--set", step, "-t", "1", "-q", "--force", "--least-output", "-o", run],
                       check=True)
        subprocess.run([sys.executable, os.path.join(HERE, "..", "settled_polyset.py"), run, source, polyset],
                       check=True)
    bodies = []
    with open(polyset) as lines:
        side = float(next(lines).split()[4])
        for line in lines:
            if line.startswith("b "):
                bodies.append((line.split(), []))
            else:
                bodies[-1][1].append(line)
    return bodies, side


def write_scene(folder, number, bodies, side):
    """Copies as nearly square as the number allows, about the origin."""
    copies = number // len(bodies)
    along = max(k for k in range(1, int(copies**0.5) + 1) if copies % k == 0)
    across, pitch = copies // along, side + THICK
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "tiles.polyset"), "w") as out:
        out.write("polyset 1 20260101 %d %g\n" % (copies * len(bodies), side))
        for k in range(copies):
            dx, dy = pitch * (k // along - (across - 1) / 2), pitch * (k % along - (along - 1) / 2)
            for words, rest in bodies:
                at = ["%.17g" % (float(words[7]) + dx), "%.17g" % (float(words[8]) + dy)]
                out.write(" ".join(words[:7] + at + words[9:]) + "\n" + "".join(rest))
    x, y = (pitch * across - THICK) / 2, (pitch * along - THICK) / 2
    walls = [WALL % w for w in ((0, 0, 1, 0, 0), (1, 0, 0, -x, 0), (-1, 0, 0, x, 0), (0, 1, 0, 0, -y),
                                (0, -1, 0, 0, y))]
    walls += [BETWEEN % (THICK, 2 * y, pitch * k - x - THICK / 2, 0) for k in range(1, across)]
    walls += [BETWEEN % (2 * x, THICK, 0, pitch * k - y - THICK / 2) for k in range(1, along)]
    with open(os.path.join(folder, "pile.toml"), "w") as out:
        out.write(SCENE % ", ".join(walls))
    return copies * sum(float(words[3]) for words, _ in bodies)


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--numbers", type=int, nargs="+", default=[1000, 5000, 10000, 20000, 50000])
parser.add_argument("--warm", type=int, default=240)
parser.add_argument("--steps", type=int, default=60)
parser.add_argument("--set", action="append", default=[], help="a setting of the scene, as for epafi run")
parser.add_argument("--out", default="out/growth_polyhedra")
parser.add_argument("--program", default="./epafi")
o = parser.parse_args()
o.program = os.path.abspath(o.program)
os.makedirs(o.out, exist_ok=True)
bodies, side = settled(o.program, o.out)
HEAD = ["polyhedra", "us per body and step, sweeps: first %d steps" % o.warm, "over the first", "next %d" % o.steps,
        "ms per step then", "contacts",
        "peak [B per body]", "explain [B]", "overlap, mean [% of R]", "v_rms [mm/s]", "lost"]
lines = ["| " + " | ".join(HEAD) + " |", "|---" * len(HEAD) + "|"]
first = None
for number in o.numbers:
    folder = os.path.join(o.out, str(number))
    mass = write_scene(folder, number, bodies, side)
    settings = [word for s in o.set for word in ("--set", s)]
    start, s = resumed(o.program, "pile.toml", "run", o.warm, o.warm + o.steps, *settings, cwd=folder)
    before, after = without_output(start), without_output(s)
    settling, ms = 1e6 * before / o.warm / number, 1e3 * after / o.steps
    sweeps = [d["iterations"]["mean"] * d["steps"] for d in (start, s)]
    first = first or settling
    size = s["overlap"]["max"] / s["overlap"]["max_relative"] if s["overlap"]["max_relative"] else 1.0
    lines.append("| %d | %.2f, %.0f | %.2f | %.2f, %.0f | %.1f | %.2f | %.0f | %.0f | %.3f, %.4f | %.3g | %d |" % (
        number, settling, sweeps[0] / o.warm, settling / first, 1e3 * ms / number, (sweeps[1] - sweeps[0]) / o.steps,
        ms,
        s["contacts_mean"] / number, max(start["peak_memory_bytes"], s["peak_memory_bytes"]) / number,
        predicted(o.program, "pile.toml", folder) / number,
        100 * s["overlap"]["max_relative"], 100 * s["overlap"]["mean"] / size,
        1e3 * (2 * s["energy"]["kinetic"] / mass) ** 0.5, s["bodies_lost"]))
    print("\n".join(lines[-1:] if number != o.numbers[0] else lines), flush=True)
with open(os.path.join(o.out, "table.md"), "w") as file:
    file.write("\n".join(lines) + "\n")
