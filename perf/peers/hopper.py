#!/usr/bin/env python3
"""A flowing hopper side by side with LAMMPS, LIGGGHTS and YADE, from one settled state, on this machine, taking turns.

  /usr/bin/python3 perf/peers/hopper.py [--steps 4000] [--repeats 1] [--out out/peers_hopper] [--program ./epafi]

Settles scenes/library/hopper/hopper.toml with Epafi up to the opening of its gate and lets 20 000 spheres flow out of
the orifice of 40 mm: `warm` steps first, then the timed ones, on one thread, in double precision, Hertz-Mindlin with
history. Epafi, LIGGGHTS and YADE (an eighth of the steps) take the walls as the same triangles, LAMMPS as a cylinder
and a cone. Prints, and writes to table.md: nanoseconds of processor time per sphere of the start and timed step, the
mass flow in them [kg/s] and its standard error from ten parts of the window. A code that is not installed has no row.
Needs numpy; of Debian: lammps, liggghts, yade.
"""
import os
import re
import shutil

import numpy
from runs import options, print_table, processor_time, resumed, settled, take_turns, write_csv, yade_result

SCENES = "scenes/library/hopper"
E, NU, RESTITUTION, FRICTION, DENSITY, STEP = 5e6, 0.3, 0.6, 0.5, 2500.0, 5e-5
PARTS = 10  # of the timed window, for the spread of the flow

parser = options(__doc__, steps=4000, warm=2000, repeats=1, skin=5e-4, out="out/peers_hopper")
o = parser.parse_args()
if o.steps % PARTS or o.warm % (o.steps // PARTS):
    parser.error("--steps must be a multiple of %d and --warm of a %dth of it" % (PARTS, PARTS))
program = os.path.abspath(o.program)
os.makedirs(o.out, exist_ok=True)


def write(name, text):
    with open(os.path.join(o.out, name), "w") as f:
        f.write(text)


def write_stl():
    """The walls of the scene as LIGGGHTS reads them."""
    points, lines = [], ["solid hopper"]
    with open(os.path.join(SCENES, "hopper.obj")) as file:
        text = file.read()
    write("hopper.obj", text)
    for words in map(str.split, text.splitlines()):
        if words[:1] == ["v"]:
            points.append(words[1:4])
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) - 1 for w in words[1:]]
            for k in range(1, len(corners) - 1):
                lines += ["facet normal 0 0 0", "outer loop"]
                lines += ["vertex " + " ".join(points[corners[c]]) for c in (0, k, k + 1)] + ["endloop", "endfacet"]
    write("hopper.stl", "\n".join(lines + ["endsolid hopper\n"]))


