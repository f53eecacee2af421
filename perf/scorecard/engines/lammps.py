"""LAMMPS: Hertz, Mindlin with history, damping of Tsuji from the restitution (the laws of Epafi's default), or
law=history: gran/hertz/history with constants of the same stiffness, its quickest, whose damping is no restitution.
Time: LAMMPS' own loop time times its share of the processor; the first run writes the poses, the second is clocked."""
import json
import os
import re
import subprocess
import tempfile

from grains import arguments

AXES = "xyz"


def laws(grains, style):
    """pair_style, its coefficients, and the wall's for a friction."""
    modulus, poisson = grains.modulus
    if style == "history":
        normal = 4 / 3 * modulus / (2 * (1 - poisson**2))
        shear = 8 * modulus / (2 * (1 + poisson)) / (2 * (2 - poisson))
        numbers = "%.9g %.9g 3e5 3e5 %%.9g 1" % (normal, shear)
        return "gran/hertz/history " + numbers % grains.friction, "", lambda mu: "hertz/history " + numbers % mu
    text = "hertz/material %.9g %.9g %.9g tangential mindlin NULL 1.0 %%.9g damping tsuji" % (modulus, grains.restitution, poisson)
    return "granular", text % grains.friction, lambda mu: "granular " + text % mu


def script(grains, dt, steps, every, style):
    pair, coefficients, wall = laws(grains, style)
    gravity = max(abs(g) for g in grains.gravity)
    lines = ["units si", "atom_style sphere", "atom_modify map array sort 1000 0", "boundary f f f", "newton on", "comm_modify vel yes",
             "read_data grains.data", "pair_style " + pair, "pair_coeff * * " + coefficients,
             "neighbor %.9g bin" % (0.1 * min(b["radius"] for b in grains.bodies)), "neigh_modify delay 0 every 1 check yes",
             "timestep %.17g" % dt, "fix move all nve/sphere"]
    if gravity > 0:
        lines.append("fix weight all gravity %.17g vector %s" % (gravity, " ".join("%.17g" % (g / gravity) for g in grains.gravity)))
    for k, (axis, sign, place) in enumerate(grains.planes):
        ends = "%.17g NULL" % place if sign > 0 else "NULL %.17g" % place
        lines.append("fix wall%d all wall/gran %s %splane %s" % (k, wall(grains.friction_at(axis)), AXES[axis], ends))
    if every:
        lines += ["dump poses all custom %d poses.dump id x y z vx vy vz omegax omegay omegaz" % every,
                  'dump_modify poses sort id format float "%.14g"']
    return "\n".join([*lines, "thermo %d" % steps, "run %d" % steps]) + "\n"


def data(grains):
    """Atoms and their velocities, in a box that nothing leaves."""
    low = [min(b["position"][k] for b in grains.bodies) - 0.5 for k in range(3)]
    high = [max(b["position"][k] for b in grains.bodies) + 0.5 for k in range(3)]
    text = "grains\n\n%d atoms\n1 atom types\n\n" % len(grains.bodies)
    text += "".join("%.9g %.9g %slo %shi\n" % (low[k], high[k], a, a) for k, a in enumerate(AXES)) + "\nAtoms\n\n"
    for k, b in enumerate(grains.bodies):
        text += "%d 1 %.17g %.17g %s\n" % (k + 1, 2 * b["radius"], grains.density(b), " ".join("%.17g" % x for x in b["position"]))
    text += "\nVelocities\n\n"
    for k, b in enumerate(grains.bodies):
        text += "%d %s\n" % (k + 1, " ".join("%.17g" % x for x in b["velocity"] + b["spin"]))
    return text


def run(folder, text):
    with open(os.path.join(folder, "in.grains"), "w") as f:
        f.write(text)
    said = subprocess.run(["lmp", "-log", "none", "-in", "in.grains"], cwd=folder, capture_output=True, text=True).stdout
    loop, share = re.search(r"Loop time of (\S+)", said), re.search(r"([\d.]+)% CPU use", said)
    if not (loop and share):
        raise SystemExit("lammps: " + " ".join(said.split("\n")[-3:]))
    return float(loop[1]) * float(share[1]) / 100


def convert(dump, poses, dt):
    """LAMMPS' dump as poses; spheres are not turned."""
    with open(dump) as file, open(poses, "w") as out:
        lines = iter(file.read().split("\n"))
        for line in lines:
            if line == "ITEM: TIMESTEP":
                out.write("t %.12g\n" % (int(next(lines)) * dt))
            elif len(line.split()) == 10:
                w = line.split()[1:]
                out.write(" ".join([*w[:3], "1 0 0 0", *w[3:]]) + "\n")


def main():
    grains, duration, dt, every, poses, options = arguments()
    steps, style = round(duration / dt), options.get("law", "granular")
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "grains.data"), "w") as f:
            f.write(data(grains))
        if poses:
            run(folder, script(grains, dt, steps, every, style))
            convert(os.path.join(folder, "poses.dump"), poses, dt)
        seconds = run(folder, script(grains, dt, steps, 0, style))
    print(json.dumps(dict(cpu_s_per_s=seconds / duration, steps=steps, dt=dt)))


main()
