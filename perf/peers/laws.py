#!/usr/bin/env python3
"""The settled bed of spheres under every contact law and with 1, 2 and 5 materials, on this machine, taking turns with LAMMPS and LIGGGHTS
where they have the law.

  /usr/bin/python3 perf/peers/laws.py [--n 10000] [--steps 400] [--repeats 3] [--laws hertz,jkr] [--beside PROGRAM] [--no-peers]

Settles scenes/library/bed/bed.toml with Epafi and goes on from its last snapshot under each law, one thread, double precision, steps of
1.5e-5 s, which all laws bear. --beside: an earlier program, as a row of each law. Prints, and writes to table.md: nanoseconds of
processor time per sphere and step (median, smallest, largest), over those of the first row, and as a check the contacts of a sphere: of
Epafi the mean over the run, each contact once and walls included, of the others the other spheres that it touches.
Needs numpy; of Debian: lammps, liggghts.
"""
import os
import shutil

import numpy
from runs import options, peer, print_table, resumed, settled, take_turns, write_csv

SCENE = "scenes/library/bed/bed.toml"
STEP, E, NU, DENSITY = 1.5e-5, 5e6, 0.3, 2500
MINDLIN = " tangential mindlin NULL 1.0 0.5"
# Epafi's [contact.smooth]; pair style granular of LAMMPS (%g: modulus; not where its run loses atoms or hangs: jkr, several types); pair style
# gran of LIGGGHTS
LAWS = {
    "hertz": ('law = "hertz"', "hertz/material %g 0.6 0.3" + MINDLIN + " damping tsuji", "hertz tangential history"),
    "linear": ('law = "linear"\nstiffness = 1000', "hooke 1000 0.6 tangential linear_history 286 0 0.5 damping tsuji", "hooke tangential history"),
    "hunt-crossley": ('law = "hunt-crossley"\nreference_speed = 1', "", ""),
    "kuwabara-kono": ('law = "kuwabara-kono"\nrelaxation_time = 2e-5', "hertz/material %g 100 0.3" + MINDLIN + " damping viscoelastic", ""),
    "power-law": ('law = "power-law"\nexponent = 1.5\nstiffness = 2e4', "", ""),
    "walton-braun": ('law = "walton-braun"\nstiffness = 1000', "", ""),
    "dmt": ('law = "dmt"\nwork_of_adhesion = 0.05', "dmt %g 0.6 0.3 0.05" + MINDLIN + " damping tsuji", ""),
    "jkr": ('law = "jkr"\nwork_of_adhesion = 0.05', "", "hertz tangential history cohesion sjkr"),
    "located edges": ('law = "hertz"\nlocate_edges = true', "", ""),
    "mindlin-dashpot": ('law = "hertz"\ntangential = "mindlin-dashpot"', "", ""),
    "mindlin-deresiewicz": ('law = "hertz"\ntangential = "mindlin-deresiewicz"', "", ""),
    "rolling spring": ('law = "hertz"\nrolling = "spring"', "hertz/material %g 0.6 0.3" + MINDLIN + " rolling sds 100 0.001 0.1 damping tsuji",
                       "hertz tangential history rolling_friction epsd2"),
    "2 materials": ('law = "hertz"', "", "hertz tangential history"),
    "5 materials": ('law = "hertz"', "", "hertz tangential history"),
}

parser = options(__doc__, steps=400, warm=100, repeats=3, skin=2e-4, out="out/peers_laws")
parser.add_argument("--n", type=int, default=10000)
parser.add_argument("--laws", default=",".join(LAWS))
parser.add_argument("--beside")
parser.add_argument("--no-peers", action="store_true")
o = parser.parse_args()
program = os.path.abspath(o.program)
os.makedirs(o.out, exist_ok=True)
bed = settled(program, os.path.abspath(SCENE), os.path.join(o.out, "settled_%d" % o.n), "params.n=%d" % o.n)
side = (o.n * numpy.pi / 6 * 0.005**3 / 0.6) ** (1 / 3)


def materials_of(name):
    return int(name.split()[0]) if name.endswith("materials") else 1


def modulus(m):
    return E * (1 + 0.1 * m)


def file_of(name, end):
    return name.replace(" ", "_") + end


