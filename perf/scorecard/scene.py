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
    material: str = None  # of Scene.materials, where there are some


@dataclass
class Scene:
    """A problem's world. planes: (unit normal, offset), solid below. modulus [Pa] is for smooth contact alone. Granular
    problems may have granular.Material and granular.Tube, then the planes are of the last material."""
    bodies: list
    planes: list = field(default_factory=list)
    gravity: tuple = (0.0, 0.0, -9.81)
    friction: float = 0.5
    restitution: float = 0.0
    modulus: float = 1e8
    poisson: float = 0.2
    wall_friction: float = None  # of upright planes, where it is another
    materials: list = field(default_factory=list)
    pairs: dict = field(default_factory=dict)  # (name, name): (restitution, friction), of every pair that may touch
    tubes: list = field(default_factory=list)


FLOOR = [((0.0, 0.0, 1.0), 0.0)]


def sphere(radius, position, density=1000.0, **more):
    mass = density * 4 / 3 * math.pi * radius**3
    return Body(("sphere", radius), mass, (0.4 * mass * radius**2,) * 3, position, **more)


def box(size, position, density=1000.0, **more):
    a, b, c = (s * s for s in size)
    mass = density * math.prod(size)
    return Body(("box", tuple(size)), mass, tuple(mass / 12 * s for s in (b + c, a + c, a + b)), position, **more)


def prism(section, depth, density):
    """A hull of a convex section (x, z) where it stands, of that depth along y. Its frame is that of its principal
    axes, since the peers take three moments of inertia and no products."""
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
    corners = [(c * (x - centre[0]) + s * (z - centre[1]), c * (z - centre[1]) - s * (x - centre[0]))
               for x, z in section]
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
        total += a[0] * (b[1] * c[2] - b[2] * c[1])
        total += a[1] * (b[2] * c[0] - b[0] * c[2])
        total += a[2] * (b[0] * c[1] - b[1] * c[0])
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


def write_peers(scene, f):
    """NAME.scene: what engines/driver.h and engines/grains.py read."""
    f.write("gravity %s\nfriction %.17g\nrestitution %.17g\n" %
            (numbers(scene.gravity), scene.friction, scene.restitution))
    f.write("modulus %.17g %.17g\n" % (scene.modulus, scene.poisson))
    if scene.wall_friction is not None:
        f.write("wall_friction %.17g\n" % scene.wall_friction)
    for m in scene.materials:
        f.write("material %s %s\n" % (m.name, numbers([m.modulus, m.poisson, m.density])))
    for (a, b), values in scene.pairs.items():
        f.write("pair %s %s %s\n" % (a, b, numbers(values)))
    for t in scene.tubes:
        f.write("tube %s %s %s\n" % (t.material, t.axis, numbers([t.low, t.high, *t.radii, t.rate])))
    for normal, offset in scene.planes:
        f.write("plane %s %.17g\n" % (numbers(normal), offset))
    last = None
    for b in scene.bodies:
        if b.material != last:
            f.write("made_of %s\n" % b.material)
            last = b.material
        state = numbers([b.mass, *b.inertia, *b.position, *b.turn, *b.velocity, *b.spin])
        f.write("%s %s\n" % (shape_line(b.shape), state))


def write_materials(scene, f):
    """Of NAME.toml; returns the material of each body, of the floor and of upright planes."""
    if scene.materials:
        for m in scene.materials:
            f.write("[material.%s]\ndensity = %.17g\nyoungs_modulus = %.17g\npoissons_ratio = %.17g\n" %
                    (m.name, m.density, m.modulus, m.poisson))
        for (a, b), (restitution, friction) in scene.pairs.items():
            f.write('[[contact.pair]]\nbetween = ["%s", "%s"]\nrestitution = %.17g\nfriction = %.17g\n' %
                    (a, b, restitution, friction))
        return [b.material for b in scene.bodies], scene.materials[-1].name, scene.materials[-1].name
    densities = ["%.10g" % (b.mass / volume(b.shape)) for b in scene.bodies]
    names = {d: "m%d" % k for k, d in enumerate(dict.fromkeys(densities))}
    elastic = "youngs_modulus = %.17g\npoissons_ratio = %.17g\n" % (scene.modulus, scene.poisson)
    for density, name in names.items():
        f.write("[material.%s]\ndensity = %s\n%s" % (name, density, elastic))
    if scene.wall_friction is None:
        return [names[d] for d in densities], "m0", "m0"
    f.write("[material.wall]\ndensity = 1000\n%s" % elastic)
    f.write('[[contact.pair]]\nbetween = ["wall", "m0"]\nfriction = %.17g\n' % scene.wall_friction)
    return [names[d] for d in densities], "m0", "wall"


def write_epafi(scene, duration, every, f):
    """NAME.toml, with planes and tubes first. every: seconds between the poses that are wanted, 0 where none are
    said."""
    output = ", output_interval = %.17g" % every if every else ""
    f.write("run = { duration = %.17g%s }\nworld = { gravity = %s }\n" % (duration, output, vector(scene.gravity)))
    f.write('[contact]\nmethod = "nonsmooth"\nrestitution = %.17g\nfriction = %.17g\n' %
            (scene.restitution, scene.friction))
    materials, floor, upright = write_materials(scene, f)
    for normal, offset in scene.planes:
        f.write("[[body]]\nshape = { half_space = { normal = %s } }\n" % vector(normal))
        f.write('material = "%s"\nfixed = true\n' % (upright if normal[2] == 0 else floor))
        f.write("position = %s\n" % vector(offset * c for c in normal))
    for t in scene.tubes:
        f.write('[[body]]\nshape = { cone = { radii = %s, length = %.17g } }\nmaterial = "%s"\n' %
                (vector(t.radii), t.high - t.low, t.material))
        middle = (t.low + t.high) / 2
        f.write("position = %s\neuler_deg = [%d, 0, 0]\n" %
                (vector((0, 0, middle) if t.axis == "z" else (0, middle, 0)), 0 if t.axis == "z" else -90))
        turn = [float(a == t.axis) for a in "xyz"]
        f.write("motion = { rotation = { axis = %s, rate = %.17g, about = [0, 0, 0] } }\n" % (vector(turn), t.rate)
                if t.rate else "fixed = true\n")
    for b, material in zip(scene.bodies, materials):
        f.write('[[body]]\nshape = { %s }\nmaterial = "%s"\n' % (shape_table(b.shape), material))
        f.write("position = %s\nvelocity = %s\nangular_velocity = %s\n" %
                (vector(b.position), vector(b.velocity), vector(b.spin)))
        if b.shape[0] != "sphere":
            f.write("orientation = %s\n" % vector(b.turn))


def write(scene, duration, every, stem):
    """STEM.scene for the peers, STEM.toml for Epafi: the same numbers."""
    os.makedirs(os.path.dirname(stem), exist_ok=True)
    with open(stem + ".scene", "w") as f:
        write_peers(scene, f)
    with open(stem + ".toml", "w") as f:
        write_epafi(scene, duration, every, f)
