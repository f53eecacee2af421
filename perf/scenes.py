#!/usr/bin/env python3
"""What a step costs for every kind of body, wall, cell and source: rows as multiples of the settled bed in the same
run, by body and step and by contact.
   python3 perf/scenes.py build/bin/epafi [part of a row's name ...] [--out FOLDER]
Each scene is settled, then resumed for some steps and for three times as many: the difference of the processor times on
one thread is that of the steps alone, and the two beds before and after a row say how busy the machine was. Beside
each row the open part of its energy balance, and whether 1, 2 and 3 threads end in the same state. With --out the rows
also go to FOLDER/figures.csv, for `tools/figures.py --take FOLDER`."""
import argparse
import csv
import json
import math
import os
import resource
import shutil
import subprocess
import tempfile

import granular_scene

BALL = "[shape.ball]\nsphere = { radius = 0.0025 }\n"


def head(restitution=0.6, friction=0.5, time_step=5e-5):
    return granular_scene.head(time_step, restitution=restitution, friction=friction) + BALL


def fill(count, low, high, more=""):
    return f"""[[fill]]
name = "g"
shape = "ball"
material = "bead"
count = {count}
size = {{ distribution = "uniform", min = 0.9, max = 1.1 }}
region = {{ box = {{ min = {low}, max = {high} }} }}
{more}
"""


def plane(name, normal, point, state="fixed = true"):
    return granular_scene.plane(normal, point, name, state)


def box(edge):
    walls = [("x", [1, 0, 0], 0), ("X", [-1, 0, 0], edge), ("y", [0, 1, 0], 0), ("Y", [0, -1, 0], edge),
             ("z", [0, 0, 1], 0)]
    return "".join(plane(name, n, [edge if k == d and c > 0 else 0 for k in range(3)] if c else [0, 0, 0])
                   for name, n, c in walls for d in [[abs(v) for v in n].index(1)])


GRAVITY = "[world]\ngravity = [0, 0, -9.81]\n"


def bed(count=10000):
    return head() + GRAVITY + box(0.13) + fill(count, [0.001, 0.001, 0.001], [0.129, 0.129, 0.12])


def pour(count=20000):
    more = 'method = "pour"\nrate = 20000\nvelocity = [0, 0, -2]'
    return head() + GRAVITY + box(0.13) + fill(count, [0.004, 0.004, 0.5], [0.126, 0.126, 0.6], more)


def drum(planes=48, rate=2.0):
    text = head() + "[world]\ngravity = [-9.81, 0, 0]\n"
    turn = f"motion = {{ rotation = {{ axis = [0, 0, 1], rate = {rate}, about = [0, 0, 0] }} }}"
    for k in range(planes):
        c, s = math.cos(2 * math.pi * (k + 0.5) / planes), math.sin(2 * math.pi * (k + 0.5) / planes)
        text += plane(f"p{k}", [-c, -s, 0], [0.12 * c, 0.12 * s, 0], turn)
    text += plane("front", [0, 0, 1], [0, 0, 0]) + plane("back", [0, 0, -1], [0, 0, 0.14])
    return text + fill(12000, [-0.08, -0.08, 0.003], [0.08, 0.08, 0.137])


def drum_tube(rate=2.0):
    """The same drum as one body."""
    return head() + f"""[world]
gravity = [-9.81, 0, 0]
[[body]]
name = "drum"
shape = {{ tube = {{ radius = 0.12, length = 0.14, ends = "closed" }} }}
position = [0, 0, 0.07]
material = "bead"
motion = {{ rotation = {{ axis = [0, 0, 1], rate = {rate}, about = [0, 0, 0] }} }}
""" + fill(12000, [-0.08, -0.08, 0.003], [0.08, 0.08, 0.137])


def cell(edge, count, more, velocity="", **law):
    periodic = 'periodic = ["x", "y", "z"]'
    domain = f'[world]\ndomain = {{ min = [0, 0, 0], max = [{edge}, {edge}, {edge}], {periodic}{more} }}\n'
    return head(**law) + domain + fill(count, [0, 0, 0], [edge, edge, edge], velocity)


