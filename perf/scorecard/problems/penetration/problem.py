"""A steel ball of 20 mm strikes a bed of 25 000 spheres of 2 mm at 5 m/s: the third case of Dosta et al. (Comput.
Phys. Commun. 296, 2024, 109066) with moduli of 10 and 100 MPa. The bed came to rest in Epafi's smooth contact; all
start from the same numbers.

There is no closed form. Measured is the depth of the ball after 8 ms over its diameter, shortly before it meets the
floor (its motion after that depends on the last grain beneath it). Error: against 1.5005, the mean of the finest runs
of four codes (Epafi 1.508, LAMMPS 1.500, YADE 1.498, LIGGGHTS 1.496 at 5e-6 s). These lie within 0.0072 of it, so
smaller errors are not significant.
"""
from granular import Material, grain, lattice, settled
from scene import Scene

TITLE = "Penetration of 25 000 spheres by a steel ball"
KIND = "grains"
UNIT = "over the ball's diameter"
DURATION = 0.008
EVERY = 0.002
RADIUS, BALL, SPEED = 1e-3, 0.01, 5.0
REFERENCE = 1.5005
SETTINGS = {"Epafi smooth": ["", "dt=5e-6"], "LAMMPS": ["dt=5e-6"], "LIGGGHTS": ["dt=5e-6"], "YADE": ["dt=5e-6"]}
OTHERS = "a problem of granular codes: twenty thousand spheres of 2 mm"
GRAIN = Material("M1", 2500.0, 1e7)
STEEL = Material("steel", 7200.0, 1e8)
WALLS = [((0.0, 0.0, 1.0), 0.0), ((1.0, 0.0, 0.0), -0.049), ((-1.0, 0.0, 0.0), -0.049), ((0.0, 1.0, 0.0), -0.03),
         ((0.0, -1.0, 0.0), -0.03)]


def box(bodies):
    return Scene(bodies, WALLS, materials=[GRAIN, STEEL],
                 pairs={("M1", "M1"): (0.5, 0.3), ("M1", "steel"): (0.4, 0.2), ("steel", "steel"): (0.4, 0.2)})


def scene():
    places = lattice(25000, RADIUS, (-0.049, -0.03, 0.0), (0.049, 0.03, 0.2))
    bed = settled(box([grain(GRAIN, RADIUS, p) for p in places]), 0.15, 1.5e-5)
    top = sorted(b.position[2] for b in bed)[-20]
    ball = grain(STEEL, BALL, (0.0, 0.0, top + RADIUS + BALL), velocity=(0.0, 0.0, -SPEED))
    return box([ball] + bed)


def measure(times, poses, scene):
    depth = (scene.bodies[0].position[2] - poses[-1][0][2]) / (2 * BALL)
    return {"": (abs(depth - REFERENCE), "ok: %.4f" % depth)}
