#!/usr/bin/env python3
"""The bed of spheres side by side with LAMMPS, LIGGGHTS and YADE, from one settled state, on this machine, taking
turns.

  /usr/bin/python3 perf/peers/bed.py [--n 10000] [--steps 1000] [--repeats 3] [--out out/peers_bed] [--program ./epafi]

Settles scenes/library/bed/bed.toml with Epafi, writes its last snapshot as bodies.csv (Epafi), bed.data and bed.lammps,
bed.liggghts (those two), and times the same number of steps of 5e-5 s on one thread from there: Hertz-Mindlin with
history, double precision, five plane walls. A code that is not installed has no row. Prints, and writes to table.md:
nanoseconds of processor time per sphere and step (median, smallest, largest), and as a check that all did the same work
the other spheres that a sphere touches and the height of the bed's centre of mass. Epafi's is the time of a run that
goes on, of the others the same run without the timed steps is subtracted. Needs numpy; of Debian: lammps, liggghts,
yade.
"""
import os
import shutil

import numpy
from bed_input import box_of_planes, lammps_walls, liggghts_walls, script, write_data
from runs import (export, last_snapshot, options, peer, print_table, resumed, settled, take_turns, touching_neighbours,
                  write_csv,
                  yade_result)

SCENE = "scenes/library/bed/bed.toml"
E, NU, RESTITUTION, FRICTION, DENSITY, STEP = 5e6, 0.3, 0.6, 0.5, 2500.0, 5e-5

parser = options(__doc__, steps=1000, warm=200, repeats=3, skin=2e-4, out="out/peers_bed")
parser.add_argument("--n", type=int, default=10000)
o = parser.parse_args()
program = os.path.abspath(o.program)
scene = os.path.abspath(SCENE)
os.makedirs(o.out, exist_ok=True)


def settle():
    """Positions and radii of the settled bed, and the side of its box."""
    bed = settled(program, scene, os.path.join(o.out, "settled_%d" % o.n), "params.n=%d" % o.n)
    assert len(bed) == o.n, "%d spheres in the last snapshot, not %d" % (len(bed), o.n)
    return bed, (o.n * numpy.pi / 6 * 0.005**3 / 0.6) ** (1 / 3)


def write_inputs(bed, side):
    write_csv(os.path.join(o.out, "bodies.csv"), bed)
    with open(os.path.join(o.out, "bed.toml"), "w") as f:
        f.write('title = "Settled bed"\nrun = { duration = %.9g, time_step = %g, output_interval = 1.0 }\n'
                'world = { gravity = [0, 0, -9.81] }\n'
                % ((o.warm + o.steps + 0.5) * STEP, STEP))
        f.write("material.bead = { density = %g, youngs_modulus = %g, poissons_ratio = %g }\n" % (DENSITY, E, NU))
        f.write('contact = { method = "smooth", restitution = %g, friction = %g, smooth = { law = "hertz-mindlin" } }\n'
                % (RESTITUTION, FRICTION))
        f.write(box_of_planes(side, "bead"))
        f.write('[[bodies]]\nname = "bed"\nfile = "bodies.csv"\nmaterial = "bead"\n')
        f.write('[[measure]]\nname = "middle"\nkind = "position"\nbody = "bed"\ninterval = %.9g\n' %
                ((o.warm + o.steps) * STEP))
    write_data(os.path.join(o.out, "bed.data"), bed, side, DENSITY)

    def write_input(code, name, contact):
        write(name, script(code, "bed.data", contact, o, STEP))

    # LAMMPS, style "granular": the same laws as ours (Mindlin's spring rescaled, Tsuji's damping from the restitution)
    law = "hertz/material %g %g %g tangential mindlin NULL 1.0 %g damping tsuji" % (E, RESTITUTION, NU, FRICTION)
    pair = "pair_style granular\npair_coeff * * %s\n" % law
    write_input("lammps", "granular.lammps", pair + lammps_walls("granular " + law, side))
    # style "gran/hertz/history": its quickest; constants 4/3 E*, 8 G*, a damping that gives about the same restitution
    shear = E / (2 * (1 + NU))
    law = "%.6g %.6g 3e5 3e5 %g 1" % (4 / 3 * E / (2 * (1 - NU**2)), 8 * shear / (2 * (2 - NU)), FRICTION)
    pair = "pair_style gran/hertz/history %s\npair_coeff * *\n" % law
    write_input("lammps", "history.lammps", pair + lammps_walls("hertz/history " + law, side))
    values = ("youngsModulus peratomtype %g" % E, "poissonsRatio peratomtype %g" % NU,
              "coefficientRestitution peratomtypepair 1 %g" % RESTITUTION,
              "coefficientFriction peratomtypepair 1 %g" % FRICTION)
    properties = "".join("fix m%d all property/global %s\n" % value for value in enumerate(values))
    model = "hertz tangential history"
    pair = "pair_style gran model %s\npair_coeff * *\n" % model
    write_input("liggghts", "bed.liggghts", properties + pair + liggghts_walls(model, side))