def flow(outlet):
    """An open funnel; what has fallen through is taken out by an outlet or by the end of the domain."""
    low = -0.3 if outlet else -0.04
    text = head() + f"""[world]
gravity = [0, 0, -9.81]
domain = {{ min = [-0.1, -0.1, {low}], max = [0.1, 0.1, 1.0], outside = "delete" }}
[[body]]
name = "funnel"
shape = {{ cone = {{ radii = [0.03, 0.07], length = 0.05 }} }}
material = "bead"
position = [0, 0, 0.025]
fixed = true
[[body]]
name = "tube"
shape = {{ tube = {{ radius = 0.07, length = 0.6 }} }}
material = "bead"
position = [0, 0, 0.35]
fixed = true
""" + fill(10000, [-0.048, -0.048, 0.06], [0.048, 0.048, 0.4])
    if outlet:
        text += '[[outlet]]\nname = "below"\nregion = { box = { min = [-0.1, -0.1, -0.2], max = [0.1, 0.1, -0.04] } }\n'
    return text


def bodies_bed(shape, count, size, step, scale=None):
    """Bodies of one shape, settled in a box six of them wide; size: of the box around one [m]."""
    edge, text = size * 1.05 * math.ceil((count / 4) ** (1 / 3)), head(time_step=step) + GRAVITY
    text = text.replace("[shape.ball]\nsphere = { radius = 0.0025 }", "[shape.ball]\n" + shape + (
        f"\nscale_to_diameter = {scale}" if scale else ""))
    fill_text = fill(count, [0, 0, 1e-4], [edge, edge, 14 * edge])
    return text + box(edge) + fill_text.replace('size = { distribution = "uniform", min = 0.9, max = 1.1 }\n', "")


def clump(balls):
    return "clump = { spheres = [" + ", ".join(str(list(b)) for b in balls) + "] }"


CUBE = [(x, y, z, 0.002) for x in (-0.00125, 0.00125) for y in (-0.00125, 0.00125) for z in (-0.00125, 0.00125)]
ROD = [(x, 0.0, 0.0, 0.0025) for x in (-0.0025, 0.0, 0.0025)]
ROUND = "ellipsoid = { semi_axes = [0.003, 0.0025, 0.002] }"
SQUARE = "superquadric = { semi_axes = [0.003, 0.0025, 0.002], across = 4, along = 4 }"

ROWS = {  # scene, settled until [s], steps
    "bed": (bed, 0.3, 300),
    "drum of 48 turning planes": (drum, 0.1, 200),
    "drum as one turning tube": (drum_tube, 0.1, 200),
    "straining cell": (lambda: cell(0.1736465692892682, 20000, ", strain_rate = [-0.8, -0.8, -0.8]",
                                    'method = "random"'), 0.3, 100),
    "periodic gas": (lambda: cell(0.546952419723944, 50000, "", "velocity_deviation = 1.0", restitution=0.95,
                                  friction=0.1), 0.01, 60),
    "pour, 20 000 a second": (pour, 0.3, 200),
    "pour that has ended": (lambda: pour(6000), 0.3, 200),
    "funnel in full flow, outlet": (lambda: flow(True), 0.15, 300),
    "funnel in full flow, outside = delete": (lambda: flow(False), 0.15, 300),
    "clumps of one ball": (lambda: bodies_bed(clump([(0, 0, 0, 0.0025)]), 1000, 0.005, 2e-5), 0.15, 600),
    "clumps of three balls": (lambda: bodies_bed(clump(ROD), 600, 0.01, 2e-5), 0.15, 600),
    "clumps of eight balls": (lambda: bodies_bed(clump(CUBE), 600, 0.008, 2e-5), 0.15, 600),
    "capsules": (lambda: bodies_bed("capsule = { radius = 0.0025, length = 0.005 }", 600, 0.01, 3e-5), 0.15, 600),
    "boxes": (lambda: bodies_bed("box = { size = [0.004, 0.004, 0.004] }", 400, 0.007, 1.6e-5), 0.15, 300),
    "polyhedra of 16 corners": (
        lambda: bodies_bed("polyhedron = { random = { vertices = 16, seed = 3 } }", 400, 0.0062, 1.4e-5, 0.005), 0.15,
        300),
    "cylinders": (lambda: bodies_bed("cylinder = { radius = 0.0025, length = 0.005 }", 300, 0.0071, 2e-5), 0.15, 300),
    "ellipsoids": (lambda: bodies_bed(ROUND, 400, 0.006, 4e-5), 0.15, 300),
    "superquadrics": (lambda: bodies_bed(SQUARE, 200, 0.008, 2e-5), 0.1, 100),
}


