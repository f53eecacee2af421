#!/usr/bin/env python3
"""Discharge of a silo side by side with LIGGGHTS, from one settled state, on this machine, taking turns: 30 000 spheres
of 4 mm leave an orifice of 60 mm, after case 1 of Dosta et al., Comput. Phys. Commun. 296 (2024) 109066, with moduli a
hundred times softer and steps ten times longer, so that a step is the same part of the contact time.

  /usr/bin/python3 perf/peers/silo.py [--steps 6000] [--repeats 3] [--out out/peers_silo] [--program ./epafi]
                                      [--beside PROGRAM]

Epafi fills the silo, with a modulus of a fifth and longer steps. Both codes take its walls as the same triangles;
Hertz, Mindlin with history and dashpots from the restitution, one thread, double precision. The orifice opens at step
0. Prints, and writes to table.md: nanoseconds of processor time per sphere of the start and step, the spheres that
leave in a second at full flow (last half of the steps) and its standard error; to discharge.csv how many are left at
every twentieth of the steps. --beside: an earlier program. Needs numpy; of Debian: liggghts.
"""
import math
import os
import re
import shutil

import numpy
from runs import options, print_table, processor_time, resumed, settled, take_turns, write_csv

COUNT, RADIUS, STEP, DENSITY, E, STEEL, NU = 30000, 2e-3, 1.5e-5, 2500.0, 1e7, 210e9, 0.2
ORIFICE, SIDE, LOW, HIGH, TOP = 0.03, 0.1, -0.07, 0.0, 0.32  # radii; ends of the cone, top of the cylinder [m]
PARTS, AROUND = 20, 96
# zeta_t over the critical damping of a sphere that gives the dashpot 2 sqrt(5/6) beta sqrt(k_t m*) of LIGGGHTS
OF_GRAINS, OF_WALL = (math.sqrt(5 / 6 * 7 / 2) * -math.log(e) / math.hypot(math.log(e), math.pi) for e in (0.5, 0.4))

SCENE = """title = "Silo"
run = {{ duration = {duration}, time_step = {step}, output_interval = 10.0, allow_unstable = true }}
[world]
gravity = [0, 0, -9.81]
domain = {{ min = [-0.11, -0.11, -0.12], max = [0.11, 0.11, 0.6], outside = "delete" }}
[bounds]
energy_error = 0.05
[material]
grain = {{ density = {density}, youngs_modulus = {E}, poissons_ratio = {nu} }}
steel = {{ density = 7200.0, youngs_modulus = {steel}, poissons_ratio = {nu} }}
[contact]
method = "smooth"
restitution = 0.4
friction = 0.2
smooth = {{ law = "hertz-mindlin", tangential = "mindlin-dashpot", tangential_damping = {of_wall:.6f} }}
pair = [{{ between = ["grain", "grain"], restitution = 0.5, friction = 0.3, tangential_damping = {of_grains:.6f} }}]
[[body]]
name = "silo"
fixed = true
material = "steel"
shape = {{ mesh = {{ file = "silo.obj" }} }}
"""
FILL = """[[body]]
name = "gate"
fixed = true
material = "steel"
shape = {{ half_space = {{ normal = [0, 0, 1] }} }}
position = [0, 0, {low}]
[[fill]]
name = "grains"
shape = "grain"
material = "grain"
count = {count}
method = "random"
region = {{ box = {{ min = [-0.066, -0.066, 0.02], max = [0.066, 0.066, 0.3] }} }}
[shape.grain]
sphere = {{ radius = {radius} }}
"""
OPEN = """[[bodies]]
name = "grains"
file = "bodies.csv"
material = "grain"
[[measure]]
name = "out"
kind = "mass_flow"
plane = {{ point = [0, 0, {low}], normal = [0, 0, -1] }}
interval = {interval}
"""
LIGGGHTS = """atom_style granular
atom_modify map array sort 1000 0.006
boundary f f f
newton off
communicate single vel yes
units si
hard_particles yes
read_data silo.data
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes
fix m1 all property/global youngsModulus peratomtype {E} {steel}
fix m2 all property/global poissonsRatio peratomtype {nu} {nu}
fix m3 all property/global coefficientRestitution peratomtypepair 2 0.5 0.4 0.4 0.4
fix m4 all property/global coefficientFriction peratomtypepair 2 0.3 0.2 0.2 0.2
pair_style gran model hertz tangential history
pair_coeff * *
fix g all gravity 9.81 vector 0.0 0.0 -1.0
timestep {step}
fix mesh all mesh/surface file silo.stl type 2 curvature_tolerant yes
fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes mesh
fix i all nve/sphere
variable in atom "z > {low}"
compute in all reduce sum v_in
thermo_style custom step c_in
thermo {part}
thermo_modify lost ignore norm no
run ${{steps}}
"""

parser = options(__doc__, steps=6000, warm=0, repeats=3, skin=8e-4, out="out/peers_silo")
parser.add_argument("--beside")
o = parser.parse_args()
if o.steps % PARTS:
    parser.error("--steps must be a multiple of %d" % PARTS)
