"""1500 spheres of 4 mm in a drum of 100 mm that turns at 2 rad/s, between smooth ends.

There is no closed form. The drum carries the centre of the grains to the side until the moment of gravity about the
axis equals that of friction on the wall. Measured is the angle of the centre below the axis, mean from 1 to 1.5 s.
Error: against 26.4 degrees, the mean of the finest runs of four codes (Epafi 27.8, LAMMPS 26.5, YADE 25.8, LIGGGHTS
25.3 at 2e-5 s; drums of the last two have 96 facets). Avalanches scatter it: six runs of Epafi at steps of 1.5e-5 to
2.3e-5 s lie from 24.6 to 29.3. Errors below 3 degrees are not significant.
"""
import math

from granular import Material, Tube, grain, lattice
from scene import Scene

TITLE = "Drum: angle of the grains' centre"
KIND = "grains"
UNIT = "degrees"
DURATION = 1.5
EVERY = 0.02
RADIUS, DRUM, WIDTH, COUNT, RATE = 2e-3, 0.05, 0.03, 1500, 2.0
REFERENCE = 26.4
OTHERS = "rigid contact needs no stiffness, and no code of rigid bodies here has a hollow drum"
GRAIN = Material("grain", 2500.0, 2e6)
SIDE = Material("side", 2500.0, 2e6)
WALL = Material("wall", 2500.0, 2e6)


def scene():
    def inside(x):
        return math.hypot(x[0], x[2]) < DRUM - 1.05 * RADIUS

    half = WIDTH / 2
    places = lattice(COUNT, RADIUS, (-DRUM, -half, -DRUM), (DRUM, half, DRUM), inside)
    ends = [((0.0, 1.0, 0.0), -half), ((0.0, -1.0, 0.0), -half)]
    return Scene([grain(GRAIN, RADIUS, p) for p in places], ends, materials=[GRAIN, WALL, SIDE],
                 tubes=[Tube("wall", "y", -half, half, (DRUM, DRUM), RATE)],
                 pairs={("grain", "grain"): (0.5, 0.5), ("grain", "wall"): (0.5, 0.8), ("grain", "side"): (0.5, 0.0)})


def measure(times, poses, scene):
    angles = []
    for t, sample in zip(times, poses):
        if t > 0.99:
            x, z = (sum(p[k] for p in sample) / len(sample) for k in (0, 2))
            angles.append(math.degrees(math.atan2(abs(x), -z)))
    lost = sum(math.hypot(p[0], p[2]) > DRUM + RADIUS for p in poses[-1])
    angle = sum(angles) / len(angles)
    return {"": (abs(angle - REFERENCE), "lost: %d gone" % lost if lost else "ok: %.2f degrees" % angle)}