class Scene:
    def __init__(self, program, folder, name):
        scene, until, self.steps = ROWS[name]
        self.program, self.copy = program, os.path.join(folder, "copy")
        self.state = os.path.join(folder, name.replace(" ", "_"))
        file = self.state + ".toml"  # a run reads it again when it goes on
        with open(file, "w") as out:
            out.write(scene())
        self.call("run", file, "--until", str(until), "-o", self.state, "--least-output")

    def call(self, *arguments, threads=1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([self.program, *arguments, "-t", str(threads), "-q"], check=True, stdout=subprocess.DEVNULL)
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    def resume(self, steps, threads=1):
        shutil.rmtree(self.copy, ignore_errors=True)
        shutil.copytree(self.state, self.copy)
        seconds = self.call("resume", self.copy, "--steps", str(steps), threads=threads)
        with open(os.path.join(self.copy, "summary.json")) as file:
            return seconds, json.load(file)

    def nanoseconds(self):
        """A body and step, and a contact and step; and the summary of the longer run."""
        short, before = min((self.resume(self.steps) for _ in range(2)), key=lambda r: r[0])
        seconds, summary = min((self.resume(3 * self.steps) for _ in range(2)), key=lambda r: r[0])
        a_step = 1e9 * (seconds - short) / (2 * self.steps)
        contacts = summary["contacts_mean"] * summary["steps"] - before["contacts_mean"] * before["steps"]
        return a_step / summary["bodies"], a_step * (2 * self.steps) / max(contacts, 1.0), summary


def write_figures(folder, figures):
    """Rows of (scene, what, value, unit)."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "figures.csv"), "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "code", "value", "low", "high", "unit"])
        writer.writerows(["row " + scene.replace(",", ""), what, value, "", "", unit]
                         for scene, what, value, unit in figures)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("rows", nargs="*")
    parser.add_argument("--out")
    o = parser.parse_args()
    program, wanted, figures = os.path.abspath(o.program), o.rows, []
    with tempfile.TemporaryDirectory() as folder:
        reference = Scene(program, folder, "bed")
        last = reference.nanoseconds()
        print(f"bed: {last[0]:.1f} ns a body and step, {last[1]:.1f} a contact; beds: multiples of these")
        print(f"{'scene':38} {'bodies':>7} {'ns':>8} {'beds':>6} {'a contact':>10} {'beds':>6} {'open energy':>12}  "
              f"threads")
        for name in ROWS:
            if name == "bed" or (wanted and not any(w in name for w in wanted)):
                continue
            scene = Scene(program, folder, name)
            cost, of_contact, summary = scene.nanoseconds()
            now = reference.nanoseconds()
            hashes = {scene.resume(scene.steps, threads)[1]["state_hash"] for threads in (1, 2, 3)}
            print(f"{name:38} {summary['bodies']:7} {cost:8.1f} {2 * cost / (last[0] + now[0]):6.2f} "
                  f"{of_contact:10.1f} {2 * of_contact / (last[1] + now[1]):6.2f} "
                  f"{summary['energy']['relative_error']:12.2e}  {'same bits' if len(hashes) == 1 else 'DIFFER'}",
                  flush=True)
            beds = [2 * cost / (last[0] + now[0]), 2 * of_contact / (last[1] + now[1])]
            figures += [(name, "a body", "%.3g" % beds[0], "beds"), (name, "a contact", "%.3g" % beds[1], "beds"),
                        (name, "ns", "%.0f" % cost, "ns per body and step"),
                        (name, "open energy", "%.0e" % abs(summary["energy"]["relative_error"]), "")]
            last = now
            if o.out:
                write_figures(o.out, figures)


if __name__ == "__main__":
    main()
