#!/usr/bin/env python3
"""Reads run.h5 with h5py alone: columns of every snapshot, measures over time.

Usage: read_run.py out/hopper      (or out/hopper/run.h5)
"""
import os
import sys

import h5py


def text(attribute):
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


if len(sys.argv) != 2 or not os.path.exists(sys.argv[1]):
    sys.exit(__doc__)
path = sys.argv[1]
with h5py.File(os.path.join(path, "run.h5") if os.path.isdir(path) else path, "r") as f:
    print("title:", text(f.attrs["title"]))
    mass = f["bodies/mass"][:]  # by body id; 0 for fixed bodies
    for name in sorted(f["snapshots"]):
        s = f["snapshots"][name]
        speed = (s["velocity"][:] ** 2).sum(axis=1) ** 0.5
        free = mass[s["id"][:]] > 0
        print("t = %8.4f s  bodies %d  fastest %.4g m/s  kinetic energy %.6g J" %
              (s.attrs["time"], free.sum(), speed[free].max() if free.any() else 0.0, s["kinetic_energy"][:].sum()))
    for name in sorted(f["measures"]):
        m = f["measures"][name]
        print("measure", text(m.attrs["name"]), text(m.attrs["components"]), "last:", m["value"][-1] if len(m["value"])
              else "none")
