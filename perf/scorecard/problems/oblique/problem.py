"""Spheres strike a plane at 45 degrees: aluminium oxide of Chung and Ooi's fourth test (Granular Matter 13, 2011, 643),
2.5 mm, 3.9 m/s, restitution 0.98, friction 0.092, no gravity; 4096 of them side by side without touching each other,
since the impact of one ends within a tick of the processor clock.

Exact answer: the contact slides all the time, since tan(45) = 1 > 7/2 mu (1 + e) = 0.64. The impulse (1 + e) m v_n
returns e v_n; friction takes mu (1 + e) v_n from the velocity along the plane and gives the spin 5/2 mu (1 + e) v_n /
R. Both hold for rigid and for deformable contact. Error: the largest of the three deviations (spin as 2/5 R omega) of
any sphere over the speed.
"""
import math

from scene import FLOOR, Scene, sphere

TITLE = "Oblique impacts of Chung and Ooi, sliding"
KIND = "grain"
UNIT = "over the speed"
DURATION = 3e-5
EVERY = 1e-5
SPEED, RADIUS, RESTITUTION, FRICTION = 3.9, 2.5e-3, 0.98, 0.092
SIDE = 64  # spheres along each side of the square lattice
WHY = ("The restitution decides. YADE's damping is a fit, which gives 0.972 instead of 0.98; the input of LAMMPS is "
       "chosen so that its fit "
       "gives 0.98.")
OTHERS = "a problem of granular codes: bodies of millimetres, steps of 1e-7 s"


def scene():
    part = SPEED * math.sqrt(0.5)
    balls = [sphere(RADIUS, (4 * RADIUS * i, 4 * RADIUS * j, RADIUS + 1e-6), 4000.0, velocity=(part, 0.0, -part))
             for i in range(SIDE) for j in range(SIDE)]
    return Scene(balls, FLOOR, gravity=(0.0, 0.0, 0.0), friction=FRICTION, restitution=RESTITUTION, modulus=380e9,
                 poisson=0.23)


def measure(times, poses, scene):
    normal = SPEED * math.sqrt(0.5)
    taken = FRICTION * (1 + RESTITUTION) * normal
    off = 0.0
    for last in poses[-1]:
        gone = (last[7] - (normal - taken), last[9] - RESTITUTION * normal, 0.4 * RADIUS * last[11] - taken)
        off = max(off, *map(abs, gone))
    lost = any(last[9] <= 0 for last in poses[-1])
    return {"": (off / SPEED, "lost: no rebound" if lost else "ok")}
