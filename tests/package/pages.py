#!/usr/bin/env python3
"""Pages of the tree: their links lead somewhere, and the scenes in docs/coming_from.md are accepted.

  pages.py links            every relative link and heading of every page is there (tools/count_style.py)
  pages.py scenes PROGRAM   each ```toml block of docs/coming_from.md: `epafi check`, cases with [patch] by `epafi
  patch`
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FEWEST_SCENES = 6  # one for each program of the page


def check_scenes(program):
    """Number of scenes that are refused; prints what the program says of them."""
    text = (ROOT / "docs/coming_from.md").read_text()
    scenes = re.findall(r"^```toml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    refused = 0
    with tempfile.TemporaryDirectory() as folder:
        for number, scene in enumerate(scenes):
            path = pathlib.Path(folder) / f"scene_{number}.toml"
            path.write_text(scene)
            command = "patch" if "[patch]" in scene else "check"
            ran = subprocess.run([pathlib.Path(program).resolve(), command, path], capture_output=True, text=True,
                                 cwd=folder)
            if ran.returncode != 0:
                print(f"scene {number} of docs/coming_from.md, {command}:\n{ran.stdout}{ran.stderr}")
                refused += 1
    if len(scenes) < FEWEST_SCENES:
        print(f"docs/coming_from.md holds {len(scenes)} scenes only")
        refused += 1
    return refused


def check_links():
    return subprocess.run([sys.executable, ROOT / "tools/count_style.py", "--links"]).returncode


if __name__ == "__main__":
    sys.exit(check_links() if sys.argv[1] == "links" else check_scenes(sys.argv[2]))
