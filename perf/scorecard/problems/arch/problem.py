"""An arch of 21 stones, its thickness 0.15 of its mean radius of 10 m, friction 1.

Exact answer: the arch stands and nothing moves. A thrust line lies within a semicircle of t/R > 0.1075 (Milankovitch
1907; Heyman's 0.106), and friction 1 is far above the 0.4 at which stones slide. Error: displacement of the keystone
after 5 s.
"""
import math

from judge import displacement
from scene import FLOOR, Scene, prism

TITLE = "Arch of 21 stones: displacement of the keystone after 5 s"
KIND = "hull"
UNIT = "m"
DURATION = 5.0
EVERY = 0.25
STONES, THICKNESS, RADIUS = 21, 0.15, 10.0


def stone(k):
    """Neighbours share a face; the feet of the first and last stand on the plane."""
    def corner(j, r):
        angle = math.pi * j / STONES
        return r * math.cos(angle), r * math.sin(angle)

    inner, outer = RADIUS * (1 - THICKNESS / 2), RADIUS * (1 + THICKNESS / 2)
    section = [corner(k, inner), corner(k, outer), corner(k + 1, outer), corner(k + 1, inner)]
    return prism(section, 1.0, 2000.0)


def scene():
    return Scene([stone(k) for k in range(STONES)], FLOOR, friction=1.0, modulus=2e10)


def measure(times, poses, scene):
    moved = displacement(poses, STONES // 2)
    return {"": (moved, "stands" if moved < 0.3 else "lost: falls")}
