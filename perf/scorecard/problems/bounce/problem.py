"""A sphere falls by 1 m on a plane, restitution 0.8.

Exact answer: each bounce returns e times the speed, so the height after the fifth is 0.8^10 of the first. Error of that
height, relative. The fifth bounce ends at 0.4515 (1 + 2 (0.8 + 0.64 + 0.512 + 0.4096)) + 0.148 = 2.73 s.
"""
from scene import FLOOR, Scene, sphere

TITLE = "Bouncing sphere: height after the fifth bounce"
KIND = "bounce"
UNIT = "relative"
DURATION = 3.2
WHY = ('The error of an impact that is not located within the step is proportional to the step. `impact = '
       '"sequential"` locates it '
       "and is exact at the same cost.")
EVERY = 0.0
RESTITUTION = 0.8


def scene():
    return Scene([sphere(0.5, (0, 0, 1.5))], FLOOR, restitution=RESTITUTION, modulus=1e9)


def peak(heights, k):
    """Height of the parabola through three samples about the highest one."""
    if not 0 < k < len(heights) - 1:
        return heights[k]
    a, b, c = heights[k - 1 : k + 2]
    return b - (c - a) ** 2 / (8 * (a + c - 2 * b)) if a + c < 2 * b else b


def measure(times, poses, scene):
    height, speed = [p[0][2] - 0.5 for p in poses], [p[0][9] for p in poses]
    hits = [k for k in range(1, len(times)) if speed[k - 1] <= 0 < speed[k] and height[k] < 0.1]
    if len(hits) < 5:
        return {"": (1.0, "lost: %d bounces only" % len(hits))}
    end = hits[5] if len(hits) > 5 else len(times)
    top = peak(height, max(range(hits[4], end), key=lambda k: height[k]))
    return {"": (abs(top / RESTITUTION**10 - 1), "ok")}
