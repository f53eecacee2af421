#!/usr/bin/env python3
"""Do the fast tests notice a wrong sign or constant?   run.py TREE [BUILD] [NUMBER...]   run.py TREE --check
TREE is a copy of the project that this program changes, BUILD its build folder (default TREE/build). Every line of
table.txt becomes a choice at run time, `(mutant(k) ? new : old)`, so that all are compiled once; then the test program
of the file's folder runs once without and once per mutant (EPAFI_MUTANT=k). A mutant that no test notices is printed
and makes the exit code 1. --check changes and runs nothing: every line of the table fits the sources."""
import os, subprocess, sys
from pathlib import Path

HEAD = """#include <cstdlib>
namespace epafi {
inline bool mutant(int k) {
  static const char* text = std::getenv("EPAFI_MUTANT");
  static const int chosen = text ? std::atoi(text) : 0;
  return chosen == k;
}
}
"""

# tests of other files of the folder, most of the time: asked last
OTHERS = {"detection": ["broad"],
          "laws": ["nonsmooth", "wheel_rail", "pgs", "newton", "lcp", "factor", "coloring", "cone"]}


def read_table():
    """Cells of each line: file, test binary, change, new text."""
    with open(Path(__file__).parent / "table.txt", encoding="utf8") as file:
        lines = [line.rstrip("\n") for line in file if line.strip() and not line.startswith("#")]
    return [[cell.strip() for cell in line.split(" | ")] for line in lines]


def mutated(tree, table):
    """The text of each file with all its mutants; ends where a line of the table does not fit."""
    texts = {}
    for k, (file, _, change, new) in enumerate(table, 1):
        text = texts.setdefault(file, (tree / file).read_text(encoding="utf8"))
        before, old = change.split("«")[0], change.split("«")[1].split("»")[0]
        whole = change.replace("«", "").replace("»", "")
        if text.count(whole) != 1:
            sys.exit(f"mutant {k}: '{whole}' stands {text.count(whole)} times in {file}")
        at = text.index(whole) + len(before)
        kind = "Vec3" if new.startswith("Vec3(") else ""
        texts[file] = f"{text[:at]}(mutant({k}) ? {new} : {kind}({old})){text[at + len(old):]}"
    return texts


def write_sources(tree, texts):
    guard = "#ifndef EPAFI_MUTANTS\n#define EPAFI_MUTANTS\n" + HEAD + "#endif\n"
    for file, text in texts.items():
        mark = "#pragma once" if file.endswith(".h") else ""
        (tree / file).write_text(text.replace(mark, mark + "\n" + guard, 1) if mark else guard + text, encoding="utf8")


def passes(build, k, program, chosen):
    env = dict(os.environ, EPAFI_MUTANT=str(k), OMP_WAIT_POLICY="passive")
    args = [str(build / "tests" / f"test_{program}"), chosen, "--abort"]
    try:
        return subprocess.run(args, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              timeout=300).returncode == 0
    except subprocess.TimeoutExpired:
        return False  # a search that no longer ends is noticed


def survives(build, k, program):
    fast = "~[slow]~[.]~[random]"
    first = fast + "".join(f"~[{tag}]" for tag in OTHERS[program])
    last = ",".join(f"{fast}[{tag}]" for tag in OTHERS[program])
    return passes(build, k, program, first) and passes(build, k, program, last)


def main():
    tree = Path(sys.argv[1]).resolve()
    rest = sys.argv[2:]
    table = read_table()
    texts = mutated(tree, table)
    if rest == ["--check"]:
        return 0
    build = Path(rest.pop(0)) if rest and not rest[0].isdigit() else tree / "build"
    write_sources(tree, texts)
    programs = sorted({row[1] for row in table})
    subprocess.run(["ninja", "-j2", "-C", str(build)] + [f"test_{p}" for p in programs], check=True,
                   stdout=subprocess.DEVNULL)
    for program in programs:
        if not survives(build, 0, program):
            sys.exit(f"test_{program} fails without a mutant")
    wanted = [int(n) for n in rest] or range(1, len(table) + 1)
    alive = 0
    for k in wanted:
        file, program, change, new = table[k - 1]
        if survives(build, k, program):
            alive += 1
            print(f"mutant {k} lives: {file}: {change} -> {new}", flush=True)
    print(f"{len(wanted)} mutants, {alive} alive")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
