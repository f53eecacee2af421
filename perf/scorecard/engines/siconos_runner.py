"""Siconos 4.4 by its Python runner: Moreau-Jean and a solver of the Signorini-Coulomb problem; contacts found by its
Bullet. Options: tolerance=T (1e-4), iterations=N (1000), solver=nsgs|nsn. Arguments as in driver.h. Its times contain
Python and HDF5: the runner is clocked as a whole, with one output at the end. A file named siconos.py would hide the
package."""
import json
import os
import sys
import tempfile
import time

import numpy
import siconos.kernel as kernel
import siconos.numerics as numerics
from siconos.io.mechanics_run import MechanicsHdf5Runner
from siconos.mechanics.collision.bullet import SiconosBulletOptions
from siconos.mechanics.collision.tools import Contactor


def read_body(kind, words):
    def numbers(count):
        return [float(next(words)) for _ in range(count)]

    if kind == "hull":
        corners, faces = (int(next(words)) for _ in range(2))
        size = [numbers(3) for _ in range(corners)]
        numbers(3 * faces)
    else:
        size = numbers(1 if kind == "sphere" else 3)
    names = [("mass", 1), ("inertia", 3), ("position", 3), ("turn", 4), ("velocity", 3), ("spin", 3)]
    return dict(kind=kind, size=size, **{name: numbers(count) for name, count in names})


def read_scene(name):
    with open(name) as file:
        words = iter(file.read().split())
    scene = dict(planes=[], bodies=[])
    for word in words:
        counts = dict(gravity=3, friction=1, restitution=1, modulus=2, wall_friction=1, plane=4)
        if word not in counts:
            scene["bodies"].append(read_body(word, words))
            continue
        values = [float(next(words)) for _ in range(counts[word])]
        if word == "plane":
            scene["planes"].append((values[:3], values[3]))
        else:
            scene[word] = values[0] if len(values) == 1 else values
    return scene


def turn_to(normal):
    """Unit quaternion w x y z from z to the normal."""
    q = numpy.array([1 + normal[2], -normal[1], normal[0], 0.0]) if normal[2] > -0.999 else numpy.array([0, 1.0, 0, 0])
    return list(q / numpy.linalg.norm(q))


def build(scene, file):
    with MechanicsHdf5Runner(mode="w", io_filename=file) as io:
        for k, (normal, offset) in enumerate(scene["planes"]):
            io.add_primitive_shape("plane%d" % k, "Box", (100, 100, 1.0))
            at = [c * (offset - 0.5) for c in normal]
            io.add_object("ground%d" % k, [Contactor("plane%d" % k)], translation=at, orientation=turn_to(normal))
        for k, body in enumerate(scene["bodies"]):
            shape, size = "shape%d" % k, body["size"]
            if body["kind"] == "hull":
                io.add_convex_shape(shape, size, insideMargin=0.001, outsideMargin=0.0)
            elif body["kind"] == "sphere":
                io.add_primitive_shape(shape, "Sphere", size)
            else:
                io.add_primitive_shape(shape, "Box", [2 * c for c in size])
            io.add_object("body%d" % k, [Contactor(shape)], translation=body["position"], orientation=body["turn"],
                          velocity=body["velocity"] + body["spin"], mass=body["mass"][0], inertia=body["inertia"])
        io.add_Newton_impact_friction_nsl("contact", mu=scene["friction"], e=scene["restitution"])


def run(scene, file, duration, dt, every, options):
    """Processor seconds, and the runner's tables of positions and velocities."""
    build(scene, file)
    newton = options.get("solver") == "nsn"
    solver = kernel.solver_options_create(numerics.SICONOS_FRICTION_3D_NSN_AC if newton
                                          else numerics.SICONOS_FRICTION_3D_NSGS)
    solver.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = int(options.get("iterations", 1000))
    solver.dparam[numerics.SICONOS_DPARAM_TOL] = float(options.get("tolerance", 1e-4))
    bullet = SiconosBulletOptions()
    bullet.worldScale = 1.0
    bullet.perturbationIterations = 3
    bullet.minimumPointsPerturbationThreshold = 3

    def weight(body):  # the runner knows gravity only as a force from outside
        body.setFExtPtr([body.scalarMass() * c for c in scene["gravity"]])

    with MechanicsHdf5Runner(mode="r+", io_filename=file, set_external_forces=weight) as io:
        begin = time.process_time()
        io.run(with_timer=False, bullet_options=bullet, gravity_scale=1.0, t0=0, T=duration, h=dt, theta=0.50001,
               Newton_max_iter=1,
               set_external_forces=weight, solver_options=solver, verbose=False, verbose_progress=False,
               numerics_verbose=False,
               output_frequency=every)
        used = time.process_time() - begin
        return used, numpy.array(io.dynamic_data()), numpy.array(io.velocities_data())


def write_poses(name, positions, velocities):
    """Times are kept in single precision: rounded to tell samples apart. The state of time 0 is not kept."""
    table = {(round(r[0], 6), r[1]): r for r in velocities}
    last = None
    with open(name, "w") as file:
        for r in positions[numpy.lexsort((positions[:, 1], numpy.round(positions[:, 0], 6)))]:
            moment = round(r[0], 6)
            v = table.get((moment, r[1]))
            if r[1] <= 0 or v is None:
                continue
            if moment != last:
                file.write("t %.12g\n" % r[0])
            last = moment
            file.write(" ".join("%.12g" % c for c in [*r[2:9], *v[2:8]]) + "\n")


def main():
    name, duration, dt, interval, poses, *rest = sys.argv[1:]
    options = dict(word.split("=") for word in rest)
    duration, dt = float(duration), float(dt)
    every = max(1, round(float(interval) / dt))
    scene = read_scene(name)
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "run.hdf5")
        if poses != "-":
            _, positions, velocities = run(scene, file, duration, dt, every, options)
            write_poses(poses, positions, velocities)
        seconds = run(scene, file, duration, dt, 1000000, options)[0]
    print(json.dumps(dict(cpu_s_per_s=seconds / duration, steps=round(duration / dt), dt=dt)))


main()
