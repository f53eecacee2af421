#!/usr/bin/env python3
"""The settled bed of spheres under every contact law and with 1, 2 and 5 materials, on this machine, taking turns with
LAMMPS and LIGGGHTS where they have the law.

  /usr/bin/python3 perf/peers/laws.py [--n 10000] [--steps 400] [--repeats 3] [--laws hertz,jkr] [--beside PROGRAM]
                                      [--no-peers]

Settles scenes/library/bed/bed.toml with Epafi and goes on from its last snapshot under each law, one thread, double
precision, steps of 1.5e-5 s, which all laws bear. --beside: an earlier program, as a row of each law. Prints, and
writes to table.md: nanoseconds of processor time per sphere and step (median, smallest, largest), over those of the
first row, and as a check the contacts of a sphere: of Epafi the mean over the run, each contact once and walls
included, of the others the other spheres that it touches. Needs numpy; of Debian: lammps, liggghts.
"""
import os
import shutil

import numpy
from bed_input import box_of_planes, lammps_walls, liggghts_walls, script, write_data
from runs import options, peer, print_table, resumed, settled, take_turns, write_csv
from tsuji import restitution_given

SCENE = "scenes/library/bed/bed.toml"
STEP, E, NU, DENSITY = 1.5e-5, 5e6, 0.3, 2500
RESTITUTION = "%.9g" % restitution_given(0.6)
MINDLIN = " tangential mindlin NULL 1.0 0.5"
# Epafi's [contact.smooth]; pair style granular of LAMMPS (%g: modulus; none for jkr and for several types, where our
# inputs give no valid run; its surface energy is half our work of adhesion); pair style gran of LIGGGHTS
LAWS = {
    "hertz": ('law = "hertz"', "hertz/material %g " + RESTITUTION + " 0.3" + MINDLIN + " damping tsuji",
              "hertz tangential history"),
    "linear": ('law = "linear"\nstiffness = 1000', "hooke 1000 0.6 tangential linear_history 286 0 0.5 damping tsuji",
               "hooke tangential history"),
    "hunt-crossley": ('law = "hunt-crossley"\nreference_speed = 1', "", ""),
    "kuwabara-kono": ('law = "kuwabara-kono"\nrelaxation_time = 2e-5',
                      "hertz/material %g 100 0.3" + MINDLIN + " damping viscoelastic", ""),
    "power-law": ('law = "power-law"\nexponent = 1.5\nstiffness = 2e4', "", ""),
    "walton-braun": ('law = "walton-braun"\nstiffness = 1000', "", ""),
    "dmt": ('law = "dmt"\nwork_of_adhesion = 0.05', "dmt %g " + RESTITUTION + " 0.3 0.025" + MINDLIN
            + " damping tsuji", ""),
    "jkr": ('law = "jkr"\nwork_of_adhesion = 0.05', "", "hertz tangential history cohesion sjkr"),
    "located edges": ('law = "hertz"\nlocate_edges = true', "", ""),
    "mindlin-dashpot": ('law = "hertz"\ntangential = "mindlin-dashpot"', "", ""),
    "mindlin-deresiewicz": ('law = "hertz"\ntangential = "mindlin-deresiewicz"', "", ""),
    "rolling spring": ('law = "hertz"\nrolling = "spring"',
                       "hertz/material %g " + RESTITUTION + " 0.3" + MINDLIN
                       + " rolling sds 100 0.001 0.1 damping tsuji",
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


def write(name, end, text):
    with open(os.path.join(o.out, file_of(name, end)), "w") as f:
        f.write(text)


def write_scene(name):
    """<name>.toml: the bed in its box; the spheres of materials one after the other by turns."""
    materials = materials_of(name)
    duration = (o.warm + o.steps + 0.5) * STEP
    lines = ['title = "Settled bed"', "world = { gravity = [0, 0, -9.81] }",
             "run = { duration = %.9g, time_step = %g, output_interval = 1.0 }" % (duration, STEP)]
    for m in range(materials):
        constants = (m, DENSITY, modulus(m), NU)
        lines.append("material.m%d = { density = %g, youngs_modulus = %g, poissons_ratio = %g }" % constants)
    lines.append('[contact]\nmethod = "smooth"\nrestitution = 0.6\nfriction = 0.5')
    if name == "rolling spring":
        lines.append("rolling_friction = 0.1")
    lines.append("[contact.smooth]\n" + LAWS[name][0])
    lines.append(box_of_planes(side, "m0"))
    for m in range(materials):
        write_csv(os.path.join(o.out, "bodies_%d_%d.csv" % (materials, m)), bed[m::materials])
        lines.append('[[bodies]]\nname = "bed%d"\nfile = "bodies_%d_%d.csv"\nmaterial = "m%d"' % (m, materials, m, m))
    write(name, ".toml", "\n".join(lines) + "\n")


def write_peers(name):
    """<name>.lammps and <name>.liggghts, and their <name>.data."""
    materials = materials_of(name)
    data = file_of(name, ".data")
    write_data(os.path.join(o.out, data), bed, side, DENSITY, materials)
    law = LAWS[name][1]
    laws = [law % modulus(m) if "%g" in law else law for m in range(materials)]
    pair = "pair_style granular\n"
    pair += "".join("pair_coeff %d %d %s\n" % (m, m, text) for m, text in enumerate(laws, start=1))
    write(name, ".lammps", script("lammps", data, pair + lammps_walls("granular " + laws[0], side), o, STEP))
    properties = ["youngsModulus peratomtype " + " ".join("%g" % modulus(m) for m in range(materials)),
                  "poissonsRatio peratomtype" + " 0.3" * materials, "characteristicVelocity scalar 0.5"]
    for word, value in (("coefficientRestitution", 0.6), ("coefficientFriction", 0.5), ("cohesionEnergyDensity", 1000),
                        ("coefficientRollingFriction", 0.1)):
        properties.append("%s peratomtypepair %d%s" % (word, materials, " %g" % value * materials**2))
    pair = "".join("fix m%d all property/global %s\n" % p for p in enumerate(properties))
    pair += "pair_style gran model %s\npair_coeff * *\n" % LAWS[name][2]
    write(name, ".liggghts", script("liggghts", data, pair + liggghts_walls(LAWS[name][2], side), o, STEP))


def run(of, name, folder):
    first, last = resumed(of, file_of(name, ".toml"), folder, o.warm, o.warm + o.steps, cwd=o.out)
    return 1e9 * last["cpu_time"] / (last["steps"] - first["steps"]) / o.n, last["contacts_mean"] / o.n


def run_peer(code, name):
    end = ".lammps" if code == "lmp" else ".liggghts"
    seen = peer([code, "-log", "none", "-in", file_of(name, end)], o.steps, o.n, o.out)
    return (seen or (None,))[:2]


codes = []
for law in o.laws.split(","):
    write_scene(law)
    write_peers(law)
    codes.append((law if codes else "Epafi", lambda l=law: run(program, l, "run_0")))
    if o.beside:
        codes.append((law + ", beside", lambda l=law: run(os.path.abspath(o.beside), l, "run_1")))
    for k, code in enumerate(("lmp", "liggghts"), start=1):
        if LAWS[law][k] and shutil.which(code) and not o.no_peers:
            codes.append((law + ", " + code, lambda c=code, l=law: run_peer(c, l)))
seen = take_turns(codes, o.repeats)
print("Epafi: " + o.laws.split(",")[0])
valid = {name: [r for r in rows if r[0] is not None] for name, rows in seen.items()}
print_table("%d spheres, one thread" % o.n, ["contacts a sphere"], valid, o.out)