def write_scene():
    write("hopper.toml", """title = "Open hopper"
run = { duration = 1.0, time_step = %g, output_interval = 1.0 }
world = { gravity = [0, 0, -9.81], domain = { min = [-0.1, -0.1, -0.1], max = [0.1, 0.1, 1.0], outside = "delete" } }
material.bead = { density = %g, youngs_modulus = %g, poissons_ratio = %g }
contact = { method = "smooth", restitution = %g, friction = %g, smooth = { law = "hertz-mindlin" } }
[[body]]
name = "hopper"
fixed = true
material = "bead"
shape = { mesh = { file = "hopper.obj" } }
[[bodies]]
name = "beads"
file = "bodies.csv"
material = "bead"
[[measure]]
name = "outflow"
kind = "mass_flow"
plane = { point = [0, 0, 0], normal = [0, 0, -1] }
interval = %.9g
""" % (STEP, DENSITY, E, NU, RESTITUTION, FRICTION, o.steps // PARTS * STEP))


def write_atoms(bodies, top):
    atoms = "".join("%d 1 %.17g %g %.17g %.17g %.17g\n" % (k + 1, 2 * r, DENSITY, x, y, z)
                    for k, (x, y, z, r) in enumerate(bodies))
    write("hopper.data", "settled hopper\n\n%d atoms\n1 atom types\n\n-0.076 0.076 xlo xhi\n-0.076 0.076 ylo yhi\n"
                         "-0.3 %.9g zlo zhi\n\nAtoms\n\n%s"
          % (len(bodies), top, atoms))


def write_peers(top):
    """Inputs of LAMMPS and LIGGGHTS."""
    common = """read_data hopper.data
neighbor %g bin
neigh_modify delay 0 every 1 check yes
%%s
fix gravity all gravity 9.81 vector 0 0 -1
fix motion all nve/sphere
timestep %g
%%s
compute above all reduce sum v_inside
thermo_style custom step c_above
thermo_modify lost ignore norm no
thermo %d
run %d
run ${steps}
""" % (o.skin, STEP, o.steps // PARTS, o.warm)
    shear = E / (2 * (1 + NU))
    law = "%.6g %.6g 3e5 3e5 %g 1" % (4 / 3 * E / (2 * (1 - NU**2)), 8 * shear / (2 * (2 - NU)), FRICTION)
    walls = ("region cyl cylinder z 0 0 0.07 0.05 %.9g side in units box open 1 open 2\n"
             "region con cone z 0 0 0.02 0.07 0.0 0.05 side in units box open 1 open 2\n" % top)
    walls += "".join("fix %s all wall/gran/region hertz/history %s region %s\n" % (r, law, r) for r in ("cyl", "con"))
    write("hopper.lammps", "units si\natom_style sphere\natom_modify map array sort 500 0.006\nboundary f f m\n"
                           "newton on\ncomm_modify vel yes\n"
          + common % ("pair_style gran/hertz/history %s\npair_coeff * *\n%s" % (law, walls),
                      'variable inside atom "mass*(z > 0.0)"'))
    properties = "".join("fix m%d all property/global %s\n" % (k, p) for k, p in enumerate(
        ("youngsModulus peratomtype %g" % E, "poissonsRatio peratomtype %g" % NU,
         "coefficientRestitution peratomtypepair 1 %g" % RESTITUTION,
         "coefficientFriction peratomtypepair 1 %g" % FRICTION)))
    walls = ("fix mesh all mesh/surface file hopper.stl type 1\n"
             "fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes mesh")
    write("hopper.liggghts", "atom_style granular\natom_modify map array sort 500 0.006\nboundary f f m\nnewton off\n"
                             "communicate single vel yes\nunits si\n"
          + common % (properties + "pair_style gran model hertz tangential history\npair_coeff * *\n" + walls,
                      "variable inside atom mass*(z>0.0)"))


def write_inputs(bodies):
    top = bodies[:, 2].max() + 0.05
    write_csv(os.path.join(o.out, "bodies.csv"), bodies)
    write_stl()
    write_scene()
    write_atoms(bodies, top)
    write_peers(top)


def flow(inside):
    """Mean mass flow [kg/s] and its standard error of the mass inside at the ends of the parts; None where some is
    missing."""
    if len(inside) != PARTS + 1:
        return None
    rates = -numpy.diff(inside) / (o.steps // PARTS * STEP)
    return rates.mean(), rates.std(ddof=1) / PARTS**0.5


def run_peer(command):
    """Processor ns per sphere and timed step, mass flow and its error [kg/s]: the same run without the timed steps is
    subtracted."""
    start, _ = processor_time(command + ["-var", "steps", "0"], o.out)
    whole, text = processor_time(command + ["-var", "steps", str(o.steps)], o.out)
    mass = {int(step): float(m) for step, m in re.findall(r"^\s*(\d+)\s+([-+.\deE]+)\s*$", text, re.M)}
    found = flow([mass[k] for k in range(o.warm, o.warm + o.steps + 1, o.steps // PARTS) if k in mass])
    if not found:
        print("%s failed:\n%s" % (command[0], text[-1500:]))
        return None
    return 1e9 * (whole - start) / o.steps / n, *found


def run_epafi():
    first, last = resumed(program, "hopper.toml", "epafi", o.warm, o.warm + o.steps, cwd=o.out)
    with open(os.path.join(o.out, "epafi", "measures.csv")) as file:
        rows = [line.strip().split(",") for line in file if ",outflow,mass," in line]
    out = {round(float(r[0]) / STEP): float(r[3]) for r in rows}
    found = flow([-out[k] for k in range(o.warm, o.warm + o.steps + 1, o.steps // PARTS) if k in out])
    return 1e9 * last["cpu_time"] / (last["steps"] - first["steps"]) / n, *(found or (numpy.nan, numpy.nan))


YADE = """import math, resource
bead = O.materials.append(FrictMat(young=%(E)g, poisson=%(nu)g, density=%(density)g,
                                   frictionAngle=math.atan(%(friction)g)))
for line in open("bodies.csv").readlines()[1:]:
    x, y, z, r = map(float, line.split(","))
    O.bodies.append(sphere((x, y, z), r, material=bead))
n, points = len(O.bodies), []
for words in map(str.split, open("hopper.obj")):
    if words[:1] == ["v"]:
        points.append(Vector3(*map(float, words[1:4])))
    elif words[:1] == ["f"]:
        corners = [points[int(w.split("/")[0]) - 1] for w in words[1:]]
        for k in range(1, len(corners) - 1):
            O.bodies.append(facet([corners[0], corners[k], corners[k + 1]], material=bead))
law = [Ip2_FrictMat_FrictMat_MindlinPhys(en=%(restitution)g)], [Law2_ScGeom_MindlinPhys_Mindlin()]
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=%(skin)g),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()], *law),
             NewtonIntegrator(damping=0, gravity=(0, 0, -9.81))]
O.dt = %(dt)g
inside = lambda: sum(O.bodies[k].state.mass for k in range(n) if O.bodies[k].state.pos[2] > 0)
used = lambda: sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
O.run(%(warm)d, True)
masses, before = [inside()], used()
for part in range(%(parts)d):
    O.run(%(part)d, True)
    masses.append(inside())
print("RESULT", used() - before, *masses)
"""


def run_yade():
    """The same of YADE, for fewer steps."""
    part = max(1, o.steps // 8 // PARTS)
    values = dict(E=E, nu=NU, density=DENSITY, friction=FRICTION, restitution=RESTITUTION, dt=STEP, skin=o.skin,
                  warm=o.warm, part=part, parts=PARTS)
    write("hopper_yade.py", YADE % values)
    result = yade_result("hopper_yade.py", o.out)
    if not result:
        return None
    rates = -numpy.diff(result[1:]) / (part * STEP)
    return 1e9 * result[0] / (part * PARTS) / n, rates.mean(), rates.std(ddof=1) / PARTS**0.5


bodies = settled(program, os.path.abspath(SCENES + "/hopper.toml"), os.path.join(o.out, "settled"), "run.duration=0.5",
                 "params.open_at=1.0")
n = len(bodies)
write_inputs(bodies)
codes = [("Epafi", run_epafi)]
if shutil.which("lmp"):
    codes.append(("LAMMPS gran/hertz/history", lambda: run_peer(["lmp", "-log", "none", "-in", "hopper.lammps"])))
if shutil.which("liggghts"):
    codes.append(("LIGGGHTS", lambda: run_peer(["liggghts", "-log", "none", "-in", "hopper.liggghts"])))
if shutil.which("yade"):
    codes.append(("YADE", run_yade))
print_table("hopper, %d spheres, one thread" % n, ["mass flow [kg/s]", "its error"], take_turns(codes, o.repeats),
            o.out, "hopper of 20 000")