os.makedirs(o.out, exist_ok=True)
VALUES = dict(step=STEP, density=DENSITY, E=E, steel=STEEL, nu=NU, of_grains=OF_GRAINS, of_wall=OF_WALL, low=LOW,
              count=COUNT, radius=RADIUS, interval=o.steps // PARTS * STEP, skin=o.skin, part=o.steps // PARTS)


def write(name, text):
    with open(os.path.join(o.out, name), "w") as f:
        f.write(text)


def write_walls():
    """Rings of triangles, the cone from the orifice up and the cylinder."""
    rings = [(ORIFICE + (SIDE - ORIFICE) * k / 8, LOW + (HIGH - LOW) * k / 8) for k in range(9)]
    rings += [(SIDE, TOP * k / 5) for k in range(1, 6)]
    points = [(r * math.cos(2 * math.pi * k / AROUND), r * math.sin(2 * math.pi * k / AROUND), z)
              for r, z in rings for k in range(AROUND)]
    faces = []
    for ring in range(len(rings) - 1):
        for k in range(AROUND):
            a, b = ring * AROUND + k, ring * AROUND + (k + 1) % AROUND
            faces += [(a, a + AROUND, b), (b, a + AROUND, b + AROUND)]
    write("silo.obj", "".join("v %.9g %.9g %.9g\n" % p for p in points) +
          "".join("f %d %d %d\n" % tuple(c + 1 for c in f) for f in faces))
    write("silo.stl", "solid silo\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex %.9g %.9g %.9g\n" % points[c] for c in f) +
        "endloop\nendfacet\n" for f in faces) + "endsolid silo\n")


def write_inputs(bodies):
    write_csv(os.path.join(o.out, "bodies.csv"), bodies)
    write("silo.toml", (SCENE + OPEN).format(duration=(o.steps + 0.5) * STEP, **VALUES))
    atoms = "".join("%d 1 %.17g %g %.17g %.17g %.17g\n" % (k + 1, 2 * r, DENSITY, x, y, z)
                    for k, (x, y, z, r) in enumerate(bodies))
    write("silo.data", "settled silo\n\n%d atoms\n2 atom types\n\n-0.11 0.11 xlo xhi\n-0.11 0.11 ylo yhi\n"
                       "-0.12 0.6 zlo zhi\n\nAtoms\n\n%s" % (len(bodies), atoms))
    write("silo.liggghts", LIGGGHTS.format(**VALUES))


left = {}


def flow(name, inside):
    """Spheres a second in the last half and the standard error of that from its parts; the curve is kept."""
    left[name] = inside
    rates = -numpy.diff(inside[PARTS // 2:]) / VALUES["interval"]
    return rates.mean(), rates.std(ddof=1) / len(rates)**0.5


def run_epafi(of, name):
    _, last = resumed(os.path.abspath(of), "silo.toml", name, 1, o.steps, cwd=o.out)
    with open(os.path.join(o.out, name, "measures.csv")) as file:
        rows = [line.strip().split(",") for line in file if ",out,mass," in line]
    of_one = DENSITY * 4 / 3 * math.pi * RADIUS**3
    out = {round(float(r[0]) / STEP): float(r[3]) / of_one for r in rows}
    inside = [n - out.get(k, 0.0) for k in range(0, o.steps + 1, o.steps // PARTS)]
    return 1e9 * last["cpu_time"] / (o.steps - 1) / n, *flow(name, inside)


def run_liggghts():
    command = ["liggghts", "-log", "none", "-in", "silo.liggghts"]
    start, _ = processor_time(command + ["-var", "steps", "0"], o.out)
    whole, text = processor_time(command + ["-var", "steps", str(o.steps)], o.out)
    seen = {int(step): float(m) for step, m in re.findall(r"^\s*(\d+)\s+([-+.\deE]+)\s*$", text, re.M)}
    inside = [seen.get(k, numpy.nan) for k in range(0, o.steps + 1, o.steps // PARTS)]
    return 1e9 * (whole - start) / o.steps / n, *flow("liggghts", inside)


write_walls()
write("fill.toml", (SCENE + FILL).format(duration=0.36, **dict(VALUES, E=E / 5, step=4e-5)))
bodies = settled(os.path.abspath(o.program), os.path.join(o.out, "fill.toml"), os.path.join(o.out, "filled"))
n = len(bodies)
write_inputs(bodies)
codes = [("Epafi", lambda: run_epafi(o.program, "epafi"))]
if o.beside:
    codes.append(("Epafi, beside", lambda: run_epafi(o.beside, "beside")))
if shutil.which("liggghts"):
    codes.append(("LIGGGHTS", run_liggghts))
print_table("silo of %d spheres, one thread" % n, ["spheres a second", "their error"], take_turns(codes, o.repeats),
            o.out, "silo of 30 000")
write("discharge.csv", "step,%s\n" % ",".join(left) + "".join(
    "%d,%s\n" % (k * (o.steps // PARTS), ",".join("%.0f" % left[name][k] for name in left)) for k in range(PARTS + 1)))