YADE = """import math, resource
bodies = [tuple(map(float, line.split(","))) for line in open("bodies.csv").readlines()[1:]]
bead = O.materials.append(FrictMat(young=%(E)g, poisson=%(nu)g, density=%(density)g,
                                   frictionAngle=math.atan(%(friction)g)))
for x, y, z, r in bodies:
    O.bodies.append(sphere((x, y, z), r, material=bead))
for axis in (0, 1):
    O.bodies.append(wall(0, axis=axis, sense=1, material=bead))
    O.bodies.append(wall(%(side).17g, axis=axis, sense=-1, material=bead))
O.bodies.append(wall(0, axis=2, sense=1, material=bead))
law = [Ip2_FrictMat_FrictMat_MindlinPhys(en=%(restitution)g)], [Law2_ScGeom_MindlinPhys_Mindlin()]
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=%(skin)g),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], *law),
             NewtonIntegrator(damping=0, gravity=(0, 0, -9.81))]
O.dt = %(dt)g
O.run(%(warm)d, True)
used = lambda: sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
before = used()
O.run(%(steps)d, True)
seconds, n = used() - before, len(bodies)
touching = sum(2 for i in O.interactions if i.isReal and max(i.id1, i.id2) < n)
states = [O.bodies[k].state for k in range(n)]
height = sum(s.pos[2] * s.mass for s in states) / sum(s.mass for s in states)
print("RESULT", seconds, touching / n, height)
"""


def run_yade():
    """The same of YADE, for fewer steps."""
    steps = max(20, o.steps // 8)
    values = dict(E=E, nu=NU, density=DENSITY, friction=FRICTION, restitution=RESTITUTION, dt=STEP, side=side,
                  skin=o.skin, warm=o.warm // 4, steps=steps)
    with open(os.path.join(o.out, "bed_yade.py"), "w") as f:
        f.write(YADE % values)
    result = yade_result("bed_yade.py", o.out)
    return result and (1e9 * result[0] / steps / o.n, *result[1:])


def write(name, text):
    # LIGGGHTS asks for its units after the atoms' style, LAMMPS for either order
    lines = text.split("\n")
    units = lines.index("units si")
    lines.insert(0, lines.pop(units)) if name.endswith("lammps") else None
    with open(os.path.join(o.out, name), "w") as f:
        f.write("\n".join(lines))


def run_epafi():
    first, last = resumed(program, "bed.toml", "epafi", o.warm, o.warm + o.steps, cwd=o.out)
    folder = os.path.join(o.out, "epafi")
    export(program, folder)
    neighbours = touching_neighbours(last_snapshot(folder))
    time = 1e9 * last["cpu_time"] / (last["steps"] - first["steps"]) / o.n
    return time, neighbours, last["measures"]["middle"]["z"]["last"]


bed, side = settle()
write_inputs(bed, side)
codes = [("Epafi", run_epafi)]
if shutil.which("lmp"):
    codes += [("LAMMPS gran/hertz/history", lambda: peer(["lmp", "-log", "none", "-in", "history.lammps"], o.steps, o.n,
                                                         o.out)),
              ("LAMMPS granular (Mindlin, Tsuji)",
               lambda: peer(["lmp", "-log", "none", "-in", "granular.lammps"], o.steps, o.n, o.out))]
if shutil.which("liggghts"):
    codes.append(("LIGGGHTS", lambda: peer(["liggghts", "-log", "none", "-in", "bed.liggghts"], o.steps, o.n, o.out)))
if shutil.which("yade"):
    codes.append(("YADE", run_yade))
print_table("%d spheres, one thread" % o.n, ["neighbours", "height [m]"], take_turns(codes, o.repeats), o.out,
            "bed of " + ("{:,}".format(o.n).replace(",", " ") if o.n >= 10000 else str(o.n)))
