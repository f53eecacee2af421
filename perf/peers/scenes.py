#!/usr/bin/env python3
"""Scenes of everyday granular work beside LAMMPS, on this machine, in turns: a gas and a straining cell in periodic
domains, clumps, a turning drum, sizes of 1:10, a heap of grains that stick, a mixture of two materials that leaves a
hopper.

  /usr/bin/python3 perf/peers/scenes.py [--cases gas,drum] [--steps 400] [--repeats 3] [--beside PROGRAM]

Each scene comes to its state in Epafi; both codes go on from the same numbers on one thread in double precision: Hertz,
Mindlin with history, damping from the restitution (LAMMPS: pair style granular with Mindlin and Tsuji), the same steps.
--beside: an earlier program. Prints, and writes to table.md: nanoseconds of processor time per body and step (median,
smallest, largest), over those of Epafi, and the physical figure that each case names. Needs numpy; of Debian: lammps.
"""
import csv
import math
import os
import re
import shutil
import subprocess
import sys

import numpy
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import granular_scene
from granular_scene import BEAD, plane
from runs import options, peer, print_table, resumed, take_turns
from tsuji import restitution_given

NU, RADIUS = 0.3, 0.0025
SOFT = ("soft", 2000.0, 2.5e6)

PAIR = "{law} %.9g {e} {nu}{more} tangential mindlin NULL 1.0 {mu} damping tsuji"
# mean over the atoms of what a figure is made of; the same of Epafi's bodies by numpy
COLUMNS = {"square": "vx*vx+vy*vy+vz*vz", "x": "x", "z": "z"}


def fill(name, shape, count, low, high, more="", material="bead"):
    return ('[shape.%s]\n%s\n[[fill]]\nname = "%s"\nshape = "%s"\nmaterial = "%s"\ncount = %d\n'
            'region = { box = { min = %s, max = %s } }\n%s\n'
            % (name, shape, name, name, material, count, list(low), list(high), more))


def sphere(radius=RADIUS):
    return "sphere = { radius = %.17g }" % radius


def cube(side, more=""):
    edges = ", ".join(["%.17g" % side] * 3)
    return "domain = { min = [0, 0, 0], max = [%s], periodic = [\"x\", \"y\", \"z\"]%s }" % (edges, more)


class Case:
    """A scene, how its bodies come to their state (`start` for `settle` seconds), and what LAMMPS needs beside them.
    The figure is made of the means of two COLUMNS over all spheres."""
    gravity, domain, start_domain, restitution, friction = (0, 0, -9.81), "", None, 0.6, 0.5
    dt, skin, materials, spread = 3e-5, 4e-4, ["bead"], '\nsize = { distribution = "uniform", min = 0.9, max = 1.1 }'
    walls, closing, boundary, bins = "", "", "f f f", "bin"
    motion, more, columns, regions = "fix motion all nve/sphere", "", ("square", "z"), ""
    law, law_of_lammps = granular_scene.HERTZ, ("hertz/material", "")

    def lammps_walls(self):
        """Of fix wall/gran what comes after its law, by name of the fix."""
        return {}

    def spheres(self, rows):
        """Radius, place, velocity and spin, body and type (from 1) of every sphere."""
        for k, r in enumerate(rows):
            yield float(r["radius"]), vector(r, ""), [*vector(r, "v"),
                                                      *vector(r, "w")], k + 1, list(MATERIALS).index(r["material"]) + 1

    def figure(self, first, second):
        return second


def vector(row, of):
    return numpy.array([float(row[of + c]) for c in "xyz"])


class Gas(Case):
    """A gas of 20 000 spheres, 8 % of a periodic cube. Figure: mean square of the velocities [m2/s2]."""
    gravity, restitution, friction, boundary, settle = (0, 0, 0), 0.95, 0.1, "p p p", 0.003
    side = 0.25
    domain = cube(side)
    start = fill("gas", sphere(), 20000, (0, 0, 0), (side,) * 3, 'velocity_deviation = 1.0' + Case.spread)

    def figure(self, first, second):
        return first


class Strain(Gas):
    """10 000 spheres in a periodic cube that shrinks by 0.8 a second. Figure: mean square of the velocities beside the
    flow [m2/s2]."""
    restitution, friction, settle = 0.6, 0.5, 0.053
    side = 0.134 * math.exp(-4 * 0.053)
    start_domain = cube(0.134, ", strain_rate = [-4, -4, -4]")
    domain = cube(side, ", strain_rate = [-0.8, -0.8, -0.8]")
    start = fill("grains", sphere(), 10000, (0, 0, 0), (0.134,) * 3,
                 'method = "random"\nvelocity_deviation = 0.2' + Case.spread)
    more = "fix cell all deform 1 x trate -0.8 y trate -0.8 z trate -0.8 remap x\n"


