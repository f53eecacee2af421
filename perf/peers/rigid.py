#!/usr/bin/env python3
"""Stacks, unequal masses, pyramids and piles of polyhedra side by side with Bullet, ODE and MuJoCo: the same bodies, on
this machine, in turns.

  /usr/bin/python3 perf/peers/rigid.py [--cases stack-100 pyramid-50 mass-10000 pile-1000 ...] [--repeats 1] [--out
  out/peers_rigid] [--program ./epafi]

Cases: stack-N (dt 1/240), mass-Q (the upper of two boxes Q times heavier, 1/240), pyramid-N (1/60), pile-N (1/240;
bodies of scenes/library/pile/poly_1000.polyset or of --bodies FILE). Every engine reads one file of bodies
(perf/peers/rigid/driver.h), runs 10 s (pyramid 5, pile 4) on one thread and writes its poses each 0.1 s. One judge for
all, which shares nothing with any engine: the separating axis test over all face normals and pairs of edges, in double
precision. Prints, and writes to table.md: milliseconds of processor time per step (median of the last half, of piles of
the last 15 %), the deepest overlap ever and at the end, drift and sag from the start [mm], in piles overlaps relative
to the sum of both radii, their mean and who left the box, and the speed left over, sqrt(2 T/m) [mm/s]. Engines that are
not installed have no row. Box3D and Jolt are no packages of Debian: below the others stand their figures of another
machine (elsewhere/rigid.csv), in italics; only their errors can be compared. Needs numpy and h5py; of Debian: g++,
libbullet-dev, libode-dev, libmujoco-dev.
"""
import argparse
import csv
import itertools
import os
import shutil
import statistics
import subprocess

import h5py
import numpy
from runs import resumed, without_output, write_table

HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "rigid")
BULLET = ["-DBT_USE_DOUBLE_PRECISION", "-I/usr/include/bullet"]
ENGINES = {  # name: source, flags, libraries, header that must be there, variants of options
    "Bullet": ("bullet.cpp", BULLET, ["-lBulletDynamics-float64", "-lBulletCollision-float64", "-lLinearMath-float64"],
               "/usr/include/bullet/btBulletDynamicsCommon.h", [[], ["iterations=100"]]),
    "ODE": ("ode.cpp", [], ["-lode"], "/usr/include/ode/ode.h", [[], ["iterations=100"]]),
    "MuJoCo": ("mujoco.cpp", [], ["-lmujoco"], "/usr/include/mujoco/mujoco.h", [[], ["hard=1"]]),
}
PILE = "scenes/library/pile/poly_1000.polyset"
EPAFI = {"pile": [["solver=pgs"], ["solver=soft-step", "iterations=4"]],
         "": [["solver=newton", "iterations=100"], ["solver=soft-step", "iterations=4"]]}

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--cases", nargs="+", default=["stack-20", "stack-100", "mass-10000", "pyramid-50", "pile-1000"])
parser.add_argument("--bodies", default=PILE, help="a .polyset for pile-N")
parser.add_argument("--engines", nargs="+", default=["Epafi", *ENGINES])
parser.add_argument("--repeats", type=int, default=1)
parser.add_argument("--seconds", type=float, help="of simulated time, in the place of 10, 5 and 4")
parser.add_argument("--limit", type=float, default=600.0, help="processor seconds of one run")
parser.add_argument("--out", default="out/peers_rigid")
parser.add_argument("--program", default="./epafi")
o = parser.parse_args()
program = os.path.abspath(o.program)
os.makedirs(o.out, exist_ok=True)

CORNERS = numpy.array(list(itertools.product((-1, 1), repeat=3)), float)
BOX_TRIANGLES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
                 (0, 6, 4), (1, 5, 7), (1, 7, 3)]


class Body:
    """A convex body: vertices about the centre of mass, triangles, mass (0: fixed), moments, place,
    orientation w x y z."""

    def __init__(self, vertices, triangles, mass, moments, place, turn=(1, 0, 0, 0)):
        self.vertices, self.triangles = numpy.asarray(vertices, float), triangles
        self.mass, self.moments = mass, numpy.asarray(moments, float)
        self.place, self.turn = numpy.asarray(place, float), numpy.asarray(turn, float)
        self.radius = numpy.linalg.norm(self.vertices, axis=1).max()
        corners = self.vertices[numpy.array(triangles)]
        normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.normals = distinct(normals)
        pairs = {tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3)}
        self.edges = distinct(numpy.array([self.vertices[j] - self.vertices[i] for i, j in sorted(pairs)]))


