"""Ten cubes on each other, each up to 2 mm out of line.

Exact answer: nothing moves. Whatever the forces between the cubes, the centre of mass of all cubes above a joint lies
within 4 mm of the middle of a face of 1 m, so each joint carries its load by pressure alone, and nothing pushes
sideways. Error: displacement of the top cube after 2 s. A soft stack sinks; a stack that is solved inaccurately drifts.
"""
import math

from judge import displacement
from scene import FLOOR, Scene, box

TITLE = "Stack of ten cubes: displacement of the top one after 2 s"
KIND = "rest"
UNIT = "m"
DURATION = 2.0
WHY = ("A sweep carries a load over one joint. So engines with a fixed number of sweeps have an error that falls with "
       "the step. "
       "Methods that factorise the contact problem of the stack do not.")
EVERY = 0.05


def scene():
    def place(k):
        return 0.002 * math.sin(12.9898 * (k + 1)), 0.002 * math.sin(78.233 * (k + 1)), k + 0.5

    return Scene([box((1, 1, 1), place(k)) for k in range(10)], FLOOR)


def measure(times, poses, scene):
    moved = displacement(poses, 9)
    return {"": (moved, "ok" if moved < 0.25 else "lost")}
