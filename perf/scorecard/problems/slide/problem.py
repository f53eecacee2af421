"""The box of the problem `stick`, one degree above the angle of friction.

Exact answer: the box slides along the fall line with a = g (sin(angle) - mu cos(angle)), by a t^2/2. Error: of the
displacement after 2 s, as a vector, relative to it. A circumscribed pyramid of friction holds the box (error 1), an
inscribed one is too weak.
"""
import importlib.util
import math
import os

_beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "stick", "problem.py")
_spec = importlib.util.spec_from_file_location("stick_problem", _beside)
stick = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(stick)

TITLE = "Incline one degree above the angle of friction: displacement after 2 s"
KIND = "rest"
UNIT = "relative"
DURATION = 2.0
EVERY = 0.05
ANGLE = math.atan(stick.FRICTION) + math.radians(1)


def scene():
    return stick.incline(ANGLE)


def measure(times, poses, scene):
    acceleration = 9.81 * (math.sin(ANGLE) - stick.FRICTION * math.cos(ANGLE))
    way = 0.5 * acceleration * times[-1] ** 2
    start, end = poses[0][0], poses[-1][0]
    exact = (start[0] + way * math.cos(stick.AZIMUTH), start[1] + way * math.sin(stick.AZIMUTH), start[2])
    return {"": (math.dist(end[:3], exact) / way, "ok")}