class Box(Case):
    """Walls of a box on the ground."""
    side, settle = 0.1, 0.25

    def __init__(self):
        far = self.side
        sides = (((0, 0, 1), (0, 0, 0)), ((1, 0, 0), (0, 0, 0)), ((0, 1, 0), (0, 0, 0)), ((-1, 0, 0), (far, 0, 0)),
                 ((0, -1, 0), (0, far, 0)))
        self.walls = "".join(plane(normal, point) for normal, point in sides)

    def lammps_walls(self):
        far = {"x": self.side, "y": self.side, "z": "NULL"}
        return {"wall" + a: "%splane 0 %s" % (a, far[a]) for a in "xyz"}


class Clumps(Box):
    """3000 clumps of three spheres in a box. Figure: mean height of the spheres [m]."""
    # they touch
    corners = 2 * RADIUS * numpy.array([(1, 0, 0), (-0.5, math.sqrt(0.75), 0),
                                        (-0.5, -math.sqrt(0.75), 0)]) / math.sqrt(3)
    clump = "clump = { spheres = [%s] }" % ", ".join("[%.17g, %.17g, 0, %g]" % (*c[:2], RADIUS) for c in corners)
    start = fill("grains", clump, 3000, (0, 0, 0), (Box.side, Box.side, 0.6))
    motion = "neigh_modify exclude molecule/intra all\nfix motion all rigid/small molecule"

    def spheres(self, rows):
        for k, r in enumerate(rows):
            w, u = float(r["qw"]), numpy.array([float(r["q" + c]) for c in "xyz"])
            spin = vector(r, "w")
            for corner in self.corners:
                arm = corner + 2 * numpy.cross(u, numpy.cross(u, corner) + w * corner)
                yield RADIUS, vector(r, "") + arm, [*(vector(r, "v") + numpy.cross(spin, arm)), *spin], k + 1, 1


class Sizes(Box):
    """12 large spheres and 9000 of a tenth of their radius. Figure: mean height of the spheres [m]."""
    side, settle, bins, dt, skin = 0.05, 0.15, "multi", 1e-5, 2e-4
    start = (fill("large", sphere(0.01), 12, (0, 0, 0), (side, side, 0.1)) +
             fill("small", sphere(0.001), 9000, (0, 0, 0.1), (side, side, 0.25)))


class Drum(Case):
    """5000 spheres in a drum of 200 mm that turns at 2 rad/s. Figure: angle of their centre below the axis
    [degrees]."""
    half, radius, settle, columns = 0.03, 0.1, 0.3, ("x", "z")
    walls = (plane((0, 1, 0), (0, -half, 0)) + plane((0, -1, 0), (0, half, 0)) +
             "[[body]]\nshape = { tube = { radius = %g, length = %g } }\nmaterial = \"bead\"\nposition = [0, 0, 0]\n" %
             (radius, 2 * half) +
             "euler_deg = [-90, 0, 0]\nmotion = { rotation = { axis = [0, 1, 0], rate = 2.0, about = [0, 0, 0] } }\n")
    start = fill("grains", sphere(), 5000, (-0.065, -half, -0.07), (0.065, half, 0.07), Case.spread)

    regions = ('variable angle equal "2*step*dt"\n'
               "region drum cylinder y 0 0 %g %g %g side in open 1 open 2 units box rotate v_angle 0 0 0 0 1 0\n" %
               (radius, -half, half))

    def lammps_walls(self):
        return {"drum": "region drum", "ends": "yplane %g %g" % (-self.half, self.half)}

    def figure(self, first, second):
        return math.degrees(math.atan2(abs(first), -second))


class Heap(Case):
    """A column of 5000 spheres that stick to each other by DMT, 0.02 J/m2, spreads on the ground. Figure: mean height
    of the spheres [m]."""
    # LAMMPS pulls with 4 pi gamma R, gamma half the work of adhesion
    law, law_of_lammps, settle = 'law = "dmt", work_of_adhesion = 0.02', ("dmt", " 0.01"), 0.25
    walls = plane((0, 0, 1), (0, 0, 0))
    closing = ("[[body]]\nshape = { tube = { radius = 0.03, length = 0.8 } }\nmaterial = \"bead\"\n"
               "position = [0, 0, 0.4]\nfixed = true\n")
    start = fill("grains", sphere(), 5000, (-0.02, -0.02, 0), (0.02, 0.02, 0.75), Case.spread)

    def lammps_walls(self):
        return {"ground": "zplane 0 NULL"}


