"""The table of the scorecard, scorecard.csv, and what is read from it: the front, where our default stands."""
import csv
import os

FIELDS = ["problem", "measure", "engine", "version", "settings", "default", "seconds", "spread", "error", "unit",
          "status", "processor", "date"]
LEAST_ERROR = 1e-12  # of what poses with 14 digits can show
LOST = ("lost", "left out", "failed", "over")


def processor():
    with open("/proc/cpuinfo") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else "?"


def read(name):
    if not os.path.exists(name):
        return []
    with open(name, newline="") as file:
        return list(csv.DictReader(file))


def merge(name, problem, engines, rows):
    """Puts the rows in the place of the old ones of these engines on this problem, in the order of problems and
    engines."""
    from problems import ORDER

    kept = [r for r in read(name) if not (r["problem"] == problem and r["engine"] in engines)]
    both = kept + [{f: r.get(f, "") for f in FIELDS} for r in rows]
    both.sort(key=lambda r: (ORDER.index(r["problem"]), not r["engine"].startswith("Epafi"), r["engine"]))
    with open(name, "w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(both)


def error_of(row):
    return max(float(row["error"]), LEAST_ERROR)


def good(row):
    """It has an answer, and not a state that is lost."""
    return bool(row["error"]) and not row["status"].startswith(LOST)


def front(rows):
    """Rows that nothing beats in time and error at once, quickest first."""
    found, least = [], float("inf")
    for row in sorted(filter(good, rows), key=lambda r: (float(r["seconds"]), error_of(r))):
        if error_of(row) < least:
            least = error_of(row)
            found.append(row)
    return found


def our_default(rows):
    """The row of Epafi's default, of smooth contact where rigid contact is left out."""
    ours = [r for r in rows if r["engine"].startswith("Epafi") and r["default"] == "yes"]
    return min(ours, key=lambda r: r["engine"])


def cost_of_front(rows, error):
    """Seconds of the quickest row that errs no more; the rows of the default itself count too."""
    return min(float(r["seconds"]) for r in rows if good(r) and error_of(r) <= error)


def standing(rows):
    """(on the front or within twice its cost at its error, cost over that of the front)."""
    ours = our_default(rows)
    if not good(ours):
        return False, float("inf")
    ratio = float(ours["seconds"]) / cost_of_front(rows, error_of(ours))
    return ratio <= 2.0, ratio


def chart_rows(rows):
    """Of one measure, what `epafi chart STUDY --with FILE.csv` reads: method, seconds and error of all that have an
    answer."""
    return [(r["engine"] + " " + r["settings"], r["seconds"], r["error"]) for r in rows if good(r)]
