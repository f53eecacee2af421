"""Bodies of a problem, and the two files that the engines read: NAME.scene (engines/driver.h) and NAME.toml (Epafi)."""
import math
import os
from dataclasses import dataclass, field


@dataclass
class Body:
    """A free body: shape ("sphere", R), ("box", lengths) or ("hull", vertices about the centre of mass, triangles)."""
    shape: tuple
    mass: float
    inertia: tuple
    position: tuple
    turn: tuple = (1.0, 0.0, 0.0, 0.0)  # unit quaternion w x y z
    velocity: tuple = (0.0, 0.0, 0.0)
    spin: tuple = (0.0, 0.0, 0.0)


@dataclass
class Scene:
    """A problem's world. planes: (unit normal, offset), solid below. modulus [Pa] is for smooth contact alone."""
    bodies: list
    planes: list = field(default_factory=list)
    gravity: tuple = (0.0, 0.0, -9.81)
    friction: float = 0.5
    restitution: float = 0.0
    modulus: float = 1e8
    poisson: float = 0.2
    wall_friction: float = None  # of upright planes, where it is another


FLOOR = [((0.0, 0.0, 1.0), 0.0)]


def sphere(radius, position, density=1000.0, **more):
    mass = density * 4 / 3 * math.pi * radius**3
    return Body(("sphere", radius), mass, (0.4 * mass * radius**2,) * 3, position, **more)


def box(size, position, density=1000.0, **more):
    a, b, c = (s * s for s in size)
    mass = density * math.prod(size)
    return Body(("box", tuple(size)), mass, tuple(mass / 12 * s for s in (b + c, a + c, a + b)), position, **more)


def prism(section, depth, density):
    """A hull of a convex section (x, z) where it stands, of that depth along y. Its frame is that of its principal axes,
    since the peers take three moments of inertia and no products."""
    n = len(section)
    edges = [(section[k], section[(k + 1) % n]) for k in range(n)]
    cross = [p[0] * q[1] - q[0] * p[1] for p, q in edges]
    if sum(cross) < 0:
        return prism(section[::-1], depth, density)
    area = sum(cross) / 2
    centre = [sum((p[i] + q[i]) * c for (p, q), c in zip(edges, cross)) / (6 * area) for i in (0, 1)]

    def moment(i, j):
        terms = ((p[i] + q[i]) * (p[j] + q[j]) + p[i] * p[j] + q[i] * q[j] for p, q in edges)
        return sum(t * c for t, c in zip(terms, cross)) / 24 - area * centre[i] * centre[j]

    angle = 0.5 * math.atan2(2 * moment(0, 1), moment(0, 0) - moment(1, 1))
    c, s = math.cos(angle), math.sin(angle)
    corners = [(c * (x - centre[0]) + s * (z - centre[1]), c * (z - centre[1]) - s * (x - centre[0])) for x, z in section]
    x = density * depth * (c * c * moment(0, 0) + s * s * moment(1, 1) + 2 * c * s * moment(0, 1))
    z = density * depth * (s * s * moment(0, 0) + c * c * moment(1, 1) - 2 * c * s * moment(0, 1))
    along = density * area * depth**3 / 12
    vertices = [(p, side * depth / 2, q) for side in (-1, 1) for p, q in corners]
    # seen from -y the section turns counter-clockwise: the near end faces -y as listed, the far end the other way
    faces = [(0, k, k + 1) for k in range(1, n - 1)] + [(n, n + k + 1, n + k) for k in range(1, n - 1)]
    for k in range(n):
        j = (k + 1) % n
        faces += [(k, n + k, n + j), (k, n + j, j)]
    turn = (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)  # about -y, which turns x to z
    mass = density * area * depth
    return Body(("hull", vertices, faces), mass, (z + along, x + z, x + along), (centre[0], 0.0, centre[1]), turn)


