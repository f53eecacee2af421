#!/usr/bin/env python3
"""Puts the figures of docs/performance/figures.csv into the tables of the pages: each figure stands in one place.

  tools/figures.py                               write the tables
  tools/figures.py --check                       1 where a page differs, a figure is missing or none uses it
  tools/figures.py --take FOLDER --machine NAME  take the figures.csv below FOLDER (perf/peers writes them) first

A table stands in a page below its pattern, a comment:

  <!-- figures
  | bed | time |
  |---|---|
  | 1000 | {bed-1000, Intel, Epafi} |
  -->
  | bed | time | ...
  <!-- end of figures -->

{CASE, MACHINE, CODE} becomes the median; {CASE, MACHINE, CODE, range} the median with the smallest and largest in
brackets.
"""
import argparse
import csv
import datetime
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = ROOT / "docs" / "performance" / "figures.csv"
FIELDS = ["case", "machine", "code", "value", "low", "high", "unit", "date"]
BLOCK = re.compile(r"(<!-- figures\n(.*?)-->\n).*?(<!-- end of figures -->)", re.DOTALL)
PLACE = re.compile(r"\{([^{},]+), ([^{},]+), ([^{},]+?)(, range)?\}")


def key(row):
    return row["case"], row["machine"], row["code"]


def read(name):
    with open(name, newline="") as file:
        return list(csv.DictReader(file))


def write(rows):
    with open(TABLE, "w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def take(folder, machine):
    """Measured rows in the place of the old ones; what was not measured stays."""
    today = datetime.date.today().isoformat()
    rows = {key(r): r for r in read(TABLE)}
    for name in sorted(pathlib.Path(folder).rglob("figures.csv")):
        for row in read(name):
            row = dict(row, machine=machine, date=today)
            rows[key(row)] = row
    write(rows.values())


def filled(text, figures, used):
    """The page with its tables written anew; the keys of the figures in them are added to used."""
    def figure(place):
        wanted = place.group(1, 2, 3)
        if wanted not in figures:
            sys.exit("no figure for {%s} in %s" % (", ".join(wanted), TABLE.relative_to(ROOT)))
        used.add(wanted)
        row = figures[wanted]
        return "%s (%s to %s)" % (row["value"], row["low"], row["high"]) if place[4] and row["low"] else row["value"]

    return BLOCK.sub(lambda block: block[1] + PLACE.sub(figure, block[2]) + block[3], text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--take", metavar="FOLDER")
    parser.add_argument("--machine", default="Intel")
    o = parser.parse_args()
    if o.take:
        take(o.take, o.machine)
    figures, used, faults = {key(r): r for r in read(TABLE)}, set(), []
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        text = page.read_text()
        new = filled(text, figures, used)
        if new == text:
            continue
        faults.append("%s holds other figures than %s: run tools/figures.py" %
                      (page.relative_to(ROOT), TABLE.relative_to(ROOT)))
        if not o.check:
            page.write_text(new)
    faults = faults if o.check else []
    faults += ["no page shows {%s}" % ", ".join(k) for k in figures if k not in used]
    print("\n".join(faults) if faults else "%d figures, %d of them on pages" % (len(figures), len(used)))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
