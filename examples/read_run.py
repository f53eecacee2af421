#!/usr/bin/env python3
"""Reads run.h5 with h5py alone: columns of every snapshot, measures over time. Usage: read_run.py out/hopper"""
import sys

import h5py


def text(attribute):
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


with h5py.File(sys.argv[1] + "/run.h5", "r") as f:
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
