#!/usr/bin/env python3
"""Line coverage of a build of the `coverage` preset whose tests have run: coverage.py BUILD [LEAST]
Prints lines seen and run of every floor, and the ten files with most lines never run; exit code 1 where a floor is
below LEAST per cent (default 90). A line counts once, run if any test program ran it (headers are compiled often).
The counts are Clang's (llvm-profdata-14, llvm-cov-14), written by every test to BUILD/profiles."""
import os, subprocess, sys
from collections import defaultdict
from pathlib import Path

FLOORS = ("engine", "detection", "laws", "scenes")

def counts_of(program, profile):
    """(file, line, times run) of what was compiled into a program."""
    command = ["llvm-cov-14", "export", "--format=lcov", f"--instr-profile={profile}", str(program)]
    file = None
    for text in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines():
        if text.startswith("SF:"):
            file = os.path.realpath(text[3:])
        elif text.startswith("DA:"):
            line, count = text[3:].split(",")[:2]
            yield file, int(line), int(count)

def main():
    build = Path(sys.argv[1]).resolve()
    least = float(sys.argv[2]) if len(sys.argv) > 2 else 90.0
    root = os.path.realpath(Path(__file__).parent.parent)
    profile = build / "all.profdata"
    raw = sorted(map(str, (build / "profiles").glob("*.profraw")))
    if not raw:
        sys.exit(f"{build}/profiles is empty: run the tests first (ctest --preset coverage)")
    subprocess.run(["llvm-profdata-14", "merge", "-sparse", "-o", str(profile)] + raw, check=True)
    lines = defaultdict(dict)  # file -> line -> times run
    for program in sorted(p for p in (build / "tests").glob("test_*") if p.is_file() and os.access(p, os.X_OK)):
        for path, line, count in counts_of(program, profile):
            name = os.path.relpath(path, root)
            if name.split(os.sep)[0] in FLOORS:
                lines[name][line] = max(lines[name].get(line, 0), count)
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
