#!/usr/bin/env python3
"""Speed against accuracy of contact engines on the same problems: one command installs, builds, runs in turns, draws.

  /usr/bin/python3 perf/scorecard/run.py [--engine E ...] [--problem P ...] [--budget 30m] [--turns 3] [--pages]
  [--rows PROBLEM]

A row is one engine at one setting on one problem: processor seconds per simulated second over the steps alone, one
thread, median of the repeats with their spread, and the error against an exact or converged answer
(problems/*/problem.py). The rows of a problem take turns, so that a drift of the machine falls on all alike. Rows of
what is run again replace the old ones in docs/scorecard/scorecard.csv. --pages writes docs/scorecard from the table,
--rows prints the rows of a problem for a chart of one's own. README.md says how to add a problem or an engine.
"""
import argparse
import csv
import datetime
import json
import os
import re
import resource
import signal
import statistics
import subprocess
import sys
import time

from engines import ROOT, all_engines, install, make_driver
from judge import read_poses
from pages import write_pages
from problems import ORDER, all_problems
from scene import write
from table import chart_rows, merge, processor, read

REPEATS = 3      # measurements of a row
PATIENCE = 10.0  # processor seconds: a row that has taken more is not repeated
ALONE = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")


def seconds_of(text):
    found = re.fullmatch(r"(\d+\.?\d*)([smh]?)", text)
    if not found:
        raise argparse.ArgumentTypeError("'%s' is no duration; write 90s, 30m or 2h" % text)
    return float(found[1]) * {"": 1, "s": 1, "m": 60, "h": 3600}[found[2]]


def count_of(text):
    if not re.fullmatch(r"[1-9]\d*", text):
        raise argparse.ArgumentTypeError("'%s' is no number from 1 on" % text)
    return int(text)


def call(command, limit, folder):
    """What the driver said (a dictionary), or why it said nothing. limit: of processor seconds, whatever else runs."""
    def bounded():
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))

    done = subprocess.run(command, capture_output=True, text=True, env=ALONE, cwd=folder, preexec_fn=bounded)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return "over %d processor seconds" % limit
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode == 0 and lines:
        return json.loads(lines[-1])
    said = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
    return "failed: " + (said[-1][:100] if said else "ends with %d" % done.returncode)


class Row:
    """One engine at one setting on one problem."""

    def __init__(self, engine, problem, setting, default):
        self.engine, self.problem, self.setting, self.default = engine, problem, setting, default
        self.times, self.errors, self.trouble, self.dt = [], {}, None, None

    def turn(self, work, limit):
        """One more measurement; the first also writes and judges the poses."""
        if self.trouble or len(self.times) >= REPEATS or (self.times
                                                          and sum(self.times) * self.problem.DURATION > PATIENCE):
            return
        # runs beside each other keep apart
        poses = "-" if self.errors else os.path.join(work, "poses-%d.txt" % os.getpid())
        step, options = self.engine.arguments(self.setting)
        stem = os.path.join(work, "cases", self.problem.name)
        said = call([*self.engine.command, stem + ".scene", "%.17g" % self.problem.DURATION, "%.17g" % step,
                     "%.17g" % self.problem.EVERY, poses, *options], limit, work)
        if isinstance(said, str):
            self.trouble = said
            return
        seconds = said["cpu_s_per_s"]
        # on a machine with many more processes than processors the clock of a process was seen to stand still
        self.times += [s for s in (seconds if isinstance(seconds, list) else [seconds]) if s > 0]
        self.dt = said["dt"]
        if not self.errors:
            self.errors = self.judged(poses)

    def judged(self, poses):
        scene = self.problem.scene()
        times, states = read_poses(poses, scene)
        if not all(abs(x) < 1e9 for state in states for body in state for x in body):
            self.trouble = "lost: no numbers"
            return {}
        return self.problem.measure(times, states, scene)

    def lines(self, date):
        """One line of the table for each measure of the problem."""
        said = self.setting or "as shipped"
        if self.dt and "dt=" not in self.setting:
            said = ("%s dt=%.3g" % (self.setting, self.dt)).strip()
        base = dict(problem=self.problem.name, engine=self.engine.name, version=self.engine.version, settings=said,
                    default="yes" if self.default else "no", unit=self.problem.UNIT, processor=processor(), date=date)
        if not self.errors:
            return [dict(base, measure="", seconds="", spread="", error="", status=self.trouble)]
        if not self.times:
            return []
        time = statistics.median(self.times)
        spread = "%.2f" % ((max(self.times) - min(self.times)) / time) if len(self.times) > 1 else ""
        return [dict(base, measure=m, seconds="%.4g" % time, spread=spread, error="" if e is None else "%.4g" % e,
                     status=status)
                for m, (e, status) in self.errors.items()]


