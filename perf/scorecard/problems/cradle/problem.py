"""Newton's cradle: a sphere at 3 m/s meets four that touch, restitution 1, no gravity.

Expected answer: impacts one after the other, as between spheres with gaps that shrink to nothing. The last sphere
leaves with the whole speed. Error: root mean square of the five speeds against that answer, over 3 m/s. A law for
simultaneous impacts gives (-3/5, 2/5, 2/5, 2/5, 2/5), error 0.490. Hertz' contact of spheres that touch gives a third
answer, which is right for steel balls (0.064). The status says which answer a row gives, and the energy that was
gained or lost.
"""
import math

from scene import Scene, sphere

TITLE = "Cradle of five: speeds after the impact"
KIND = "impact"
UNIT = "over the speed"
DURATION = 0.1
WHY = ("The expected answer decides: only impacts one after the other send off the last ball. Simultaneous laws "
       "conserve energy and "
       "spread it over the balls.")
EVERY = 0.01
SPEED, RADIUS = 3.0, 0.05


def scene():
    first = sphere(RADIUS, (-0.11, 0, 0), 7800.0, velocity=(SPEED, 0.0, 0.0))
    rest = [sphere(RADIUS, (0.1 * k, 0, 0), 7800.0) for k in range(4)]
    return Scene([first, *rest], gravity=(0.0, 0.0, 0.0), friction=0.0, restitution=1.0, modulus=2.1e11)


def measure(times, poses, scene):
    speeds = [p[7] / SPEED for p in poses[-1]]
    answers = {"one by one": [0, 0, 0, 0, 1], "all at once": [-0.6, 0.4, 0.4, 0.4, 0.4]}
    off = {name: math.dist(speeds, answer) / math.sqrt(len(speeds)) for name, answer in answers.items()}
    kind = next((name for name in answers if off[name] < 0.05), "neither")
    text = "%s (%s); energy %+.2g" % (kind, " ".join("%.3f" % s for s in speeds), sum(s * s for s in speeds) - 1)
    return {"": (off["one by one"], text)}
