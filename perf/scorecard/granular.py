"""What the granular problems have beside bodies and planes: materials, hollow walls, beds that have come to rest."""
import csv
import hashlib
import math
import os
import subprocess
from dataclasses import dataclass, replace

import scene as world

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.environ.get("EPAFI", os.path.join(ROOT, "build", "bin", "epafi"))
BEDS = os.path.join(os.path.dirname(PROGRAM), os.pardir, "scorecard", "beds")


@dataclass
class Material:
    """density [kg/m^3], Young's modulus [Pa], Poisson's ratio."""
    name: str
    density: float
    modulus: float
    poisson: float = 0.2


@dataclass
class Tube:
    """A hollow wall of a material about the y or z axis, from low to high along it, its radius at either end [m]; turns
    at rate [rad/s]."""
    material: str
    axis: str
    low: float
    high: float
    radii: tuple
    rate: float = 0.0


def grain(material, radius, position, **more):
    return world.sphere(radius, position, material.density, material=material.name, **more)


def jitter(k, amplitude):
    """Of the k-th grain of a lattice [m]: the same everywhere, no random numbers."""
    return [amplitude * math.sin(factor * (k + 1)) for factor in (12.9898, 78.233, 37.719)]


def lattice(count, radius, low, high, inside=lambda x: True):
    """Places of that many grains that do not touch, in a box [m] from below, where `inside` holds."""
    pitch, found, k = 2.1 * radius, [], 0
    rows = [int((high[i] - low[i]) / pitch) for i in range(2)]
    while len(found) < count:
        layer, cell = divmod(k, rows[0] * rows[1])
        place = [low[0] + (cell % rows[0] + 0.5) * pitch, low[1] + (cell // rows[0] + 0.5) * pitch,
                 low[2] + (layer + 0.5) * pitch]
        if place[2] > high[2]:
            raise SystemExit("lattice: %d of %d grains found room" % (len(found), count))
        place = [x + d for x, d in zip(place, jitter(k, 0.04 * radius))]
        if inside(place):
            found.append(tuple(place))
        k += 1
    return found


def settled(scene, duration, dt):
    """The scene's bodies where Epafi's smooth contact lets them come to rest, at rest; kept from one problem to the
    next run."""
    text = repr((scene, duration, dt)).encode()
    folder = os.path.join(BEDS, hashlib.sha256(text).hexdigest()[:16])
    table = os.path.join(folder, "places.csv")
    if not os.path.exists(table):
        world.write(scene, duration, 0.0, os.path.join(folder, "start"))
        command = [PROGRAM, "run", os.path.join(folder, "start.toml"), "-o", os.path.join(folder, "run"), "-q",
                   "--least-output", "--force"]
        keys = ["contact.method=smooth", "run.time_step=%.17g" % dt, "run.allow_unstable=true"]
        subprocess.run(command + [word for key in keys for word in ("--set", key)], check=True,
                       stdout=subprocess.DEVNULL)
        subprocess.run([PROGRAM, "export", os.path.join(folder, "run"), "--format", "csv"], check=True,
                       stdout=subprocess.DEVNULL)
        os.replace(os.path.join(folder, "run", "bodies.csv"), table)
    with open(table, newline="") as file:
        rows = [r for r in csv.DictReader(line for line in file if not line.startswith("#"))]
    places = [tuple(float(r[k]) for k in "xyz") for r in rows][-len(scene.bodies):]
    return [replace(b, position=p) for b, p in zip(scene.bodies, places)]
