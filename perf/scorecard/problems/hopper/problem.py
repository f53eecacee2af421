"""3000 spheres of 5 mm leave a funnel of 45 degrees through an orifice of 30 mm.

There is no closed form. Measured is the number of spheres that leave from 0.3 to 0.7 s. Error: against 556, the mean
of the finest runs of four codes (Epafi 552, LAMMPS 578, YADE 560, LIGGGHTS 533 at 2e-5 s). These lie within 4.2 % of
it, so smaller errors are not significant. The law of Beverloo with its usual constants (0.58, k = 1.4, bulk density
0.6 of the solid) gives 534.
"""
from granular import Material, Tube, grain, lattice
from scene import Scene

TITLE = "Hopper: spheres that leave the orifice"
KIND = "grains"
UNIT = "over the mean of the finest"
DURATION = 0.7
EVERY = 0.1
RADIUS, ORIFICE, COUNT = 2.5e-3, 0.015, 3000
REFERENCE = 556.0
OTHERS = "rigid contact needs no stiffness, and no code of rigid bodies here has a funnel"
GRAIN = Material("grain", 2500.0, 2e6)
WALL = Material("wall", 2500.0, 2e6)


def scene():
    top = 0.06
    tubes = [Tube("wall", "z", 0.0, top - ORIFICE, (ORIFICE, top)), Tube("wall", "z", top - ORIFICE, 0.3, (top, top))]

    def inside(x):
        reach = min(x[2] + ORIFICE - 1.42 * RADIUS, top - 1.01 * RADIUS)
        return (x[0] ** 2 + x[1] ** 2) ** 0.5 < reach

    places = lattice(COUNT, RADIUS, (-top, -top, RADIUS), (top, top, 0.3), inside)
    return Scene([grain(GRAIN, RADIUS, p) for p in places], [((0.0, 0.0, 1.0), -0.3)], materials=[GRAIN, WALL],
                 tubes=tubes,
                 pairs={("grain", "grain"): (0.5, 0.4), ("grain", "wall"): (0.5, 0.3)})


def measure(times, poses, scene):
    def left(t):
        at = min(range(len(times)), key=lambda k: abs(times[k] - t))
        return sum(p[2] < 0 for p in poses[at])

    count = left(0.7) - left(0.3)
    return {"": (abs(count / REFERENCE - 1), "ok: %d spheres" % count)}
