"""LAMMPS: Hertz, Mindlin with history, damping of Tsuji from the restitution (the laws of Epafi's default), or
law=history: gran/hertz/history with constants of the same stiffness, its quickest, whose damping is no restitution.
Time: LAMMPS' own loop time times its share of the processor; the first run writes the poses, a short one is clocked
again without."""
import json
import os
import re
import subprocess
import sys
import tempfile

from grains import arguments

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "peers"))
from tsuji import restitution_given  # noqa: E402

AXES = "xyz"
SKIN = 0.4  # of the least radius: with a quarter of it grains that fall renew all lists in every other step
LONG = 5.0  # s: a run that takes so long counts itself, since a few poses are nothing beside it


def law(pair, style, wall=False):
    """Coefficients of a pair of materials, (modulus, Poisson's ratio, restitution, friction), for grains or for a
    wall."""
    modulus, poisson, restitution, friction = pair
    if style == "history":
        normal = 4 / 3 * modulus / (2 * (1 - poisson**2))
        shear = 8 * modulus / (2 * (1 + poisson)) / (2 * (2 - poisson))
        return "%.9g %.9g 3e5 3e5 %.9g 1" % (normal, shear, friction)
    stiff = modulus / (1 + poisson) if wall else modulus  # with a wall it takes E / 2 (1 - nu) for E*
    return "hertz/material %.9g %.9g %.9g tangential mindlin NULL 1.0 %.9g damping tsuji" % (
        stiff, restitution_given(restitution), poisson, friction)


def grains_and_walls(grains, style):
    """Pair style and one fix for each kind of grain and each wall, since a wall has one law for a group."""
    kinds = grains.kinds()
    lines = ["group kind%d type %d" % (k, k + 1) for k in kinds]
    if style == "history":  # it has its numbers in the style: one material
        lines.append("pair_style gran/hertz/history " + law(grains.pair(kinds[0], kinds[0]), style))
        lines.append("pair_coeff * *")
    else:
        lines.append("pair_style granular")
        pairs = [(a, b) for a in kinds for b in kinds if a <= b]
        # a pair that never touches must have coefficients all the same
        lines += ["pair_coeff %d %d %s" % (a + 1, b + 1, law(grains.pair(a, b) or grains.pair(a, a), style))
                  for a, b in pairs]
    word = "hertz/history " if style == "history" else "granular "
    for k, (axis, sign, place) in enumerate(grains.planes):
        ends = "%.17g NULL" % place if sign > 0 else "NULL %.17g" % place
        for kind in kinds:
            wall = law(grains.pair(kind, grains.kind_of_plane(axis)), style, True)
            lines.append("fix wall%d_%d kind%d wall/gran %s%s %splane %s" %
                         (k, kind, kind, word, wall, AXES[axis], ends))
    for k, tube in enumerate(grains.tubes):
        lines += region(k, tube)
        for kind in kinds:
            wall = law(grains.pair(kind, tube["kind"]), style, True)
            lines.append("fix tube%d_%d kind%d wall/gran/region %s%s region tube%d" % (k, kind, kind, word, wall, k))
    return lines


def region(k, tube):
    """A hollow wall with open ends; its surface moves where the region turns."""
    lines, turning = [], ""
    if tube["rate"]:
        lines.append('variable angle%d equal "%.17g*step*dt"' % (k, tube["rate"]))
        turning = " rotate v_angle%d 0 0 0 %s" % (k, "0 0 1" if tube["axis"] == "z" else "0 1 0")
    places = "%s 0 0 %.17g %.17g %.17g %.17g" % (tube["axis"], *tube["radii"], tube["low"], tube["high"])
    return [*lines, "region tube%d cone %s side in open 1 open 2 units box%s" % (k, places, turning)]


def script(grains, dt, steps, every, style):
    gravity = max(abs(g) for g in grains.gravity)
    radii = [b["radius"] for b in grains.bodies]
    # cells by the largest pair would hold hundreds of small grains: by types where sizes differ much
    bins = "multi" if max(radii) > 2 * min(radii) else "bin"
    lines = ["units si", "atom_style sphere", "atom_modify map array sort 1000 0", "boundary s s s", "newton on",
             "comm_modify vel yes",
             "read_data grains.data", *grains_and_walls(grains, style), "neighbor %.9g %s" % (SKIN * min(radii), bins),
             "neigh_modify delay 0 every 1 check yes", "timestep %.17g" % dt, "fix move all nve/sphere"]
    if gravity > 0:
        lines.append("fix weight all gravity %.17g vector %s" %
                     (gravity, " ".join("%.17g" % (g / gravity) for g in grains.gravity)))
    if every:
        lines += ["dump poses all custom %d poses.dump id x y z vx vy vz omegax omegay omegaz" % every,
                  'dump_modify poses sort id format float "%.14g"']
    return "\n".join([*lines, "thermo %d" % steps, "run %d" % steps]) + "\n"


def data(grains, types):
    """Atoms and their velocities, in a box that nothing leaves."""
    # LIGGGHTS keeps this box, whose cells are as small as a grain: a wide one has billions; LAMMPS shrinks it to the
    # atoms
    pad = 100 * min(b["radius"] for b in grains.bodies)
    places = [[b["position"][k] for b in grains.bodies] + [p for axis, _, p in grains.planes if axis == k]
              for k in range(3)]
    for tube in grains.tubes:
        for k, axis in enumerate(AXES):
            places[k] += (tube["low"], tube["high"]) if axis == tube["axis"] else (-max(tube["radii"]),
                                                                                   max(tube["radii"]))
    low, high = [min(p) - pad for p in places], [max(p) + pad for p in places]
    text = "grains\n\n%d atoms\n%d atom types\n\n" % (len(grains.bodies), types)
    text += "".join("%.9g %.9g %slo %shi\n" % (low[k], high[k], a, a) for k, a in enumerate(AXES)) + "\nAtoms\n\n"
    for k, b in enumerate(grains.bodies):
        place = " ".join("%.17g" % x for x in b["position"])
        text += "%d %d %.17g %.17g %s\n" % (k + 1, b["kind"] + 1, 2 * b["radius"], grains.density(b), place)
    text += "\nVelocities\n\n"
    for k, b in enumerate(grains.bodies):
        text += "%d %s\n" % (k + 1, " ".join("%.17g" % x for x in b["velocity"] + b["spin"]))
    return text


def run(folder, text):
    with open(os.path.join(folder, "in.grains"), "w") as f:
        f.write(text)
    said = subprocess.run(["lmp", "-log", "none", "-in", "in.grains"], cwd=folder, capture_output=True,
                          text=True).stdout
    loop, share = re.search(r"Loop time of (\S+)", said), re.search(r"([\d.]+)% CPU use", said)
    if not (loop and share):
        raise SystemExit("lammps: " + " ".join(line for line in said.split("\n") if "ERROR" in line)[:90])
    return float(loop[1]) * float(share[1]) / 100


def poses_of(dump, poses, dt):
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
            f.write(data(grains, max(grains.kinds()) + 1))
        seconds = 0.0
        if poses:
            seconds = run(folder, script(grains, dt, steps, every, style))
            poses_of(os.path.join(folder, "poses.dump"), poses, dt)
        if seconds < LONG:
            seconds = run(folder, script(grains, dt, steps, 0, style))
    print(json.dumps(dict(cpu_s_per_s=seconds / duration, steps=steps, dt=dt)))


if __name__ == "__main__":
    main()
