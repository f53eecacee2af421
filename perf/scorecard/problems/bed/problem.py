"""2000 spheres of 5 mm fall into a box with smooth walls and come to rest, 0.6 s.

Exact answer: only the floor carries the spheres, so it bears their weight. The force on the floor follows from the
overlaps by Hertz' formula, 4/3 E* sqrt(R) d^(3/2). Error: that of the mean force over ten poses of the last 0.1 s,
relative to the weight. It contains what still moves, how the law lets the bed settle, and how far the wall of a code
is from Hertz' formula.
"""
import math

from scene import FLOOR, Scene, sphere

TITLE = "Bed of 2000 spheres: force on the floor"
KIND = "bed"
UNIT = "over the weight"
DURATION = 0.6
EVERY = 0.01
RADIUS, ROW, DENSITY = 2.5e-3, 13, 2500.0
WHY = ("The wall decides. One sphere at rest on it (10 mm, 2500 kg/m^3, 10 MPa, 0.3) sinks 8.50 um by Hertz, and 10.71 "
       "in YADE, which halves the "
       "radius at a wall: an error of 0.41. LAMMPS takes E / 2 (1 - nu) for a wall; the modulus of its input "
       "compensates this.")
OTHERS = "overlaps of rigid contact are no forces; the force on the floor cannot be had from poses"


def scene():
    pitch = 2.1 * RADIUS
    side = ROW * pitch

    def place(k):
        layer, cell = divmod(k, ROW * ROW)
        shift = 0.04 * RADIUS * math.sin(12.9898 * (k + 1)), 0.04 * RADIUS * math.sin(78.233 * (k + 1))
        return (cell % ROW + 0.5) * pitch + shift[0], (cell // ROW + 0.5) * pitch + shift[1], RADIUS + layer * pitch

    walls = [((1.0, 0, 0), 0.0), ((-1.0, 0, 0), -side), ((0, 1.0, 0), 0.0), ((0, -1.0, 0), -side)]
    bodies = [sphere(RADIUS, place(k), DENSITY) for k in range(2000)]
    return Scene(bodies, FLOOR + walls, friction=0.5, restitution=0.3, modulus=5e6, poisson=0.3, wall_friction=0.0)


def measure(times, poses, scene):
    modulus = scene.modulus / (2 * (1 - scene.poisson**2))
    weight = 9.81 * sum(b.mass for b in scene.bodies)
    forces = []
    for sample in poses[-10:]:
        sunk = (max(0.0, RADIUS - p[2]) for p in sample)
        forces.append(sum(4 / 3 * modulus * math.sqrt(RADIUS) * d**1.5 for d in sunk))
    gone = sum(p[2] < 0 for p in poses[-1])
    return {"": (abs(sum(forces) / len(forces) / weight - 1), "lost: %d gone" % gone if gone else "ok")}
