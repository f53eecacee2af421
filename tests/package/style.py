#!/usr/bin/env python3
"""Counts of CONTRIBUTING's style page: none in the tree, and each kind is found where it is planted.

  style.py
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
LONG = "x" * 121
PLANTED = {
    "chain.cpp": "void f(int a, int b) {\n  a = 1, b = 2;\n}\n",
    "function.cpp": "void f(int& a) {\n" + "  ++a;\n" * 51 + "}\n",
    "file.h": "\n" * 501,
    "file.py": "\n" * 501,
    "function.py": "class A:\n    def f(self):\n" + "        self.a = 1\n" * 51,
    "line.cpp": f"// {LONG}\n",
    "line.sh": f"# {LONG}\n",
    "line.cmake": f"# {LONG}\n",
    "line.sbatch": f"# {LONG}\n",
    "line.py": f"# {LONG}\n",
    "floor/CMakeLists.txt": f"# {LONG}\n",
    "script": f"#!/bin/sh\n# {LONG}\n",
    "cell.md": "| a | b |\n|---|---|\n| " + "word " * 26 + "| c |\n",
}
ALLOWED = {
    "tests/data/row.toml": f"# {LONG}\n",
    "licence": f"{LONG}\n",
    "page.md": f"{LONG}\n",
    "statement.cpp": "void f(int a, int b) {\n  a = 1;\n  int c, d;\n}\n",
}


def check(root):
    return subprocess.run([sys.executable, root / "tools/count_style.py", "--check"], capture_output=True, text=True)


def find_planted():
    """Number of planted places that are not found, or found where there is none."""
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in (PLANTED | ALLOWED).items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        (root / "tools").mkdir()
        shutil.copy(ROOT / "tools/count_style.py", root / "tools")
        ran = check(root)
        found = {line.split(":")[0] for line in ran.stdout.splitlines()}
        for name in found ^ set(PLANTED):
            print(f"{name}: {'found' if name in found else 'not found'}\n{ran.stderr}")
            wrong += 1
    return wrong + (ran.returncode != 1)


def main():
    tree = check(ROOT)
    print(tree.stdout + tree.stderr, end="")
    return 1 if tree.returncode or find_planted() else 0


if __name__ == "__main__":
    sys.exit(main())
