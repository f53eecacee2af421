#!/usr/bin/env python3
"""Polyhedra by a smooth law side by side with YADE, both with a force from the overlap volume, on this machine, in
turns.

  /usr/bin/python3 perf/peers/polyhedra.py [--n 125] [--steps 100] [--warm 3000] [--out out/peers_polyhedra] [--program
  ./epafi]

n convex polyhedra of 8 to 20 vertices on a sphere of 5 mm stand on a lattice in a box, fall and come to rest in `warm`
steps of 5e-5 s; then `steps` more are timed on one thread. Both codes read the same vertices. Prints, and writes to
table.md: microseconds of processor time per body and step, contacts per body, the height of the centre of mass, bodies
that left the box. The start is not counted; a code that is not installed has no row. The laws differ: YADE's force is a
constant times the volume (5e6 N/m^3) and is damped by a share of every force, Epafi's has a potential, a modulus (2
kPa: the same step, overlaps of the same size) and loses by restitution. Needs numpy; of Debian: yade.
"""
import csv
import os
import shutil
import subprocess

import numpy
from runs import options, resumed, write_table, yade_result

PER_VOLUME, E, NU, FRICTION, DENSITY, STEP, SIZE = 5e6, 2e3, 0.3, 0.5, 2500.0, 5e-5, 5e-3
parser = options(__doc__, steps=100, warm=3000, repeats=1, skin=2e-4, out="out/peers_polyhedra")
parser.add_argument("--n", type=int, default=125)
o = parser.parse_args()
program = os.path.abspath(o.program)
os.makedirs(o.out, exist_ok=True)


