"""LIGGGHTS: Hertz, Mindlin with history, damping from the restitution. Tubes are meshes of facets.
Time: its loop time is the wall's, so processor seconds of a whole run less those of one without steps; the first one
writes the poses, a short one is clocked again without."""
import json
import os
import resource
import subprocess
import tempfile

from grains import arguments
from lammps import LONG, SKIN, data, poses_of

AXES = "xyz"


def table(values):
    """A matrix over the materials, as fix property/global takes it."""
    return "%d %s" % (len(values), " ".join("%.9g" % x for row in values for x in row))


def laws(grains):
    n = len(grains.materials)
    pairs = [[grains.pairs.get((min(i, j), max(i, j)), (0.5, 0.5)) for j in range(n)] for i in range(n)]
    words = [("youngsModulus peratomtype", " ".join("%.9g" % m for m, _ in grains.materials)),
             ("poissonsRatio peratomtype", " ".join("%.9g" % v for _, v in grains.materials)),
             ("coefficientRestitution peratomtypepair", table([[e for e, _ in row] for row in pairs])),
             ("coefficientFriction peratomtypepair", table([[f for _, f in row] for row in pairs]))]
    return ["fix law%d all property/global %s %s" % (k, name, value) for k, (name, value) in enumerate(words)]


def stl(folder, name, triangles):
    with open(os.path.join(folder, name), "w") as f:
        f.write("solid wall\n")
        for corners in triangles:
            f.write("facet normal 0 0 0\nouter loop\n")
            f.writelines("vertex %.9g %.9g %.9g\n" % p for p in corners)
            f.write("endloop\nendfacet\n")
        f.write("endsolid wall\n")


def walls(grains):
    lines = []
    for k, (axis, sign, place) in enumerate(grains.planes):
        kind = grains.kind_of_plane(axis) + 1
        lines.append("fix wall%d all wall/gran model hertz tangential history primitive type %d %splane %.17g" %
                     (k, kind, AXES[axis], place))
    for k, tube in enumerate(grains.tubes):
        # long triangles of a fine tube are refused as a mistake unless told that they are meant
        lines.append("fix tube%d all mesh/surface file tube%d.stl type %d curvature_tolerant yes" %
                     (k, k, tube["kind"] + 1))
        if tube["rate"]:
            axis = "0. 0. 1." if tube["axis"] == "z" else "0. 1. 0."
            lines.append("fix turn%d all move/mesh mesh tube%d rotate origin 0. 0. 0. axis %s period %.17g" %
                         (k, k, axis, 6.283185307179586 / tube["rate"]))
    if grains.tubes:
        names = " ".join("tube%d" % k for k in range(len(grains.tubes)))
        lines.append("fix tubes all wall/gran model hertz tangential history mesh n_meshes %d meshes %s" %
                     (len(grains.tubes), names))
    return lines


def script(grains, dt, steps, every):
    gravity = max(abs(g) for g in grains.gravity)
    radii = [b["radius"] for b in grains.bodies]
    # without hard_particles the code refuses moduli above 1 GPa and below 5 MPa each by its own switch
    hard = max(m for m, _ in grains.materials) > 1e9
    soft = min(m for m, _ in grains.materials) < 5e6
    lines = ["atom_style granular", "atom_modify map array sort 1000 0", "boundary f f f", "newton off",
             "communicate single vel yes", "units si"]
    lines += ["hard_particles yes"] * hard + ["soft_particles yes"] * soft
    # where one sphere is large, each renewal of lists is dear: fewer, longer lists
    skin = 1.5 if max(radii) > 2 * min(radii) else SKIN
    # "multi" takes no contact between a large sphere and small ones: it falls through them; cells by the largest pair
    # would hold hundreds
    lines += ["read_data grains.data", "neighbor %.9g bin" % (skin * min(radii)),
              "neigh_modify delay 0 every 1 check yes binsize %.9g" % (3 * min(radii)), *laws(grains),
              "pair_style gran model hertz tangential history", "pair_coeff * *"]
    if gravity > 0:
        lines.append("fix weight all gravity %.17g vector %s" %
                     (gravity, " ".join("%.17g" % (g / gravity) for g in grains.gravity)))
    lines += ["timestep %.17g" % dt, *walls(grains), "fix move all nve/sphere"]
    if every:
        lines += ["dump poses all custom %d poses.dump id x y z vx vy vz omegax omegay omegaz" % every,
                  'dump_modify poses sort id format "%d' + 9 * " %.14g" + '"']
    return "\n".join([*lines, "thermo %d" % max(1, steps), "thermo_modify lost ignore norm no",
                      "run %d" % steps]) + "\n"


def run(folder, text):
    """Processor seconds of the whole process."""
    with open(os.path.join(folder, "in.grains"), "w") as f:
        f.write(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    said = subprocess.run(["liggghts", "-log", "none", "-in", "in.grains"], cwd=folder, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if "Loop time of" not in said.stdout:
        raise SystemExit("liggghts: " + " ".join(line for line in (said.stdout + said.stderr).split("\n")
                                                 if "ERROR" in line)[:90])
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    grains, duration, dt, every, poses, _ = arguments()
    steps = round(duration / dt)
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "grains.data"), "w") as f:
            f.write(data(grains, len(grains.materials)))
        for k, tube in enumerate(grains.tubes):
            stl(folder, "tube%d.stl" % k, grains.triangles(tube))
        seconds = 0.0
        if poses:
            seconds = run(folder, script(grains, dt, steps, every))
            poses_of(os.path.join(folder, "poses.dump"), poses, dt)
        if seconds < LONG:
            seconds = run(folder, script(grains, dt, steps, 0))
        seconds -= run(folder, script(grains, dt, 0, 0))
    print(json.dumps(dict(cpu_s_per_s=seconds / duration, steps=steps, dt=dt)))


main()
