"""A card house of three storeys: six pairs of cards that lean on each other 20 degrees off the vertical, three level
ones.

The leaning cards have mitred ends: they stand on flat feet, meet in an upright face and carry on a flat top. So every
contact is a face, and its normal is unique. Exact answer: nothing moves. A card of weight W under a load V at its top
is held by its partner, or on the outer pairs by the friction of the level card, with H h = (W/2 + V) h tan(20). So
neither foot nor top needs more friction than tan(20) = 0.364 < 0.5 under any load. Error: displacement of the topmost
card after 2 s.
"""
import math

from judge import displacement
from scene import FLOOR, Scene, box, prism

TITLE = "Card house of three storeys: displacement of the topmost card after 2 s"
KIND = "hull"
UNIT = "m"
DURATION = 2.0
EVERY = 0.05
LEAN, HEIGHT, FOOT, DEPTH, LEVEL, DENSITY = math.radians(20), 0.1, 0.006, 0.06, 0.004, 700.0


def pair(middle, floor):
    """Two cards that lean on each other. Section: foot, outer side, flat top, upright face, inner side."""
    run, mitre = HEIGHT * math.tan(LEAN), 0.012
    inner = (HEIGHT - mitre) * math.tan(LEAN)
    half = [(inner, 0.0), (inner + FOOT, 0.0), (inner + FOOT - run, HEIGHT), (0.0, HEIGHT), (0.0, HEIGHT - mitre)]
    return [prism([(middle + side * x, floor + z) for x, z in half], DEPTH, DENSITY) for side in (1, -1)]


def scene():
    pitch = 2 * (HEIGHT * math.tan(LEAN) + FOOT)
    bodies = []
    for storey, count in enumerate((3, 2, 1)):
        floor = storey * (HEIGHT + LEVEL)
        middles = [(k - (count - 1) / 2) * pitch for k in range(count)]
        for middle in middles:
            bodies += pair(middle, floor)
        for left, right in zip(middles, middles[1:]):
            # level cards end 0.1 mm short of each other
            size = (pitch - 1e-4, DEPTH, LEVEL)
            bodies.append(box(size, ((left + right) / 2, 0, floor + HEIGHT + LEVEL / 2), DENSITY))
    return Scene(bodies, FLOOR, modulus=1e9)


def measure(times, poses, scene):
    moved = displacement(poses, len(scene.bodies) - 1)
    return {"": (moved, "stands" if moved < 0.05 else "lost: falls")}