def distinct(vectors):
    """Directions of which none is another one's, nor its opposite."""
    unit = vectors / numpy.linalg.norm(vectors, axis=1)[:, None]
    kept = []
    for v in unit:
        if not kept or numpy.abs(numpy.array(kept) @ v).max() < 1 - 1e-12:
            kept.append(v)
    return numpy.array(kept)


def box(half, place, density=1000.0):
    half = numpy.asarray(half, float)
    mass = 8 * half.prod() * density
    return Body(CORNERS * half, BOX_TRIANGLES, mass, mass / 3 * ((half**2).sum() - half**2), place)


def read_polyset(name):
    with open(name) as file:
        words = [line.split() for line in file if line[:1] in "pbvf"]
    side, bodies, k = float(words[0][4]), [], 1
    while k < len(words):
        n, m = int(words[k][1]), int(words[k][2])
        x = [float(w) for w in words[k][3:]]
        vertices = [[float(w) for w in row[1:4]] for row in words[k + 1 : k + 1 + n]]
        triangles = [tuple(int(w) for w in row[1:4]) for row in words[k + 1 + n : k + 1 + n + m]]
        bodies.append(Body(vertices, triangles, x[0], x[1:4], x[4:7], x[7:11]))
        k += 1 + n + m
    return side, bodies


def case(name):
    """Fixed and free bodies, dt, seconds, and Epafi's scene with its settings."""
    kind, number = name.rsplit("-", 1)
    n = int(number)
    ground = [box((100, 100, 1), (0, 0, -1), 0.0)]
    folder = "scenes/library/"
    if kind == "stack":
        return ground, [box([0.5] * 3, (0, 0, 0.5 + k))
                        for k in range(n)], 1 / 240, 10.0, folder + "stacking/stack.toml", ["params.n=%d" % n]
    if kind == "mass":
        return ground, [box([0.5] * 3, (0, 0, 0.5)),
                        box([0.5] * 3, (0, 0, 1.5),
                            1000.0 * n)], 1 / 240, 10.0, folder + "stacking/heavy_boxes.toml", ["params.q=%d" % n]
    if kind == "pyramid":
        free = [box([0.5] * 3, (1.05 * (j - (n - k - 1) / 2), 0, 0.5 + k)) for k in range(n) for j in range(n - k)]
        return ground, free, 1 / 60, 5.0, folder + "stacking/pyramid.toml", ["params.n=%d" % n]
    side, free = read_polyset(o.bodies)
    assert len(free) == n, "%s has %d bodies, not %d: name the right file with --bodies" % (o.bodies, len(free), n)
    wall, t = side / 2, 0.25
    walls = [box((wall + 1, wall + 1, t), (0, 0, -t), 0.0)]
    walls += [box((t, wall + 1, 6), (s * (wall + t), 0, 6), 0.0)
              for s in (1, -1)] + [box((wall + 1, t, 6), (0, s * (wall + t), 6), 0.0) for s in (1, -1)]
    return walls, free, 1 / 240, 4.0, folder + "pile/polyhedra.toml", ["bodies.0.file=%s" % os.path.abspath(o.bodies),
                                                                       "params.side=%.9g" % side]


def write_bodies(name, bodies):
    with open(name, "w") as f:
        for b in bodies:
            f.write("b %d %d " % (len(b.vertices), len(b.triangles)) +
                    " ".join("%.17g" % x for x in (b.mass, *b.moments, *b.place, *b.turn)) + "\n")
            f.writelines("v %.17g %.17g %.17g\n" % tuple(v) for v in b.vertices)
            f.writelines("f %d %d %d\n" % tuple(t) for t in b.triangles)