def print_rows(table):
    columns = ("problem", "measure", "engine", "settings", "seconds", "spread", "error", "status")
    for line in table:
        print(" | ".join(str(line.get(k, "")) for k in columns), flush=True)


def run_problem(problem, engines, options, deadline):
    """Merges the rows of a problem into the table after each turn. False where the budget ended before the first."""
    write(problem.scene(), problem.DURATION, problem.EVERY, os.path.join(options.work, "cases", problem.name))
    rows, left = [], []
    for engine in engines:
        reason = engine.why_not(problem)
        if reason:
            left.append(dict(problem=problem.name, engine=engine.name, version=engine.version,
                             status="left out: " + reason))
        rows += [Row(engine, problem, setting, k == 0)
                 for k, setting in enumerate([] if reason else problem.settings(engine))]
    table, date = [], datetime.date.today().isoformat()
    for turn in range(options.turns):
        for row in rows:
            if time.monotonic() > deadline:
                print_rows(table)
                return turn > 0
            row.turn(options.work, options.limit)
        table = [line for row in rows for line in row.lines(date)] + left
        merge(options.table, problem.name, [e.name for e in engines], table)
    print_rows(table)
    return True


def chosen(words):
    """Engines of these names, or whose names begin so where none has the whole name; all where none is asked for."""
    everyone, found = all_engines(), []
    for word in words or [""]:
        same = [e for e in everyone if e.name.lower() == word.lower()]
        same = same or [e for e in everyone if e.name.lower().startswith(word.lower())]
        if not same:
            raise SystemExit("there is no engine '%s'; there are %s" % (word, ", ".join(e.name for e in everyone)))
        found += same
    return found


def print_chart_rows(name, problem):
    """The first measure of a problem as rows for a chart."""
    rows = [r for r in read(name) if r["problem"] == problem]
    measure = next((r["measure"] for r in rows if r["error"]), "")
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(("method", "time", "error"))
    out.writerows(chart_rows([r for r in rows if r["measure"] == measure]))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engine", nargs="+", help="names or beginnings of names")
    parser.add_argument("--problem", nargs="+")
    parser.add_argument("--budget", type=seconds_of, default=1e9, help="whole turns only; 90s, 30m, 2h")
    parser.add_argument("--turns", type=count_of, default=REPEATS)
    parser.add_argument("--limit", type=count_of, default=120, help="processor seconds that a row may take in a turn")
    parser.add_argument("--build", default=os.path.join(ROOT, "build"))
    parser.add_argument("--table", default=os.path.join(ROOT, "docs", "scorecard", "scorecard.csv"))
    parser.add_argument("--no-install", action="store_true")
    parser.add_argument("--as-built", action="store_true", help="drivers that exist are not built again")
    parser.add_argument("--pages", action="store_true", help="write docs/scorecard from the table, run nothing")
    parser.add_argument("--rows", metavar="PROBLEM", 
                        help="print its rows for `epafi chart STUDY --with FILE.csv`, run nothing")
    o = parser.parse_args()
    unknown = [p for p in (o.problem or []) + [o.rows] * bool(o.rows) if p not in ORDER]
    if unknown:
        raise SystemExit("there is no problem '%s'; there are %s" % (unknown[0], ", ".join(ORDER)))
    folder = os.path.dirname(os.path.abspath(o.table))
    if not os.path.isdir(folder) or ((o.pages or o.rows) and not os.path.exists(o.table)):
        raise SystemExit("--table: there is no '%s'" % (o.table if o.pages or o.rows else folder))
    if o.rows:
        return print_chart_rows(o.table, o.rows)
    o.work = os.path.join(o.build, "scorecard")
    os.makedirs(o.work, exist_ok=True)
    if o.pages:
        return write_pages(o.table, o.build, not o.as_built)
    wanted = chosen(o.engine)
    if not o.no_install:
        install(wanted, o.work)
    engines = []
    for engine in wanted:
        reason = make_driver(engine, o.build, o.work, o.as_built)
        if reason:
            print("%s: %s" % (engine.name, reason))
        else:
            engines.append(engine)
    deadline = time.monotonic() + o.budget
    for problem in all_problems():
        if o.problem and problem.name not in o.problem:
            continue
        if not run_problem(problem, engines, o, deadline):
            print("the budget ended before " + problem.name)
            break
    return 0


if __name__ == "__main__":
    sys.exit(main())
