#!/usr/bin/env python3
"""The bed of spheres as it falls in, by Epafi and LAMMPS on one and two processes of this machine, taking turns.

  /usr/bin/python3 perf/ranks/beside_lammps.py --build build-mpi [--n 20000] [--steps 1000] [--repeats 3]

Wall seconds of the steps alone: Epafi by one process of one and of two threads, and by two processes of one thread;
LAMMPS (style granular, the same laws) by one and two processes. Prints the smallest of the repeats, each over Epafi's
one process of two threads, whether Epafi ends in the same state, and the largest difference between the places of
spheres in LAMMPS on one and two processes. Writes docs/performance/ranks_lammps.csv. Needs numpy; of Debian: lammps,
openmpi-bin.

A thread that other programs disturb rests (engine/threads/preemption.h): where cores_at_work is not near 2 in the row
of two threads, the comparison is with one. Take a quiet machine, or put `chrt -f 5` before the command as root.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import subprocess
import sys
import types

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "perf" / "peers"))
from bed_input import lammps_walls, script, write_data  # noqa: E402
from model import environment  # noqa: E402

E, NU, RESTITUTION, FRICTION, DENSITY, STEP = 5e6, 0.3, 0.6, 0.5, 2500.0, 5e-5
SCENE = str(ROOT / "scenes" / "library" / "bed" / "bed.toml")


def mpirun(ranks, command, folder):
    line = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *command]
    return subprocess.run(line, cwd=folder, env=environment(), check=True, capture_output=True, text=True).stdout


def epafi(o, ranks, threads):
    """Wall seconds of the steps, the hash of the state, and how many cores were at work."""
    folder = o.scratch / f"epafi_{ranks}x{threads}"
    arguments = ["run", SCENE, "--set", f"params.n={o.n}", "--steps", str(o.steps), "-t", str(threads), "--quiet",
                 "--force", "-o", str(folder)]
    program = str(pathlib.Path(o.build).resolve() / "bin" / ("epafi" if ranks == 1 else "epafi-mpi"))
    if ranks == 1:
        subprocess.run([program, *arguments], env={**os.environ, "OMP_NUM_THREADS": str(threads)}, check=True,
                       capture_output=True)
    else:
        mpirun(ranks, [program, *arguments], o.scratch)
    summary = json.loads((folder / "summary.json").read_text())
    cores = ranks * summary["cpu_time"] / summary["wall_time"]
    return summary["wall_time"], summary["state_hash"], cores


def start_state(o):
    """Rows x y z radius of the bed as it begins."""
    folder = o.scratch / "start"
    program = str(pathlib.Path(o.build).resolve() / "bin" / "epafi")
    subprocess.run([program, "run", SCENE, "--set", f"params.n={o.n}", "--steps", "1", "--quiet", "--force", "-o",
                    str(folder)], check=True)
    subprocess.run([program, "export", str(folder), "--format", "csv"], check=True, capture_output=True)
    with open(folder / "snapshots.csv") as file:
        rows = [r for r in csv.DictReader(file) if float(r["mass"]) > 0]
    first = min(float(r["time"]) for r in rows)
    return numpy.array([[float(r[c]) for c in ("x", "y", "z", "radius")] for r in rows if float(r["time"]) == first])


def write_lammps(o):
    bed = start_state(o)
    assert len(bed) == o.n
    side = (o.n * numpy.pi / 6 * 0.005**3 / 0.6) ** (1 / 3)
    write_data(o.scratch / "bed.data", bed, side, DENSITY)
    law = f"hertz/material {E:g} {RESTITUTION:g} {NU:g} tangential mindlin NULL 1.0 {FRICTION:g} damping tsuji"
    pair = f"pair_style granular\npair_coeff * * {law}\n" + lammps_walls("granular " + law, side)
    text = script("lammps", "bed.data", pair, types.SimpleNamespace(skin=o.skin, warm=0, steps=o.steps), STEP)
    lines = text.split("\n")
    lines.insert(0, lines.pop(lines.index("units si")))
    lines.append("write_dump all custom ${places} id x y z modify sort id format float %.17g\n")
    (o.scratch / "bed.lammps").write_text("\n".join(lines))


def lammps(o, ranks):
    """Wall seconds of the steps, and the places of the spheres by number."""
    places = f"places_{ranks}"
    text = mpirun(ranks, ["lmp", "-log", "none", "-in", "bed.lammps", "-var", "steps", str(o.steps), "-var", "places",
                          places], o.scratch)
    loops = re.findall(r"Loop time of (\S+) on", text)
    rows = (o.scratch / places).read_text().split("ITEM: ATOMS")[-1].strip().split("\n")[1:]
    return float(loops[-1]), numpy.array([[float(x) for x in line.split()[1:]] for line in rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=str(ROOT / "build-mpi"))
    parser.add_argument("--scratch", type=pathlib.Path, default="/tmp/epafi-ranks-lammps")
    parser.add_argument("--n", type=int, default=20000)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--skin", type=float, default=2e-4, help="of LAMMPS' lists [m]")
    o = parser.parse_args()
    o.scratch.mkdir(parents=True, exist_ok=True)
    write_lammps(o)
    cases = [("Epafi", 1, 1), ("Epafi", 1, 2), ("Epafi", 2, 1), ("LAMMPS granular", 1, 1), ("LAMMPS granular", 2, 1)]
    seconds = {case: float("inf") for case in cases}
    ends, cores = {}, {}
    for _ in range(o.repeats):
        for case in cases:
            code, ranks, threads = case
            wall, ends[case], *at_work = epafi(o, ranks, threads) if code == "Epafi" else lammps(o, ranks)
            if wall < seconds[case]:
                seconds[case], cores[case] = wall, at_work
    hashes = {ends[case] for case in cases if case[0] == "Epafi"}
    moved = numpy.abs(ends[cases[3]] - ends[cases[4]])
    rows = []
    for case in cases:
        code, ranks, threads = case
        same = len(hashes) == 1 if code == "Epafi" else bool((moved == 0).all())
        rows.append({"code": code, "processes": ranks, "threads": threads, "bodies": o.n, "steps": o.steps,
                     "seconds": f"{seconds[case]:.3g}", "cores_at_work": f"{cores[case][0]:.2f}" if cores[case] else "",
                     "over_two_threads": f"{seconds[case] / seconds[cases[1]]:.2f}",
                     "same_bits": same, "largest_difference_m": f"{moved.max():.2g}" if code != "Epafi" else "",
                     "load_of_machine": f"{os.getloadavg()[0]:.1f}"})
    with open(ROOT / "docs" / "performance" / "ranks_lammps.csv", "w", newline="") as file:
        for target in (file, sys.stdout):
            out = csv.DictWriter(target, list(rows[0]), lineterminator="\n")
            out.writeheader()
            out.writerows(rows)


if __name__ == "__main__":
    main()