def bodies():
    """Side of the box and vertices of every body, in axes of the world."""
    random = numpy.random.default_rng(7)
    across = max(1, round(o.n ** (1 / 3)))
    pitch, out = 1.01 * SIZE, []
    for i in range(o.n):
        points = random.normal(size=(random.integers(8, 21), 3))
        points /= numpy.linalg.norm(points, axis=1)[:, None]
        for _ in range(8):  # they push each other apart: no flat bodies, the centre inside
            apart = points[:, None] - points[None]
            cubes = ((apart**2).sum(2) + numpy.eye(len(points))) ** 1.5
            points += 0.15 * (apart / cubes[:, :, None]).sum(1) / len(points) ** 0.5
            points /= numpy.linalg.norm(points, axis=1)[:, None]
        place = (numpy.array([i % across, i // across % across, i // across**2]) + 0.5) * pitch
        out.append(0.5 * SIZE * points + place)
    return across * pitch, out


def rows(vertices):
    return "[" + ", ".join("[%.9g, %.9g, %.9g]" % tuple(v) for v in vertices) + "]"


def write_scene(side, all_vertices):
    with open(os.path.join(o.out, "pile.toml"), "w") as f:
        f.write('title = "Polyhedra"\nrun = { duration = 10.0, time_step = %g, output_interval = 10.0 }\n'
                'world = { gravity = [0, 0, -9.81] }\n' % STEP)
        f.write("material.stone = { density = %g, youngs_modulus = %g, poissons_ratio = %g }\n" % (DENSITY, E, NU))
        f.write('contact = { method = "smooth", restitution = 0.3, friction = %g, smooth = { law = "overlap-volume" } '
                '}\n' % FRICTION)
        planes = [((0, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((side, 0, 0), (-1, 0, 0)),
                  ((0, side, 0), (0, -1, 0))]
        for p, n in planes:
            f.write('[[body]]\nshape = { half_space = { normal = [%g, %g, %g] } }\nmaterial = "stone"\nfixed = true\n'
                    'position = [%.9g, %.9g, %.9g]\n' % (*n, *p))
        for vertices in all_vertices:
            centre = vertices.mean(0)
            f.write('[[body]]\nmaterial = "stone"\nposition = [%.9g, %.9g, %.9g]\n'
                    'shape = { polyhedron = { vertices = %s } }\n' % (*centre, rows(vertices - centre)))
        f.write('[[measure]]\nname = "contacts"\nkind = "coordination"\ninterval = %g\n' % (100 * STEP))


def run_epafi(side):
    before, after = resumed(program, "pile.toml", "epafi", o.warm, o.warm + o.steps, cwd=o.out)
    subprocess.run([program, "export", "epafi", "--format", "csv"], cwd=o.out, check=True, capture_output=True)
    with open(os.path.join(o.out, "epafi", "snapshots.csv")) as file:
        free = [[float(r[c]) for c in ("time", "x", "y", "z", "mass")] for r in csv.DictReader(file)
                if float(r["mass"]) > 0]
    last = numpy.array([r for r in free if r[0] == free[-1][0]])
    gone = int(((last[:, 1:3] < 0) | (last[:, 1:3] > side)).any(1).sum())
    time = 1e6 * after["cpu_time"] / (after["steps"] - before["steps"]) / o.n
    height = numpy.average(last[:, 3], weights=last[:, 4])
    return time, after["measures"]["contacts"]["number"]["last"], height, gone


YADE = """import math, resource
from yade import polyhedra_utils, log
log.setLevel("Default", 1)
stone = PolyhedraMat(density=%(density)g, young=%(E)g, poisson=%(nu)g, frictionAngle=math.atan(%(friction)g))
O.materials.append(stone)
for vertices in %(bodies)s:
    O.bodies.append(polyhedra_utils.polyhedra(stone, v=[Vector3(*v) for v in vertices]))
n = len(O.bodies)
for axis in (0, 1):
    O.bodies.append(utils.wall(0, axis=axis, sense=1, material=stone))
    O.bodies.append(utils.wall(%(side).9g, axis=axis, sense=-1, material=stone))
O.bodies.append(utils.wall(0, axis=2, sense=1, material=stone))
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb()], verletDist=%(skin)g),
             InteractionLoop([Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
                             [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
                              [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
             NewtonIntegrator(damping=0.3, gravity=(0, 0, -9.81))]
O.dt = %(dt)g
O.run(%(warm)d, True)
used = lambda: sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
before = used()
O.run(%(steps)d, True)
seconds = used() - before
touching = sum(2 if max(i.id1, i.id2) < n else 1 for i in O.interactions if i.isReal)
mass = [O.bodies[k].state.mass for k in range(n)]
place = [O.bodies[k].state.pos for k in range(n)]
gone = sum(1 for p in place if not (0 < p[0] < %(side).9g and 0 < p[1] < %(side).9g and p[2] > 0))
print("RESULT", seconds, touching / n, sum(m * p[2] for m, p in zip(mass, place)) / sum(mass), gone)
"""


def run_yade(side, all_vertices):
    values = dict(E=PER_VOLUME, nu=NU, density=DENSITY, friction=FRICTION, dt=STEP, side=side, skin=o.skin, warm=o.warm,
                  steps=o.steps,
                  bodies="[" + ",\n".join(map(rows, all_vertices)) + "]")
    with open(os.path.join(o.out, "pile_yade.py"), "w") as f:
        f.write(YADE % values)
    result = yade_result("pile_yade.py", o.out)
    return result and (1e6 * result[0] / o.steps / o.n, *result[1:])


side, all_vertices = bodies()
write_scene(side, all_vertices)
codes = [("Epafi", lambda: run_epafi(side))]
if shutil.which("yade"):
    codes.append(("YADE", lambda: run_yade(side, all_vertices)))
lines = ["| %d polyhedra, one thread | us per body and step | contacts per body | height [m] | gone |" % o.n,
         "|---" * 5 + "|"]
for name, run in codes:
    result = run()
    if result:
        lines.append("| %s | %.4g | %.3g | %.4g | %d |" % (name, *result))
        print(lines[-1], flush=True)
write_table(lines, o.out)