def rotation(q):
    w, x, y, z = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def depth(a, b):
    """Overlap of two placed bodies, each (vertices, normals, edges): the least over all axes that may separate them; <=
    0: apart."""
    least = numpy.inf
    for axes in (a[1], b[1], numpy.cross(a[2][:, None], b[2][None]).reshape(-1, 3)):
        length = numpy.linalg.norm(axes, axis=1)
        axes = axes[length > 1e-8] / length[length > 1e-8, None]
        p, q = axes @ a[0].T, axes @ b[0].T
        least = min(least, numpy.minimum(p.max(1) - q.min(1), q.max(1) - p.min(1)).min(initial=numpy.inf))
        if least <= 0:
            break
    return least


def overlaps(fixed, free, poses):
    """Of all pairs that overlap: depth [m] and sum of the radii of free bodies."""
    placed = []
    for b, pose in zip(fixed + free, [(*b.place, *b.turn) for b in fixed] + [p[:7] for p in poses]):
        r = rotation(pose[3:7])
        placed.append((b.vertices @ r.T + pose[:3], b.normals @ r.T, b.edges @ r.T))
    low, high = (numpy.array([f(p[0], axis=0) for p in placed]) for f in (numpy.min, numpy.max))
    radius = [0.0] * len(fixed) + [b.radius for b in free]
    found = []
    for i in range(len(fixed), len(placed)):
        near = numpy.flatnonzero((low[:i] <= high[i]).all(1) & (high[:i] >= low[i]).all(1))
        for j in near:
            d = depth(placed[i], placed[j])
            if d > 0:
                found.append((d, radius[i] + radius[j]))
    return numpy.array(found).reshape(-1, 2)


def judge(name, fixed, free, samples):
    """The columns of the table from poses: samples of position, orientation, velocity, angular velocity by free
    body."""
    pile = name.startswith("pile")
    start = numpy.array([b.place for b in free])
    last = samples[-1]
    if not numpy.isfinite(last).all():
        return ["lost"] * 6
    looked = [overlaps(fixed, free, s) for s in (samples[-1:] if pile else samples)]
    share = [f[:, 0] / (f[:, 1] if pile else 1.0) for f in looked]
    worst, end, mean = max(s.max(initial=0.0)
                           for s in share), share[-1].max(initial=0.0), share[-1].mean() if len(share[-1]) else 0.0
    moved = last[:, :3] - start
    mass = numpy.array([b.mass for b in free])
    twice = 0.0
    for b, m in zip(free, last):
        twice += b.mass * (m[7:10] ** 2).sum() + (b.moments * (rotation(m[3:7]).T @ m[10:13]) ** 2).sum()
    speed = "%.2g" % (1e3 * (twice / mass.sum()) ** 0.5)
    if pile:
        wall = [b.place[:2] for b in fixed[1:]]
        half = numpy.abs(wall).max() - 0.25
        gone = int(((last[:, 2] < 0) | (numpy.abs(last[:, :2]) > half).any(1)).sum())
        return ["%.2f %%" % (100 * worst), "%.2f %%" % (100 * end), "%.3f %%" % (100 * mean), "%d gone" % gone, "-",
                speed]
    sideways, sag = numpy.linalg.norm(moved[:, :2], axis=1).max(), -moved[:, 2].min()
    stands = "yes" if sideways < 0.25 and sag < 0.5 else "falls"
    return ["%.3g" % (1e3 * worst), "%.3g" % (1e3 * end), stands, "%.3g" % (1e3 * sideways), "%.3g" % (1e3 * sag),
            speed]


def read_poses(name):
    samples = []
    with open(name) as file:
        for line in file:
            if line[0] == "t":
                samples.append([])
            else:
                samples[-1].append([float(w) for w in line.split()])
    return [numpy.array(s) for s in samples]


def elsewhere(name):
    """Rows of engines that are not run here: figures of another machine."""
    with open(os.path.join(HERE, "..", "elsewhere", "rigid.csv")) as file:
        rows = list(csv.DictReader(line for line in file if line[0] != "#"))
    return ["| %s | *%s* | *%s* | %s |" % (name, r["engine"], r["ms"], " | ".join(list(r.values())[3:])) for r in rows
            if r["case"] == name]


