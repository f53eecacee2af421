#!/usr/bin/env python3
"""The bodies of a polyset file where a run has left them: a start that is dense from the first step.

  /usr/bin/python3 perf/settled_polyset.py RUN_FOLDER IN.polyset OUT.polyset

RUN_FOLDER holds run.h5 of a scene whose [[bodies]] come last, such as scenes/library/pile/polyhedra.toml. Needs h5py
and numpy.
"""
import sys

import h5py
import numpy


def main(run, source, target):
    with h5py.File(run + "/run.h5") as file:
        snapshots = file["snapshots"]
        last = snapshots[sorted(snapshots)[-1]]
        order = numpy.argsort(last["id"][:])
        position, orientation = last["position"][:][order], last["orientation"][:][order]
    with open(source) as lines:
        lines = lines.readlines()
    body = len(order) - sum(line.startswith("b ") for line in lines)  # floor and walls come first
    with open(target, "w") as out:
        for line in lines:
            if line.startswith("b "):
                words = line.split()
                words[7:14] = [f"{x:.17g}" for x in (*position[body], *orientation[body])]
                line, body = " ".join(words) + "\n", body + 1
            out.write(line)


if len(sys.argv) != 4:
    sys.exit(__doc__)
main(*sys.argv[1:])
