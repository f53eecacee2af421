"""Pages of the scorecard, docs/scorecard/*.md, from its table: what is measured, who is on the front, where our default
stands."""
import os
import statistics
import subprocess

from problems import ORDER, load
from table import LEAST_ERROR, cost_of_front, error_of, front, good, our_default, read, standing

X_LABEL = "processor seconds per simulated second, one thread"


def measures(rows):
    return list(dict.fromkeys(r["measure"] for r in rows if r["error"]))


def of_measure(rows, measure):
    """Its rows; those without an error belong to every measure."""
    return [r for r in rows if r["measure"] == measure or not r["error"]]


def figure(text):
    value = float(text)
    return "%.2g" % value if value >= LEAST_ERROR else "0"


def named(row):
    return "%s (%s)" % (row["engine"], row["settings"])


def sentences(rows, unit):
    """Who is on the front, and where our default stands on it."""
    best = front(rows)
    if not best:
        return "No engine holds this problem."
    members = ["%s: %s s, %s" % (named(r), figure(r["seconds"]), figure(r["error"])) for r in best]
    first = "On the front, quickest first (processor seconds per second, error in %s): %s." % (unit, "; ".join(members))
    ours = our_default(rows)
    if not good(ours):
        return first + " Our default has no answer here: %s." % ours["status"]
    inside, ratio = standing(rows)
    place = "on the front" if ours in best else "within twice the cost of the front" if inside else "not on the front"
    second = "Our default (%s) takes %s s and errs by %s: %s" % (ours["settings"], figure(ours["seconds"]),
                                                                 figure(ours["error"]), place)
    if ours not in best:
        error = error_of(ours)
        cheaper = next(r for r in rows if good(r) and error_of(r) <= error
                       and float(r["seconds"]) == cost_of_front(rows, error))
        second += ", %.1f times the cost of %s at no larger error" % (ratio, named(cheaper))
    return first + "\n" + second + "."


def table_text(rows, unit):
    """One line for all measures of an engine at its settings."""
    names = measures(rows)
    best = {m: front(of_measure(rows, m)) for m in names}
    lines = ["| engine | settings | s per s | spread | %s | status | |"
             % " | ".join("%s [%s]" % (m or "error", unit) for m in names), "|---" * (6 + len(names)) + "|"]
    runs = {}
    for r in rows:
        if not r["status"].startswith("left out"):
            runs.setdefault((r["engine"], r["settings"]), []).append(r)
    for (engine, settings), of_run in runs.items():
        r = of_run[0]
        marks = ["default"] * (r["default"] == "yes")
        marks += [("front " + m).strip() for m in names if any(one in best[m] for one in of_run)]
        errors = [next((figure(one["error"]) for one in of_run if one["error"] and one["measure"] == m), "")
                  for m in names]
        time = "%.3g" % float(r["seconds"]) if r["seconds"] else ""
        lines.append("| %s | %s | %s | %s | %s | %s | %s |" % (engine, settings, time, r["spread"], " | ".join(errors),
                                                               r["status"], ", ".join(marks)))
    return "\n".join(lines)


def left_out(rows):
    """Engines that the problem is not for, those of one reason together."""
    reasons = {}
    for r in rows:
        if r["status"].startswith("left out"):
            engines = reasons.setdefault(r["status"], [])
            engines += [r["engine"]] * (r["engine"] not in engines)
    return ["%s: %s." % (", ".join(engines), why) for why, engines in reasons.items()]


def stem_of(name, measure):
    return name + ("_" + measure if measure else "")


def page(name, rows, folder):
    """The text of a problem's page; with pictures once they are drawn."""
    problem = load(name)
    unit = problem.UNIT
    out = ["# " + problem.TITLE, "", problem.__doc__.strip(), ""]
    for measure in measures(rows):
        if measure:
            out += ["## " + measure.capitalize(), ""]
        out += [sentences(of_measure(rows, measure), unit), ""]
        if os.path.exists(os.path.join(folder, stem_of(name, measure) + ".svg")):
            out += ["![%s](%s.svg)" % (problem.TITLE, stem_of(name, measure)), ""]
    if measures(rows)[1:]:
        out += ["## All settings", ""]
    if getattr(problem, "WHY", ""):
        out += [problem.WHY, ""]
    out += [table_text(rows, unit), ""]
    left = left_out(rows)
    out += left + [""] * bool(left)
    versions = dict.fromkeys("%s %s" % (r["engine"], r["version"]) for r in rows if r["seconds"])
    machines = sorted({r["processor"] for r in rows if r["processor"]})
    dates = sorted({r["date"] for r in rows if r["date"]})
    out += ["Written by `perf/scorecard/run.py --pages` from [scorecard.csv](scorecard.csv): %s; %s; %s."
            % ("; ".join(versions), ", ".join(machines), " and ".join(sorted({dates[0], dates[-1]})))]
    return "\n".join(out) + "\n"