def write_scene(name):
    """<name>.toml: the bed in its box; the spheres of materials one after the other by turns."""
    materials = materials_of(name)
    lines = ['title = "Settled bed"', "run = { duration = %.9g, time_step = %g, output_interval = 1.0 }" % ((o.warm + o.steps + 0.5) * STEP, STEP),
             "world = { gravity = [0, 0, -9.81] }"]
    lines += ["material.m%d = { density = %g, youngs_modulus = %g, poissons_ratio = %g }" % (m, DENSITY, modulus(m), NU) for m in range(materials)]
    rolling = "rolling_friction = 0.1\n" if name == "rolling spring" else ""
    lines += ['[contact]\nmethod = "smooth"\nrestitution = 0.6\nfriction = 0.5\n%s[contact.smooth]\n%s' % (rolling, LAWS[name][0])]
    for p, n in [((0, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((side, 0, 0), (-1, 0, 0)), ((0, side, 0), (0, -1, 0))]:
        lines.append('[[body]]\nshape = { half_space = { normal = [%g, %g, %g] } }\nmaterial = "m0"\nfixed = true' % n)
        lines.append("position = [%.17g, %.17g, %.17g]" % p)
    for m in range(materials):
        write_csv(os.path.join(o.out, "bodies_%d_%d.csv" % (materials, m)), bed[m::materials])
        lines.append('[[bodies]]\nname = "bed%d"\nfile = "bodies_%d_%d.csv"\nmaterial = "m%d"' % (m, materials, m, m))
    with open(os.path.join(o.out, file_of(name, ".toml")), "w") as f:
        f.write("\n".join(lines) + "\n")


def write_peers(name):
    """<name>.lammps and <name>.liggghts, and their <name>.data."""
    materials = materials_of(name)
    with open(os.path.join(o.out, file_of(name, ".data")), "w") as f:
        f.write("settled bed\n\n%d atoms\n%d atom types\n\n%.9g %.9g xlo xhi\n%.9g %.9g ylo yhi\n" % (len(bed), materials, *(-0.01, side + 0.01) * 2))
        f.write("-0.01 %.9g zlo zhi\n\nAtoms\n\n" % (bed[:, 2].max() + 0.05))
        f.writelines("%d %d %.17g %g %.17g %.17g %.17g\n" % (k + 1, k % materials + 1, 2 * r, DENSITY, x, y, z) for k, (x, y, z, r) in enumerate(bed))
    rest = """boundary f f f
read_data %s
neighbor %g bin
neigh_modify delay 0 every 1 check yes
%%s
fix gravity all gravity 9.81 vector 0 0 -1
fix motion all nve/sphere
timestep %g
compute touching all contact/atom
compute neighbours all reduce ave c_touching
compute middle all com
thermo_style custom step atoms c_neighbours c_middle[3]
thermo %d
run %d
run ${steps}
""" % (file_of(name, ".data"), o.skin, STEP, o.warm + o.steps, o.warm)
    law = LAWS[name][1]
    laws = [law % modulus(m) if "%g" in law else law for m in range(materials)]
    coefficients = "".join("pair_coeff %d %d %s\n" % (m + 1, m + 1, laws[m]) for m in range(materials))
    walls = "\n".join("fix wall%s all wall/gran granular %s %splane 0 %s" % (a, laws[0], a, "NULL" if a == "z" else "%.17g" % side) for a in "xyz")
    with open(os.path.join(o.out, file_of(name, ".lammps")), "w") as f:
        f.write("units si\natom_style sphere\natom_modify map array sort 1000 0.006\nnewton on\ncomm_modify vel yes\n")
        f.write(rest % ("pair_style granular\n" + coefficients + walls))
    pairs = materials * materials
    properties = ["youngsModulus peratomtype " + " ".join("%g" % modulus(m) for m in range(materials)), "poissonsRatio peratomtype" + " 0.3" * materials]
    numbers = (("coefficientRestitution", 0.6), ("coefficientFriction", 0.5), ("cohesionEnergyDensity", 1000), ("coefficientRollingFriction", 0.1))
    properties += ["%s peratomtypepair %d%s" % (word, materials, " %g" % value * pairs) for word, value in numbers]
    properties += ["characteristicVelocity scalar 0.5"]
    text = "".join("fix m%d all property/global %s\n" % p for p in enumerate(properties)) + "pair_style gran model %s\npair_coeff * *\n" % LAWS[name][2]
    planes = enumerate([("x", 0.0), ("x", side), ("y", 0.0), ("y", side), ("z", 0.0)])
    text += "\n".join("fix wall%d all wall/gran model %s primitive type 1 %splane %.17g" % (k, LAWS[name][2], a, at) for k, (a, at) in planes)
    with open(os.path.join(o.out, file_of(name, ".liggghts")), "w") as f:
        f.write("atom_style granular\natom_modify map array sort 1000 0.006\nunits si\nnewton off\ncommunicate single vel yes\n" + rest % text)


def run(of, name, folder):
    first, last = resumed(of, file_of(name, ".toml"), folder, o.warm, o.warm + o.steps, cwd=o.out)
    return 1e9 * last["cpu_time"] / (last["steps"] - first["steps"]) / o.n, last["contacts_mean"] / o.n


codes = []
for law in o.laws.split(","):
    write_scene(law)
    write_peers(law)
    codes.append((law if codes else "Epafi", lambda l=law: run(program, l, "run_0")))
    if o.beside:
        codes.append((law + ", beside", lambda l=law: run(os.path.abspath(o.beside), l, "run_1")))
    for k, code in enumerate(("lmp", "liggghts"), start=1):
        if LAWS[law][k] and shutil.which(code) and not o.no_peers:
            end = ".lammps" if code == "lmp" else ".liggghts"
            codes.append((law + ", " + code, lambda c=code, l=law, e=end: (peer([c, "-log", "none", "-in", file_of(l, e)], o.steps, o.n, o.out) or (None,))[:2]))
seen = take_turns(codes, o.repeats)
print("Epafi: " + o.laws.split(",")[0])
print_table("%d spheres, one thread" % o.n, ["contacts a sphere"], {name: [r for r in rows if r[0] is not None] for name, rows in seen.items()}, o.out)