def volume(shape):
    if shape[0] == "sphere":
        return 4 / 3 * math.pi * shape[1] ** 3
    if shape[0] == "box":
        return math.prod(shape[1])
    total = 0.0
    for a, b, c in ([shape[1][k] for k in face] for face in shape[2]):
        total += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    return total / 6


def numbers(values):
    return " ".join("%.17g" % v for v in values)


def vector(values):
    return "[" + ", ".join("%.17g" % v for v in values) + "]"


def shape_line(shape):
    if shape[0] == "sphere":
        return "sphere %.17g" % shape[1]
    if shape[0] == "box":
        return "box " + numbers(s / 2 for s in shape[1])
    flat = numbers(c for v in shape[1] for c in v)
    return "hull %d %d %s %s" % (len(shape[1]), len(shape[2]), flat, " ".join("%d %d %d" % tuple(f) for f in shape[2]))


def shape_table(shape):
    if shape[0] == "sphere":
        return "sphere = { radius = %.17g }" % shape[1]
    if shape[0] == "box":
        return "box = { size = %s }" % vector(shape[1])
    return "polyhedron = { vertices = [%s] }" % ", ".join(vector(v) for v in shape[1])


def write(scene, duration, stem):
    """STEM.scene for the peers, STEM.toml for Epafi: the same numbers."""
    os.makedirs(os.path.dirname(stem), exist_ok=True)
    with open(stem + ".scene", "w") as f:
        f.write("gravity %s\nfriction %.17g\nrestitution %.17g\n" % (numbers(scene.gravity), scene.friction, scene.restitution))
        f.write("modulus %.17g %.17g\n" % (scene.modulus, scene.poisson))
        if scene.wall_friction is not None:
            f.write("wall_friction %.17g\n" % scene.wall_friction)
        for normal, offset in scene.planes:
            f.write("plane %s %.17g\n" % (numbers(normal), offset))
        for b in scene.bodies:
            state = numbers([b.mass, *b.inertia, *b.position, *b.turn, *b.velocity, *b.spin])
            f.write("%s %s\n" % (shape_line(b.shape), state))
    with open(stem + ".toml", "w") as f:
        f.write("run = { duration = %.17g }\nworld = { gravity = %s }\n" % (duration, vector(scene.gravity)))
        f.write('[contact]\nmethod = "nonsmooth"\nrestitution = %.17g\nfriction = %.17g\n' % (scene.restitution, scene.friction))
        densities = ["%.10g" % (b.mass / volume(b.shape)) for b in scene.bodies]
        names = {d: "m%d" % k for k, d in enumerate(dict.fromkeys(densities))}
        for density, name in names.items():
            f.write("[material.%s]\ndensity = %s\nyoungs_modulus = %.17g\npoissons_ratio = %.17g\n" % (name, density, scene.modulus, scene.poisson))
        if scene.wall_friction is not None:
            f.write("[material.wall]\ndensity = 1000\nyoungs_modulus = %.17g\npoissons_ratio = %.17g\n" % (scene.modulus, scene.poisson))
            f.write('[[contact.pair]]\nbetween = ["wall", "m0"]\nfriction = %.17g\n' % scene.wall_friction)
        for normal, offset in scene.planes:
            other = scene.wall_friction is not None and normal[2] == 0
            f.write("[[body]]\nshape = { half_space = { normal = %s } }\n" % vector(normal))
            f.write('material = "%s"\nfixed = true\n' % ("wall" if other else "m0"))
            f.write("position = %s\n" % vector(offset * c for c in normal))
        for b, density in zip(scene.bodies, densities):
            f.write('[[body]]\nshape = { %s }\nmaterial = "%s"\n' % (shape_table(b.shape), names[density]))
            f.write("position = %s\nvelocity = %s\nangular_velocity = %s\n" % (vector(b.position), vector(b.velocity), vector(b.spin)))
            if b.shape[0] != "sphere":
                f.write("orientation = %s\n" % vector(b.turn))