class Hopper(Case):
    """4000 spheres of each of two materials leave a funnel. Figure: mean square of the velocities [m2/s2]."""
    settle, materials, bottom, top, low, high = 0.25, ["bead", "soft"], 0.02, 0.07, 0.0, 0.07
    walls = ("[[body]]\nname = \"funnel\"\nshape = { cone = { radii = [%g, %g], length = %g } }\nmaterial = \"bead\"\n"
             "position = [0, 0, %g]\nfixed = true\n"
             % (bottom, top, high - low, (low + high) / 2) +
             "[[body]]\nshape = { tube = { radius = %g, length = 0.5 } }\nmaterial = \"bead\"\nposition = [0, 0, %g]\n"
             "fixed = true\n" % (top, high + 0.25))
    closing = plane((0, 0, 1), (0, 0, 0))
    start = (fill("hard", sphere(), 4000, (-0.048, -0.048, 0.07), (0.048, 0.048, 0.2), Case.spread) +
             fill("mild", sphere(), 4000, (-0.048, -0.048, 0.2), (0.048, 0.048, 0.33), Case.spread, "soft"))

    regions = ("region funnel cone z 0 0 %g %g %g %g side in open 1 open 2 units box\n" % (bottom, top, low, high) +
               "region tube cylinder z 0 0 %g %g 0.57 side in open 1 open 2 units box\n" % (top, high))

    def lammps_walls(self):
        return {"funnel": "region funnel", "tube": "region tube"}

    def figure(self, first, second):
        return first


CASES = {"gas": Gas, "strain": Strain, "clumps": Clumps, "drum": Drum, "sizes": Sizes, "heap": Heap, "hopper": Hopper}
MATERIALS = {"bead": (5e6, 2500.0), "soft": (2.5e6, 2000.0)}


def write(folder, name, text):
    with open(os.path.join(folder, name), "w") as f:
        f.write(text)


def head(case, duration, domain):
    world = f"[world]\ngravity = {list(case.gravity)}\n{domain}\n"
    return granular_scene.head(case.dt, duration, (BEAD, SOFT), case.restitution, case.friction, case.law) + world


