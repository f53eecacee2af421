"""YADE: Hertz-Mindlin with a damping from the restitution. Arguments as in driver.h; the text below
runs inside YADE. Time: of the process over O.run, which is clocked apart from what is written."""
import json
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
INSIDE = """import math, resource, sys
sys.path.insert(0, %(here)r)
sys.argv = ["yade"] + %(words)r
from grains import arguments
grains, duration, dt, every, poses, options = arguments()
density = {b["kind"]: grains.density(b) for b in grains.bodies}
materials = [O.materials.append(FrictMat(young=m, poisson=v, density=density.get(k, 1000), frictionAngle=0.5))
             for k, (m, v) in enumerate(grains.materials)]
# without matches a pair takes the smaller friction of its two bodies
restitution = MatchMaker(matches=[(a, b, e) for (a, b), (e, f) in grains.pairs.items()], algo="avg")
friction = MatchMaker(matches=[(a, b, math.atan(f)) for (a, b), (e, f) in grains.pairs.items()], algo="avg")
def build():
    O.bodies.clear()
    O.interactions.clear()
    for b in grains.bodies:
        k = O.bodies.append(sphere(b["position"], b["radius"], material=materials[b["kind"]]))
        O.bodies[k].state.vel, O.bodies[k].state.angVel = b["velocity"], b["spin"]
    for axis, sign, place in grains.planes:
        O.bodies.append(wall(place, axis=axis, sense=int(sign), material=materials[grains.kind_of_plane(axis)]))
    for tube in grains.tubes:
        # facets forget the spring of friction where a grain goes from one to the next
        ids = O.bodies.append([facet(c, material=materials[tube["kind"]]) for c in grains.triangles(tube)])
        if tube["rate"]:
            axis = (0, 0, 1) if tube["axis"] == "z" else (0, 1, 0)
            turn = RotationEngine(ids=ids, rotationAxis=axis, angularVelocity=tube["rate"], rotateAroundZero=True)
            O.engines = O.engines[:-1] + [turn, O.engines[-1]]
def used():
    return sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
O.engines = [ForceResetter(),
             InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb(), Bo1_Facet_Aabb()],
                                   verletDist=0.1 * min(b["radius"] for b in grains.bodies)),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
                             [Ip2_FrictMat_FrictMat_MindlinPhys(en=restitution, frictAngle=friction)],
                             [Law2_ScGeom_MindlinPhys_Mindlin()]),
             NewtonIntegrator(damping=0, gravity=grains.gravity)]
O.dt = dt
build()
steps, done, seconds = round(duration / dt), 0, 0.0
out = open(poses, "w") if poses else None
def write():
    out.write("t %%.12g\\n" %% (done * dt))
    for k in range(len(grains.bodies)):
        s = O.bodies[k].state
        out.write(" ".join("%%.14g" %% x for x in [*s.pos, 1, 0, 0, 0, *s.vel, *s.angVel]) + "\\n")
if out:
    write()
while done < steps:
    n = min(every, steps - done) if out else steps
    before = used()
    O.run(n, True)
    seconds += used() - before
    done += n
    if out:
        write()
if out:
    out.close()
print("RESULT", seconds / duration, steps)
"""


def main():
    with tempfile.TemporaryDirectory() as folder:
        script = os.path.join(folder, "run.py")
        with open(script, "w") as f:
            f.write(INSIDE % dict(here=HERE, words=sys.argv[1:]))
        done = subprocess.run(["yade", "-n", "-x", "-j1", script], capture_output=True, text=True)
    if done.returncode < 0:  # its limit of processor time, say, is ours
        os.kill(os.getpid(), -done.returncode)
    found = re.search(r"^RESULT (\S+) (\S+)$", done.stdout, re.M)
    if not found:
        raise SystemExit("yade: " + " ".join((done.stdout + done.stderr).split("\n")[-4:]))
    print(json.dumps(dict(cpu_s_per_s=float(found[1]), steps=int(found[2]), dt=float(sys.argv[3]))))


main()