def drivers():
    """Programs of the engines that are installed, by name."""
    built = {}
    for name, (source, flags, libraries, header, _) in ENGINES.items():
        if name not in o.engines or not os.path.exists(header) or not shutil.which("g++"):
            continue
        target = os.path.join(os.path.abspath(o.out), name)
        subprocess.run(["g++", "-O2", "-std=c++17", *flags, os.path.join(HERE, source), "-o", target, *libraries],
                       check=True)
        built[name] = target
    return built


def run_peer(driver, options, dt, seconds, share):
    """Milliseconds per step (median of that share of the steps, 0.5 or 0.15) and poses; None where it does not end."""
    steps = round(seconds / dt)
    command = [driver, "bodies.txt", "%.17g" % dt, str(steps), str(round(0.1 / dt)), "poses.txt", *options]
    try:
        text = subprocess.run(command, cwd=o.out, capture_output=True, text=True, timeout=4 * o.limit).stdout
    except subprocess.TimeoutExpired:
        return None
    times = [line.split()[1:] for line in text.splitlines() if line.startswith("ms ")]
    return (float(times[0][share == 0.15]), read_poses(os.path.join(o.out, "poses.txt"))) if times else None


def run_epafi(scene, settings, dt, seconds, free, share):
    """The same of Epafi, a mean by the clocks of its stages; a second run writes the poses."""
    folder = os.path.join(o.out, "epafi")
    words = [w for s in (*settings, "run.time_step=%.17g" % dt, "run.duration=%.17g" % seconds,
                         "run.output_interval=0.1") for w in ("--set", s)]
    steps = round(seconds / dt)
    # a stack that falls breaks a bound of its scene and ends there
    first, last = resumed(program, scene, folder, round((1 - share) * steps), steps, *words)
    if last["steps"] <= first["steps"]:
        return None
    ms = 1e3 * without_output(last) / (last["steps"] - first["steps"])
    subprocess.run([program, "run", scene, *words, "-t", "1", "-q", "--force", "-o", folder], stderr=subprocess.DEVNULL)
    samples = []
    with h5py.File(os.path.join(folder, "run.h5")) as file:
        for key in sorted(file["snapshots"]):
            s = file["snapshots"][key]
            rows = numpy.argsort(s["id"][:])[-len(free):]  # free bodies come last
            samples.append(numpy.hstack([s[c][:][rows]
                                         for c in ("position", "orientation", "velocity", "angular_velocity")]))
    return ms, samples[1:]


def main():
    built = drivers()
    lines = ["| case | engine | ms per step | overlap [mm], piles: of Ri+Rj | at the end | stands, piles: mean | drift "
             "[mm], piles: outside | sag [mm] | v_rms [mm/s] |",
             "|---" * 9 + "|"]
    for name in o.cases:
        fixed, free, dt, seconds, scene, settings = case(name)
        seconds = o.seconds or seconds
        write_bodies(os.path.join(o.out, "bodies.txt"), fixed + free)
        share, rows = 0.15 if name.startswith("pile") else 0.5, []
        if "Epafi" in o.engines:
            for words in EPAFI["pile" if share == 0.15 else ""]:
                own = settings + ["contact.nonsmooth." + w for w in words]
                rows.append((" ".join(["Epafi", *words]),
                             lambda own=own: run_epafi(scene, own, dt, seconds, free, share)))
        for engine, driver in built.items():
            rows += [(" ".join([engine, *options]), lambda d=driver, v=options: run_peer(d, v, dt, seconds, share))
                     for options in ENGINES[engine][4]]
        seen = {label: [] for label, _ in rows}
        for _ in range(o.repeats):
            for label, run in rows:
                result = run()
                if result:
                    seen[label].append(result)
        for label, results in seen.items():
            if not results:
                lines.append("| %s | %s | did not last |" % (name, label) + " |" * 6)
                continue
            ms = statistics.median(r[0] for r in results)
            lines.append("| %s | %s | %.3g | %s |" %
                         (name, label, ms, " | ".join(judge(name, fixed, free, results[-1][1]))))
            print(lines[-1], flush=True)
        lines += elsewhere(name)
    write_table(lines, o.out, "rigid.csv")


main()