def cost_of_wasm(table):
    """What Bullet costs more as WebAssembly than native, at the same settings."""
    cost = {(r["engine"], r["problem"], r["settings"]): float(r["seconds"]) for r in table if r["seconds"]}
    ratios = [c / cost["Bullet", *rest] for (engine, *rest), c in cost.items() if engine == "Bullet (wasm)"
              and ("Bullet", *rest) in cost]
    if not ratios:
        return "a native build is quicker"
    return "Bullet, which runs in both forms, takes %.1f times as long there (median of %d rows, %.1f to %.1f)" % (
        statistics.median(ratios), len(ratios), min(ratios), max(ratios))


def index(table):
    """The first page: where our default stands on every problem."""
    timed = [r for r in table if r["seconds"]]
    once = sum(1 for r in timed if not r["spread"])
    lines = ["# Scorecard: contact engines on the same problems", "",
             "One command (`/usr/bin/python3 perf/scorecard/run.py`, [how](../../perf/scorecard/README.md)) runs every "
             "engine at its defaults and at a few other",
             "settings on every problem, in turns, and compares the cost of a simulated second with the error. "
             "WebAssembly engines run in node and",
             "in single precision; %s." % cost_of_wasm(table),
             "%d of %d rows were measured once (they have no spread), so their times are rough. An" %
             (once, len(timed)),
             "engine without a row on a page has not been run on that problem.", "",
             "| problem | engines with an answer | our default: s per s | error | quickest other engine at no larger "
             "error | on the front or within twice its cost |",
             "|---" * 6 + "|"]
    for name in (n for n in ORDER if any(r["problem"] == n for r in table)):
        rows = [r for r in table if r["problem"] == name]
        for measure in measures(rows):
            these = of_measure(rows, measure)
            ours = our_default(these)
            title = "[%s](%s.md)" % (load(name).TITLE, name) + (", " + measure if measure else "")
            count = len({r["engine"].removesuffix(" smooth").removesuffix(" (wasm)") for r in these if good(r)})
            if not good(ours):
                lines.append("| %s | %d | | | | no: %s |" % (title, count, ours["status"]))
                continue
            inside, ratio = standing(these)
            others = [r for r in these if good(r) and not r["engine"].startswith("Epafi")
                      and error_of(r) <= error_of(ours)]
            quickest = min(others, key=lambda r: float(r["seconds"]), default=None)
            peer = "%s: %s" % (named(quickest), figure(quickest["seconds"])) if quickest else "none"
            verdict = "yes" if inside else "no: %.1f times" % ratio
            lines.append("| %s | %d | %s | %s | %s | %s |" %
                         (title, count, figure(ours["seconds"]), figure(ours["error"]), peer, verdict))
    return "\n".join(lines) + "\n"


def plot_text(problem, rows, measure):
    """What draw.cpp reads."""
    def row(r):
        return "%.6g %.6g" % (float(r["seconds"]), error_of(r))

    drawn = [r for r in rows if good(r)]
    out = ["title " + problem.TITLE + (": " + measure if measure else ""), "x " + X_LABEL,
           "y error [%s]" % problem.UNIT]
    for engine in dict.fromkeys(r["engine"] for r in drawn):
        out += ["line " + engine] + [row(r) for r in drawn if r["engine"] == engine]
    steps, last = [], None
    for r in front(rows):  # stairs: to the right of a point nothing below it was measured
        if last:
            steps.append("%.6g %.6g" % (float(r["seconds"]), error_of(last)))
        steps.append(row(r))
        last = r
    out += ["front"] + steps + ["default"] + [row(r) for r in drawn if r["default"] == "yes"]
    out += ["ours"] + [row(r) for r in drawn if r is our_default(rows)]
    return "\n".join(out) + "\n"


def pages(table, folder):
    """Name and text of every page in that folder."""
    names = [n for n in ORDER if any(r["problem"] == n and r["error"] for r in table)]
    return {"README.md": index(table), **{n + ".md": page(n, [r for r in table if r["problem"] == n], folder)
                                          for n in names}}


def draw(table, folder, build):
    """SVG of every measure by the drawing code of the atlas."""
    subprocess.run(["ninja", "-C", build, "perf_scorecard_draw"], check=True, stdout=subprocess.DEVNULL)
    for problem in map(load, ORDER):
        rows = [r for r in table if r["problem"] == problem.name]
        for measure in measures(rows):
            stem = os.path.join(build, "scorecard", stem_of(problem.name, measure))
            with open(stem + ".txt", "w") as f:
                f.write(plot_text(problem, of_measure(rows, measure), measure))
            subprocess.run([os.path.join(build, "perf", "perf_scorecard_draw"), stem + ".txt", stem], check=True)
            os.replace(stem + ".svg", os.path.join(folder, os.path.basename(stem) + ".svg"))


def write_pages(name, build, pictures):
    """Pictures first: a page shows those that there are."""
    table, folder = read(name), os.path.dirname(name)
    if pictures:
        draw(table, folder, build)
    for file, text in pages(table, folder).items():
        with open(os.path.join(folder, file), "w") as f:
            f.write(text)
    return 0
