"""What the drivers of the granular codes share: the scene (spheres and planes along the axes) and the arguments of driver.h."""
import sys


class Grains:
    """The scene file, for codes of spheres: bodies have radius, mass, position, velocity, spin."""

    def __init__(self, name):
        self.planes, self.bodies = [], []
        with open(name) as file:
            for words in map(str.split, file):
                numbers = [float(w) for w in words[1:]]
                if words[0] == "plane":
                    axis = max(range(3), key=lambda k: abs(numbers[k]))
                    self.planes.append((axis, numbers[axis], numbers[axis] * numbers[3]))  # axis, outward sign, place
                elif words[0] == "sphere":
                    self.bodies.append(dict(radius=numbers[0], mass=numbers[1], position=numbers[5:8], velocity=numbers[12:15],
                                            spin=numbers[15:18]))
                elif words[0] in ("box", "hull"):
                    sys.exit("spheres only")
                else:
                    setattr(self, words[0], numbers if len(numbers) > 1 else numbers[0])

    def friction_at(self, axis):
        """Of a plane; upright ones may have their own."""
        return getattr(self, "wall_friction", self.friction) if axis < 2 else self.friction

    def density(self, body):
        return body["mass"] / (4 / 3 * 3.141592653589793 * body["radius"] ** 3)


def arguments():
    """Scene, duration, dt, steps between poses, file of poses or None, options."""
    scene, duration, dt, every, poses, *rest = sys.argv[1:]
    duration, dt = float(duration), float(dt)
    return (Grains(scene), duration, dt, max(1, round(float(every) / dt)), None if poses == "-" else poses,
            dict(word.split("=", 1) for word in rest))