def prepare(name, case, o):
    """Lets the scene come to its state (kept); writes scene.toml and scene.lammps. Number of bodies and of spheres."""
    folder = os.path.join(o.out, name)
    os.makedirs(folder, exist_ok=True)
    if not os.path.exists(os.path.join(folder, "bodies.csv")):
        write(folder, "start.toml", head(case, case.settle, case.start_domain
                                         or case.domain) + case.start + case.walls + case.closing)
        subprocess.run([os.path.abspath(o.program), "run", "start.toml", "-q", "-t", "1", "--force", "--least-output",
                        "-o", "start"], cwd=folder, check=True)
        subprocess.run([os.path.abspath(o.program), "export", "start", "--format", "csv"], cwd=folder, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.replace(os.path.join(folder, "start", "bodies.csv"), os.path.join(folder, "bodies.csv"))
    shapes = "".join(re.findall(r"^\[shape\.\w+\]\n.*\n", case.start, re.MULTILINE))
    bodies = '[[bodies]]\nname = "grains"\nfile = "bodies.csv"\nmaterial = "bead"\n'
    write(folder, "scene.toml", head(case, 10.0, case.domain) + shapes + case.walls + bodies)
    rows = read_bodies(os.path.join(folder, "bodies.csv"))
    spheres = list(case.spheres(rows))
    write_lammps(case, folder, spheres, o)
    return len(rows), len(spheres)


def read_bodies(name):
    with open(name, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def extent(case, spheres):
    """Box of LAMMPS: the periodic cube, or room around the spheres."""
    if case.boundary == "p p p":
        return [(0.0, case.side)] * 3
    x = numpy.array([s[1] for s in spheres])
    return [(low - 0.15, high + 0.15) for low, high in zip(x.min(axis=0), x.max(axis=0))]


def write_lammps(case, folder, spheres, o):
    kinds = len(case.materials)
    text = "scene\n\n%d atoms\n%d atom types\n\n" % (len(spheres), kinds)
    text += "".join("%.17g %.17g %slo %shi\n" % (*ends, a, a)
                    for ends, a in zip(extent(case, spheres), "xyz")) + "\nAtoms\n\n"
    molecules = case.motion != Case.motion
    for k, (radius, x, _, body, kind) in enumerate(spheres, start=1):
        density = list(MATERIALS.values())[kind - 1][1]
        size = "%.17g %g" % (2 * radius, density)
        place = "%.17g %.17g %.17g" % tuple(x)
        text += "%d %d %s\n" % (k, kind, "%s %s %d" % (place, size, body) if molecules else size + " " + place)
    text += "\nVelocities\n\n" + "".join("%d %.17g %.17g %.17g %.17g %.17g %.17g\n" % (k, *s[2])
                                         for k, s in enumerate(spheres, start=1))
    write(folder, "scene.data", text)
    write(folder, "scene.lammps", lammps_script(case, o, molecules))


def lammps_script(case, o, molecules):
    moduli = [MATERIALS[m][0] for m in case.materials]
    kind, more = case.law_of_lammps
    text = PAIR.format(law=kind, more=more, e="%.9g" % restitution_given(case.restitution), nu=NU, mu=case.friction)
    law = lambda p, q: text % (2 * p * q / (p + q))
    # with a wall LAMMPS takes E / 2 (1 - nu) for E*
    wall = lambda q: law(*2 * [2 / (1 / MATERIALS["bead"][0] + 1 / q) / (1 + NU)])
    lines = ["units si", "atom_style " + ("hybrid sphere molecular" if molecules else "sphere"),
             "atom_modify map array sort 1000 %g" % (2.4 * RADIUS),
             "newton on", "comm_modify vel yes", "boundary " + case.boundary, "read_data scene.data",
             "neighbor %g %s" % (case.skin, case.bins),
             "neigh_modify delay 0 every 1 check yes", "pair_style granular"]
    lines += ["pair_coeff %d %d %s" % (a + 1, b + 1, law(moduli[a], moduli[b])) for a in range(len(moduli))
              for b in range(a, len(moduli))]
    lines.append(case.regions)
    for kind, modulus in enumerate(moduli, start=1):
        lines.append("group kind%d type %d" % (kind, kind))
        for name, rest in case.lammps_walls().items():
            style = "wall/gran/region" if rest.startswith("region") else "wall/gran"
            lines.append("fix %s%d kind%d %s granular %s %s" % (name, kind, kind, style, wall(modulus), rest))
    if any(case.gravity):
        lines.append("fix weight all gravity 9.81 vector 0 0 -1")
    lines += ["timestep %g" % case.dt, case.motion, case.more]
    for k, column in enumerate(case.columns):
        lines += ["variable c%d atom %s" % (k, COLUMNS[column]), "compute c%d all reduce ave v_c%d" % (k, k)]
    lines += ["thermo_style custom step atoms c_c0 c_c1", "thermo_modify lost warn", "thermo %d" % (o.warm + o.steps),
              "run %d" % o.warm, "run ${steps}"]
    return "\n".join(lines) + "\n"


def column(name, x, v):
    """Mean over the spheres, as LAMMPS computes it."""
    return {"square": (v * v).sum(axis=1), "x": x[:, 0], "z": x[:, 2]}[name].mean()


def run(program, name, case, folder, o):
    at = os.path.join(o.out, name)
    first, last = resumed(program, "scene.toml", folder, o.warm, o.warm + o.steps, cwd=at)
    subprocess.run([program, "export", folder, "--format", "csv"], cwd=at, check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    spheres = list(case.spheres(read_bodies(os.path.join(at, folder, "bodies.csv"))))
    x, v = numpy.array([s[1] for s in spheres]), numpy.array([s[2][:3] for s in spheres])
    figure = case.figure(*(column(c, x, v) for c in case.columns))
    return 1e9 * last["cpu_time"] / (last["steps"] - first["steps"]) / last["bodies"], figure


def run_lammps(name, case, bodies, spheres, o):
    seen = peer(["lmp", "-log", "none", "-in", "scene.lammps"], o.steps, spheres, os.path.join(o.out, name))
    return seen and (seen[0] * spheres / bodies, case.figure(*seen[1:]))


def main():
    parser = options(__doc__, steps=400, warm=100, repeats=3, skin=0.0, out="out/peers_scenes")
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--beside")
    o = parser.parse_args()
    tables = []
    for name in o.cases.split(","):
        case = CASES[name]()
        bodies, spheres = prepare(name, case, o)
        codes = [("Epafi", lambda: run(os.path.abspath(o.program), name, case, "run_0", o))]
        if o.beside:
            codes.append(("Epafi, beside", lambda: run(os.path.abspath(o.beside), name, case, "run_1", o)))
        if shutil.which("lmp"):
            codes.append(("LAMMPS", lambda: run_lammps(name, case, bodies, spheres, o)))
        print_table("%s, %d bodies" % (name, bodies), [" ".join(case.__doc__.split()).split("Figure: ")[1].rstrip(".")],
                    take_turns(codes, o.repeats), os.path.join(o.out, name),
                    "scene " + name)
        with open(os.path.join(o.out, name, "table.md")) as f:
            tables.append(f.read())
    write(o.out, "table.md", "\n".join(tables))


if __name__ == "__main__":
    main()
