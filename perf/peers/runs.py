"""What the comparisons of perf/peers share: a settled state, the processor time of a program, the table. Needs
numpy."""
import argparse
import csv
import json
import os
import re
import resource
import statistics
import subprocess

import numpy


def options(doc, steps, warm, repeats, skin, out):
    """The options of a comparison, with its defaults; the caller may add more before it parses."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=steps)
    parser.add_argument("--warm", type=int, default=warm, help="steps before the timed ones, not counted")
    parser.add_argument("--repeats", type=int, default=repeats)
    parser.add_argument("--skin", type=float, default=skin,
                        help="of the neighbour lists of the other codes [m]; the default is their best")
    parser.add_argument("--out", default=out)
    parser.add_argument("--program", default="./epafi")
    return parser


def settled(program, scene, folder, *settings):
    """Rows x y z radius [m] of the spheres in the last snapshot of a run of `scene`, made unless `folder` holds it."""
    if not os.path.exists(os.path.join(folder, "snapshots.csv")):
        sets = [word for s in settings for word in ("--set", s)]
        subprocess.run([program, "run", scene, *sets, "-t", "1", "-q", "--force", "--least-output", "-o", folder],
                       check=True)
        export(program, folder)
    return last_snapshot(folder)


def export(program, folder):
    subprocess.run([program, "export", folder, "--format", "csv"], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def last_snapshot(folder):
    """Rows x y z radius [m] of its spheres, once exported."""
    with open(os.path.join(folder, "snapshots.csv")) as file:  # walls have no mass
        rows = [r for r in csv.DictReader(file) if float(r["mass"]) > 0]
    last = max(float(r["time"]) for r in rows)
    return numpy.array([[float(r[c]) for c in ("x", "y", "z", "radius")] for r in rows if float(r["time"]) == last])


def touching_neighbours(bodies):
    """Mean number of other spheres that a sphere overlaps, walls left out, from rows x y z radius: as the codes beside
    count them."""
    x, r = bodies[:, :3], bodies[:, 3]
    cell = numpy.floor((x - x.min(axis=0)) / (2 * r.max())).astype(numpy.int64) + 1  # an empty layer all around
    size = cell.max(axis=0) + 2
    number = (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
    order = numpy.argsort(number, kind="stable")
    found = 0
    for step in numpy.ndindex(3, 3, 3):
        other = number + ((step[0] - 1) * size[1] + step[1] - 1) * size[2] + step[2] - 1
        begin, end = (numpy.searchsorted(number[order], other, side) for side in ("left", "right"))
        for k in range((end - begin).max()):
            i = numpy.flatnonzero(begin + k < end)
            j = order[(begin + k)[i]]
            distance = numpy.linalg.norm(x[i] - x[j], axis=1)
            found += numpy.count_nonzero((distance < r[i] + r[j]) & (i != j))
    return found / len(bodies)


def write_csv(name, bodies):
    with open(name, "w") as f:
        f.write("x,y,z,radius\n")
        for b in bodies:
            f.write("%.17g,%.17g,%.17g,%.17g\n" % tuple(b))


def processor_time(command, folder):
    """Of the whole process [s], and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = subprocess.run(command, cwd=folder, env=dict(os.environ, OMP_NUM_THREADS="1"), capture_output=True,
                          text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, text


def peer(command, steps, n, folder):
    """Of an input of LAMMPS or LIGGGHTS with a variable `steps` and n spheres: processor ns per sphere and step, that
    of a run of no steps taken out, and the last two columns of its last row (or None, and what it said)."""
    start, _ = processor_time(command + ["-var", "steps", "0"], folder)
    whole, text = processor_time(command + ["-var", "steps", str(steps)], folder)
    rows = re.findall(r"^\s*\d+\s+%d\s+(\S+)\s+(\S+)\s*$" % n, text, re.M)
    if not rows or "ERROR" in text:
        print("%s failed:\n%s" % (command, text[-1500:]))
        return None
    return 1e9 * (whole - start) / steps / n, *map(float, rows[-1])


def resumed(program, scene, folder, warm, last, *words, cwd=None):
    """Epafi's summaries at steps `warm` and `last` of one run that ends at `warm` and goes on: the times of the second
    are those of the steps after `warm`. (A run less a shorter one came out below zero where steps are quick and others
    use the machine.) A run that fails has fewer steps."""
    def call(*command):
        subprocess.run([program, *command, "-t", "1", "-q"], cwd=cwd)
        with open(os.path.join(cwd or "", folder, "summary.json")) as file:
            return json.load(file)

    return (call("run", scene, *words, "--force", "--least-output", "--steps", str(warm), "-o", folder),
            call("resume", folder, "--steps", str(last - warm)))


def without_output(summary):
    """Seconds by the clocks of the stages but output, which waits for the disk."""
    return sum(seconds for stage, seconds in summary["stage_seconds"].items() if stage != "output")


def yade_result(script, folder):
    """Runs a script of YADE that prints RESULT and numbers: those, or None with what it said. It counts its own time:
    it starts for longer than it computes."""
    _, text = processor_time(["yade", "-n", "-x", "-j1", script], folder)
    found = re.findall(r"^RESULT (.+)$", text, re.M)
    if not found:
        print("yade failed:\n%s" % text[-1500:])
        return None
    return [float(word) for word in found[-1].split()]


def take_turns(codes, repeats):
    """codes: pairs of a name and a function that gives (nanoseconds, checks...) or None. All results by name."""
    seen = {name: [] for name, _ in codes}
    for _ in range(repeats):
        for name, run in codes:
            result = run()
            if result:
                seen[name].append(result)
    return seen


def write_table(lines, folder, elsewhere=None):
    """To table.md, and printed with the load; `elsewhere` names the file of the rows in italics."""
    text = "\n".join(lines) + "\n"
    if elsewhere:
        text += "In italics: not run here, measured once on another machine (perf/peers/elsewhere/%s).\n" % elsewhere
    print(text + "load of the machine: %.1f" % os.getloadavg()[0])
    with open(os.path.join(folder, "table.md"), "w") as file:
        file.write(text)


# codes in docs/performance/figures.csv, where their names differ
SHORT = {"LAMMPS gran/hertz/history": "LAMMPS", "LAMMPS granular (Mindlin, Tsuji)": "LAMMPS granular"}


def print_table(title, checks, seen, folder, case=None):
    """Medians, over that of the first code, and the checks (names) of the last repeat; also to table.md. The times of a
    case that pages show also to figures.csv, for `tools/figures.py --take`."""
    lines = ["| %s | ns per body and step | smallest, largest | over Epafi | %s |" % (title, " | ".join(checks)),
             "|---" * (4 + len(checks)) + "|"]
    ours = statistics.median(r[0] for r in seen["Epafi"])
    for name, results in seen.items():
        if results:
            ns = [r[0] for r in results]
            median = statistics.median(ns)
            lines.append("| %s | %.0f | %.0f, %.0f | %.2f | %s |"
                         % (name, median, min(ns), max(ns), median / ours,
                            " | ".join("%.4g" % x for x in results[-1][1:])))
    write_table(lines, folder)
    if case is None:
        return
    with open(os.path.join(folder, "figures.csv"), "w") as f:
        f.write("case,code,value,low,high,unit\n")
        for name, results in seen.items():
            ns = [r[0] for r in results]
            if ns:
                f.write("%s,%s,%.0f,%.0f,%.0f,ns per sphere and step\n"
                        % (case, SHORT.get(name, name), statistics.median(ns), min(ns), max(ns)))


def predicted(program, scene, folder):
    """Bytes of a scene by the types of its columns: those of `epafi explain` times the pairs and contacts that `epafi
    check` counts at the start."""
    say = lambda command: subprocess.run([program, command, scene], cwd=folder, check=True, capture_output=True,
                                         text=True).stdout
    text, counts = say("explain"), say("check")
    body, contact = map(int, re.search(r"per body (\d+) B, per contact (\d+) B", text).groups())
    beside, pair = map(int, re.search(r"beside these (\d+) B per body and (\d+) B per listed pair", text).groups())
    bodies = sum(map(int, re.search(r"(\d+) free, (\d+) fixed", counts).groups()))
    pairs, contacts = map(int, re.search(r"(\d+) candidate pairs, (\d+) contacts", counts).groups())
    hulls = re.search(r"(\d+) B for each of (\d+) polyhedra", text)
    return bodies * (body + beside) + pair * pairs + contact * contacts + (int(hulls[1]) * int(hulls[2]) if hulls
                                                                           else 0)
