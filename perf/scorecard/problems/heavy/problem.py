"""A cube of 1000 t on a cube of 1 t, both of 1 m.

Exact answer: nothing moves; both stand in line on a plane. Error: displacement of the heavy cube after 2 s. The loads
at the two joints are as 1001:1000, the masses as 1000:1. Methods that sweep over contacts need sweeps in proportion
to the mass ratio; methods that factorise do not depend on it.
"""
from judge import displacement
from scene import FLOOR, Scene, box

TITLE = "Heavy on light, 1:1000: displacement of the heavy cube after 2 s"
KIND = "rest"
UNIT = "m"
DURATION = 2.0
WHY = "The number of sweeps is proportional to the mass ratio; a factorisation does not depend on it."
EVERY = 0.05


def scene():
    return Scene([box((1, 1, 1), (0, 0, 0.5)), box((1, 1, 1), (0, 0, 1.5), 1e6)], FLOOR, modulus=1e11)


def measure(times, poses, scene):
    moved = displacement(poses, 1)
    return {"": (moved, "ok" if moved < 0.25 else "lost")}
