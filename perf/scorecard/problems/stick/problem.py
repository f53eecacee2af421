"""A flat box on an incline one degree below the angle of friction. The fall line lies 17 degrees off the axes of the
box and of the world, so that the error of a pyramid in place of Coulomb's cone shows.

Exact answer: the box sticks, at rest from the first moment, since tan(angle) < mu. Error: speed of creep over the
last second.
"""
import math

from judge import displacement
from scene import FLOOR, Scene, box

TITLE = "Incline one degree below the angle of friction: creep"
KIND = "rest"
UNIT = "m/s"
DURATION = 2.0
WHY = "One box sticks at any step, so the cost of a step with four contacts decides."
EVERY = 0.05
FRICTION, AZIMUTH = 0.5, math.radians(17)


def incline(angle):
    """The plane stays level, gravity is turned."""
    along = 9.81 * math.sin(angle)
    gravity = (along * math.cos(AZIMUTH), along * math.sin(AZIMUTH), -9.81 * math.cos(angle))
    return Scene([box((1, 1, 0.5), (0, 0, 0.25), 2500.0)], FLOOR, gravity=gravity, friction=FRICTION)


def scene():
    return incline(math.atan(FRICTION) - math.radians(1))


def measure(times, poses, scene):
    half = min(range(len(times)), key=lambda k: abs(times[k] - times[-1] / 2))
    return {"": (displacement(poses, 0, half) / (times[-1] - times[half]), "ok")}
