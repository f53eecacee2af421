"""200 polyhedra fall into a box, 3 s.

Exact answer: rigid bodies do not overlap. Errors at the end: the deepest overlap, and the sum of overlaps per body,
both over the sum of the radii. The separating axes of all pairs give them in double precision (overlap.py),
independent of all engines. The status says how many bodies left the box and how fast they still move: bodies that fly
about overlap little.
"""
import math
import os

from scene import FLOOR, Body, Scene

TITLE = "Pile of 200 polyhedra"
KIND = "pile"
UNIT = "overlap over the sum of radii"
DURATION = 3.0
WHY = ("Most contacts of a loose pile are cheap to sweep. Exact solutions while the pile falls cost several times more "
       "and reduce the "
       "overlap little, since an overlap of 1e-4 is left on purpose.")
EVERY = 0.5
COUNT, SIDE, PITCH = 200, 1.1, 0.262
BODIES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../../scenes/library/pile/poly_1000.polyset")


def place(k):
    """On a lattice, a little out of line."""
    row = int((SIDE - 0.004) / PITCH)
    layer, cell = divmod(k, row * row)
    x, y = ((c - (row - 1) / 2) * PITCH for c in (cell % row, cell // row))
    return x + 0.002 * math.sin(12.9 * k), y + 0.002 * math.sin(78.2 * k), 0.15 + layer * PITCH


def scene():
    with open(BODIES) as file:
        rows = [line.split() for line in file if line[0] in "bvf"]
    bodies, at = [], 0
    while len(bodies) < COUNT:
        corners, faces = int(rows[at][1]), int(rows[at][2])
        head = [float(word) for word in rows[at][3:]]
        vertices = [tuple(map(float, row[1:4])) for row in rows[at + 1 : at + 1 + corners]]
        triangles = [tuple(map(int, row[1:4])) for row in rows[at + 1 + corners : at + 1 + corners + faces]]
        bodies.append(Body(("hull", vertices, triangles), head[0], head[1:4], place(len(bodies)), tuple(head[7:11])))
        at += 1 + corners + faces
    walls = [((1, 0, 0), -SIDE / 2), ((-1, 0, 0), -SIDE / 2), ((0, 1, 0), -SIDE / 2), ((0, -1, 0), -SIDE / 2)]
    return Scene(bodies, FLOOR + walls, modulus=1e7)


def measure(times, poses, scene):
    from overlap import overlaps  # here: the pages are written without numpy

    last = poses[-1]
    found = overlaps(scene, last)
    gone = sum(p[2] < -0.05 or abs(p[0]) > 0.65 or abs(p[1]) > 0.65 for p in last)
    speed = math.sqrt(sum(v * v for p in last for v in p[7:10]) / len(last))
    text = "%d gone, rms speed %.1e m/s" % (gone, speed)
    if gone or speed > 0.1:
        text = "lost: " + text
    return {"max": (float(max(found, default=0)), text), "mean": (float(sum(found) / len(scene.bodies)), text)}
