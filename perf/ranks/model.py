#!/usr/bin/env python3
"""How a run of smooth spheres grows with processes: a model of one step, its inputs measured here, compared with
2 and 4 processes here.

    perf/ranks/model.py --measure           measures, checks, and writes docs/performance/ranks_*.csv
    perf/ranks/model.py                     the table from the inputs in docs/performance/ranks_inputs.csv

A step of a process that owns n spheres and sees g n of others, T threads:
    work       t_part (n + half_ghost g n) / (T e)       contacts of a border are found on both sides; t_part: of a
                                                         body in one of two processes, alone in passes that one
                                                         process joins with others
    exchange   neighbours (message) + row g n / rate     after the work, nothing hidden
    decisions  log2(P) (order + sum)                     one order of process 0, one sum of all
    home       whole / sort_interval                     bodies to process 0 and back, N rows at its rate
Ghosts are counted in the boxes that recursive bisection makes of the bed, grown by the reach of the lists.
Between machines message and rate are assumed (--network, --node-rate), the rest is as measured.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIGURES = ROOT / "docs" / "performance"
ROW = 128            # bytes of a ghost in a step: its state
WHOLE = 500          # bytes of a sphere that process 0 holds, and that come and go at a sort
REACH = 1.55         # of a diameter: both radii and twice the margin of half a radius
HALF_GHOST = 0.5     # of the work for an own body
SORT_INTERVAL = 1000
PACKING = 0.37       # volume of spheres over volume of the box that they fill, of the bed as it begins
ASPECT = (1.0, 1.0, 1.62)
SCALE = (1.0, 1.0, 0.2)  # as ranks/territory.cpp cuts
WORK = ("integrate", "broad_phase", "narrow_phase", "contact")  # stages of a process's own steps in summary.json


def boxes(size, ranks):
    """Corners of the parts: the longest side is cut, in proportion to the ranks of both halves; heights count less."""
    parts = []

    def cut(low, high, count):
        if count == 1:
            parts.append((low, high))
            return
        axis = max(range(3), key=lambda k: SCALE[k] * (high[k] - low[k]))
        first = count // 2
        at = low[axis] + (high[axis] - low[axis]) * first / count
        middle_high, middle_low = list(high), list(low)
        middle_high[axis] = middle_low[axis] = at
        cut(low, middle_high, first)
        cut(middle_low, high, count - first)

    cut([0.0] * 3, list(size), ranks)
    return parts


def ghosts_over_own(bodies, ranks, reach=REACH):
    """Mean over the parts of a bed of spheres of diameter 1."""
    volume = bodies * math.pi / 6 / PACKING
    unit = (volume / (ASPECT[0] * ASPECT[1] * ASPECT[2])) ** (1 / 3)
    size = [a * unit for a in ASPECT]
    total = 0.0
    for low, high in boxes(size, ranks):
        own = grown = 1.0
        for k in range(3):
            own *= high[k] - low[k]
            grown *= min(size[k], high[k] + reach) - max(0.0, low[k] - reach)
        total += grown / own - 1.0
    return total / ranks


def step(inputs, bodies, ranks, threads, options):
    """Parts of a step [s]."""
    own = bodies / ranks
    ghosts = ghosts_over_own(bodies, ranks)
    cores = threads * (1.0 if threads == 1 else options.thread_efficiency)
    per_node = max(1, options.node_cores // threads)
    far = ranks > per_node
    message = options.network if far else inputs["message"]
    rate = min(inputs["rate"], options.node_rate / per_node) if far else inputs["rate"]
    hops = math.ceil(math.log2(ranks)) if ranks > 1 else 0
    decision = (message if far else 0.0) + inputs["order"] + inputs["sum"]
    body = inputs["part" if ranks > 1 else "body"]
    parts = {
        "ghosts": ghosts,
        "work": body * own * (1.0 + HALF_GHOST * ghosts) / cores,
        "exchange": min(ranks - 1, 13) * message + ROW * ghosts * own / rate,
        "decisions": hops * decision,
        "home": 2.0 * bodies * WHOLE / inputs["gather_rate"] / SORT_INTERVAL if ranks > 1 else 0.0,
    }
    parts["step"] = parts["work"] + parts["exchange"] + parts["decisions"] + parts["home"]
    ideal = inputs["body"] * bodies / ranks / cores
    parts["efficiency"] = ideal / parts["step"]
    parts["without_home"] = ideal / (parts["step"] - parts["home"])
    return parts


def table(inputs, options):
    rows = []
    for bodies in (10**6, 10**7, 10**8, 10**9):
        for ranks in (1, 2, 4, 16, 64, 256, 1000, 4000, 10000):
            if bodies / ranks < 1000:
                continue
            p = step(inputs, bodies, ranks, options.threads, options)
            rows.append({
                "bodies": f"{bodies:.0e}", "processes": ranks, "threads": options.threads,
                "bodies_each": round(bodies / ranks), "ghosts_over_own": f"{p['ghosts']:.3g}",
                "work_ms": f"{1e3 * p['work']:.3g}", "exchange_ms": f"{1e3 * p['exchange']:.3g}",
                "decisions_ms": f"{1e3 * p['decisions']:.3g}", "home_ms": f"{1e3 * p['home']:.3g}",
                "step_ms": f"{1e3 * p['step']:.3g}", "efficiency": f"{p['efficiency']:.2f}",
                "efficiency_without_home": f"{p['without_home']:.2f}",
                "gigabytes_of_process_0": f"{bodies * WHOLE / 1e9:.3g}"})
    return rows


def write(name, rows):
    with open(FIGURES / name, "w", newline="") as file:
        out = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        out.writeheader()
        out.writerows(rows)
    out = csv.DictWriter(sys.stdout, list(rows[0]), lineterminator="\n")
    out.writeheader()
    out.writerows(rows)


def environment():
    more = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}
    if os.geteuid() == 0:
        more.update({"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    return {**os.environ, **more}


def mpirun(ranks, command):
    crowded = "1" if ranks > os.cpu_count() else "0"  # who waits gives way only where there are too few cores
    line = ["mpirun", "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", crowded, "-n", str(ranks)]
    return subprocess.run(line + command, env=environment(), check=True, capture_output=True, text=True).stdout


def bed(program, folder, bodies, steps, ranks):
    """Summary of a bed by so many processes; 0: by the program alone."""
    scene = str(ROOT / "scenes" / "library" / "bed" / "bed.toml")
    command = ["run", scene, "--set", f"params.n={bodies}", "--set", "run.output_interval=100", "--steps", str(steps),
               "--quiet", "--force", "--least-output", "-t", "1", "-o", str(folder)]
    if ranks == 0:
        subprocess.run([str(program / "epafi")] + command, env=environment(), check=True, capture_output=True)
    else:
        mpirun(ranks, [str(program / "epafi-mpi")] + command)
    return json.loads((folder / "summary.json").read_text())


def measure(options):
    program = pathlib.Path(options.build) / "bin"
    scratch = pathlib.Path(options.scratch)
    scratch.mkdir(parents=True, exist_ok=True)
    targets = ["perf_messages", "epafi", "epafi-mpi"]
    subprocess.run(["ninja", "-C", options.build, *targets], check=True, capture_output=True)
    messages = [json.loads(mpirun(2, [str(pathlib.Path(options.build) / "perf" / "perf_messages")]))
                for _ in range(options.repeats)]
    inputs = {key: min(m[key] for m in messages) for key in ("message", "sum", "order")}
    inputs.update({key: max(m[key] for m in messages) for key in ("rate", "gather_rate")})
    # in turns: what others do on the machine meets all alike; the quickest of each counts
    cases = (0, 2, 4)
    seconds = {ranks: math.inf for ranks in cases}
    summary = {}
    for _ in range(options.repeats):
        for ranks in cases:
            seen = bed(program, scratch / f"ranks_{ranks}", options.bodies, options.steps, ranks)
            if seen["wall_time"] / options.steps < seconds[ranks]:
                seconds[ranks], summary[ranks] = seen["wall_time"] / options.steps, seen
    inputs["body"] = seconds[0] / options.bodies
    work = {ranks: max(sum(of[stage] for stage in WORK) for of in summary[ranks]["ranks"]["seconds"]) / options.steps
            for ranks in cases[1:]}
    inputs["part"] = 2 * work[2] / options.bodies / (1.0 + HALF_GHOST * summary[2]["ranks"]["ghosts"])
    rows = [{"input": key, "value": f"{value:.3g}", "unit": "byte/s" if "rate" in key else "s"}
            for key, value in sorted(inputs.items())]
    write("ranks_inputs.csv", rows)
    check = []
    for ranks in cases[1:]:
        p = step(inputs, options.bodies, ranks, 1, options)
        crowd = max(1.0, ranks / os.cpu_count())  # processes that share a core take turns
        told = summary[ranks]["ranks"]
        check.append({
            "bodies": options.bodies, "processes": ranks, "ghosts_model": f"{p['ghosts']:.3f}",
            "ghosts_measured": f"{told['ghosts']:.3f}",
            "kilobytes_model": f"{options.bodies * (p['ghosts'] * ROW + 2 * WHOLE / options.steps) / 1e3:.0f}",
            "kilobytes_measured": f"{told['bytes_per_step'] / 1e3:.0f}",
            "work_ms_model": f"{1e3 * p['work'] * crowd:.3g}", "work_ms_measured": f"{1e3 * work[ranks]:.3g}",
            "step_ms_model": f"{1e3 * p['step'] * crowd:.3g}", "step_ms_measured": f"{1e3 * seconds[ranks]:.3g}",
            "load_of_machine": f"{os.getloadavg()[0]:.1f}", "cores": os.cpu_count(),
            "same_hash": summary[ranks]["state_hash"] == summary[0]["state_hash"]})
    write("ranks_check.csv", check)
    return inputs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--build", default=str(ROOT / "build-mpi"))
    parser.add_argument("--scratch", default="/tmp/epafi-ranks-model")
    parser.add_argument("--bodies", type=int, default=20000, help="of the bed that is run")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, default=8, help="of each process, in the table")
    parser.add_argument("--thread-efficiency", type=float, default=0.9)
    parser.add_argument("--network", type=float, default=1.5e-6, help="a message between machines [s]")
    parser.add_argument("--node-rate", type=float, default=25e9, help="of a machine's network [byte/s]")
    parser.add_argument("--node-cores", type=int, default=64)
    options = parser.parse_args()
    if options.measure:
        inputs = measure(options)
    else:
        with open(FIGURES / "ranks_inputs.csv") as file:
            inputs = {row["input"]: float(row["value"]) for row in csv.DictReader(file)}
    write("ranks_model.csv", table(inputs, options))


if __name__ == "__main__":
    main()
