"""A sphere put on a plane at 2 m/s without spin: it slides, then rolls.

Exact answer: friction mu m g brakes the sphere and turns it until the point of contact rests. From then on v = 5/7
v0, from t = 2 v0 / (7 mu g). Errors, relative: of the speed after 1 s, and of the time at which slip has fallen to 5
% of v0 (0.95 t; steps do not resolve the very end of sliding).
"""
from scene import FLOOR, Scene, sphere

TITLE = "Sphere from sliding to rolling"
KIND = "roll"
UNIT = "relative"
DURATION = 1.0
WHY = ("With one contact the fixed cost of a step decides. Our default also takes shorter steps, a hundredth of the "
       "duration, so that "
       "each of its hundred snapshots falls on a step.")
EVERY = 0.0
SPEED, RADIUS, FRICTION = 2.0, 0.05, 0.2


def scene():
    ball = sphere(RADIUS, (0, 0, RADIUS), 7800.0, velocity=(SPEED, 0.0, 0.0))
    return Scene([ball], FLOOR, friction=FRICTION, modulus=1e9)


def measure(times, poses, scene):
    speed = [p[0][7] for p in poses]
    slip = [p[0][7] - RADIUS * p[0][11] for p in poses]
    last = abs(speed[-1] / (SPEED * 5 / 7) - 1)
    level = 0.05 * SPEED
    k = next((k for k in range(1, len(times)) if slip[k] < level), None)
    if k is None:
        return {"speed": (last, "lost: never rolls"), "onset": (1.0, "lost: never rolls")}
    onset = times[k - 1] + (slip[k - 1] - level) / (slip[k - 1] - slip[k]) * (times[k] - times[k - 1])
    exact = 0.95 * 2 * SPEED / (7 * FRICTION * 9.81)
    return {"speed": (last, "ok"), "onset": (abs(onset / exact - 1), "ok")}
