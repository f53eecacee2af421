"""What the drivers of the granular codes share: the scene (spheres, planes along the axes, hollow walls) and the
arguments of driver.h."""
import math
import sys

FACETS = 96  # of a tube's circumference, whose corners lie on it: radii 0.05 % too small where it counts


class Grains:
    """The scene file, for codes of spheres: bodies have radius, mass, position, velocity, spin, kind (of material, from
    0). materials: (Young's modulus, Poisson's ratio) by kind, walls last; pairs: (restitution, friction) by two kinds,
    the smaller first."""

    def __init__(self, name):
        self.planes, self.tubes, self.bodies, self.materials, self.pairs = [], [], [], [], {}
        self.names, kind = [], 0
        with open(name) as file:
            for words in map(str.split, file):
                if words[0] in ("material", "pair", "tube", "made_of"):
                    kind = self.granular(words, kind)
                    continue
                numbers = [float(w) for w in words[1:]]
                if words[0] == "plane":
                    axis = max(range(3), key=lambda k: abs(numbers[k]))
                    self.planes.append((axis, numbers[axis], numbers[axis] * numbers[3]))  # axis, outward sign, place
                elif words[0] == "sphere":
                    self.bodies.append(dict(radius=numbers[0], mass=numbers[1], position=numbers[5:8],
                                            velocity=numbers[12:15],
                                            spin=numbers[15:18], kind=kind))
                elif words[0] in ("box", "hull"):
                    sys.exit("spheres only")
                else:
                    setattr(self, words[0], numbers if len(numbers) > 1 else numbers[0])
        if not self.materials:
            self.one_material()

    def granular(self, words, kind):
        """A line of a scene with several materials; returns the kind of the bodies that follow."""
        if words[0] == "made_of":
            return self.names.index(words[1])
        if words[0] == "material":
            self.names.append(words[1])
            self.materials.append((float(words[2]), float(words[3])))
        elif words[0] == "pair":
            between = tuple(sorted(self.names.index(w) for w in words[1:3]))
            self.pairs[between] = (float(words[3]), float(words[4]))
        else:
            low, high, start, end, rate = map(float, words[3:])
            self.tubes.append(dict(kind=self.names.index(words[1]), axis=words[2], low=low, high=high,
                                   radii=(start, end), rate=rate))
        return kind

    def one_material(self):
        """Grains and floor of one material, upright planes with a friction of their own as another."""
        self.materials = [tuple(self.modulus)] * 2
        self.pairs = {(0, 0): (self.restitution, self.friction),
                      (0, 1): (self.restitution, getattr(self, "wall_friction", self.friction))}

    def kind_of_plane(self, axis):
        """Its material: the last one, where there is but one that of the grains for the floor and another for upright
        planes."""
        if self.names:
            return len(self.materials) - 1
        return 1 if axis < 2 else 0

    def kinds(self):
        """Of the bodies."""
        return sorted({b["kind"] for b in self.bodies})

    def pair(self, a, b):
        """Young's modulus that two bodies of one material would have to have for the stiffness of this pair, Poisson's
        ratio, restitution and friction; None where the pair does not touch."""
        both = self.pairs.get((min(a, b), max(a, b)))
        (p, v), (q, _) = self.materials[a], self.materials[b]
        return both and (2 * p * q / (p + q), v, *both)

    def density(self, body):
        return body["mass"] / (4 / 3 * math.pi * body["radius"] ** 3)

    def triangles(self, tube):
        """Of a tube, facets of equal angle."""
        def corner(k, end):
            a, r, x = 2 * math.pi * k / FACETS, tube["radii"][end], (tube["low"], tube["high"])[end]
            return (r * math.cos(a), r * math.sin(a),
                    x) if tube["axis"] == "z" else (r * math.cos(a), x, r * math.sin(a))

        for k in range(FACETS):
            yield corner(k, 0), corner(k + 1, 0), corner(k + 1, 1)
            yield corner(k, 0), corner(k + 1, 1), corner(k, 1)


def arguments():
    """Scene, duration, dt, steps between poses, file of poses or None, options."""
    scene, duration, dt, every, poses, *rest = sys.argv[1:]
    duration, dt = float(duration), float(dt)
    return (Grains(scene), duration, dt, max(1, round(float(every) / dt)), None if poses == "-" else poses,
            dict(word.split("=", 1) for word in rest))
