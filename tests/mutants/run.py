#!/usr/bin/env python3
"""Do the fast tests notice a wrong sign or constant?   run.py TREE [BUILD] [NUMBER...]
TREE is a copy of the project that this program changes, BUILD its build folder (default TREE/build). Every line of
table.txt becomes a choice at run time, `(mutant(k) ? new : old)`, so that all are compiled once; then the test program
of the file's folder runs once without and once per mutant (EPAFI_MUTANT=k). A mutant that no test notices is printed
and makes the exit code 1."""
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

def main():
    tree = Path(sys.argv[1]).resolve()
    rest = sys.argv[2:]
    build = Path(rest.pop(0)) if rest and not rest[0].isdigit() else tree / "build"
    lines = [l.rstrip("\n") for l in open(Path(__file__).parent / "table.txt", encoding="utf8") if l.strip()
             and not l.startswith("#")]
    table = [[cell.strip() for cell in l.split(" | ")] for l in lines]
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
    for file, text in texts.items():
        mark = "#pragma once" if file.endswith(".h") else ""
        guard = "#ifndef EPAFI_MUTANTS\n#define EPAFI_MUTANTS\n" + HEAD + "#endif\n"
        (tree / file).write_text(text.replace(mark, mark + "\n" + guard, 1) if mark else guard + text, encoding="utf8")
    programs = sorted({row[1] for row in table})
    subprocess.run(["ninja", "-j2", "-C", str(build)] + [f"test_{p}" for p in programs], check=True,
                   stdout=subprocess.DEVNULL)
    wanted = [int(n) for n in rest] or range(1, len(table) + 1)

    def passes(k, program, chosen):
        env = dict(os.environ, EPAFI_MUTANT=str(k), OMP_WAIT_POLICY="passive")
        args = [str(build / "tests" / f"test_{program}"), chosen, "--abort"]
        try:
            return subprocess.run(args, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                  timeout=300).returncode == 0
        except subprocess.TimeoutExpired:
            return False  # a search that no longer ends is noticed

    fast = "~[slow]~[.]~[random]"
    # tests of other files of the folder, most of the time: asked last
    others = {"detection": ["broad"], "laws": ["nonsmooth", "wheel_rail", "pgs", "newton", "lcp", "factor", "coloring",
                                               "cone"]}

    def survives(k, program):
        first = fast + "".join(f"~[{tag}]" for tag in others[program])
        return passes(k, program, first) and passes(k, program, ",".join(f"{fast}[{tag}]" for tag in others[program]))

    for program in programs:
        if not survives(0, program):
            sys.exit(f"test_{program} fails without a mutant")
    alive = 0
    for k in wanted:
        file, program, change, new = table[k - 1]
        if survives(k, program):
            alive += 1
            print(f"mutant {k} lives: {file}: {change} -> {new}", flush=True)
    print(f"{len(list(wanted))} mutants, {alive} alive")
    sys.exit(alive > 0)

main()
