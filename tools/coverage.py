#!/usr/bin/env python3
"""Line coverage of a build with `--coverage` whose tests have run: coverage.py BUILD [LEAST]
Prints lines seen and run of every floor, and the ten files with most lines never run; exit code 1 where a floor is
below LEAST per cent (default 90). A line counts once, run if any test program ran it (headers are compiled often)."""
import json, os, subprocess, sys
from collections import defaultdict
from pathlib import Path

FLOORS = ("engine", "detection", "laws", "scenes")

def main():
    build = Path(sys.argv[1]).resolve()
    least = float(sys.argv[2]) if len(sys.argv) > 2 else 90.0
    root = Path(__file__).resolve().parent.parent
    lines = defaultdict(dict)  # file -> line -> times run
    for data in build.rglob("*.gcda"):
        text = subprocess.run(["gcov", "--json-format", "--stdout", str(data)], capture_output=True, text=True, cwd=data.parent).stdout
        for part in text.splitlines():
            for file in json.loads(part)["files"]:
                path = os.path.normpath(build / file["file"])
                if not path.startswith(str(root) + os.sep):
                    continue
                name = os.path.relpath(path, root)
                if name.split(os.sep)[0] in FLOORS:
                    for line in file["lines"]:
                        n = line["line_number"]
                        lines[name][n] = max(lines[name].get(n, 0), line["count"])
    bad = False
    for floor in FLOORS:
        own = [counts for name, counts in lines.items() if name.startswith(floor + os.sep)]
        seen, run = sum(map(len, own)), sum(sum(c > 0 for c in counts.values()) for counts in own)
        if seen:
            print(f"{floor:10} {seen:6} lines, {100 * run / seen:5.1f} % run")
            bad = bad or 100 * run / seen < least
    missed = sorted(((sum(c == 0 for c in counts.values()), name) for name, counts in lines.items()), reverse=True)
    for count, name in missed[:10]:
        print(f"  {count:4} lines never run: {name}")
    sys.exit(bad or not lines)

main()
