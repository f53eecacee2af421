"""Overlaps of a pile of hulls, by the test of separating axes in double precision. Apart from judge.py because of
numpy."""
import numpy


def rotation(q):
    w, x, y, z = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


class Placed:
    """A hull at a pose: vertices, outward normals and edges, for the test of separating axes."""

    def __init__(self, shape, pose):
        vertices, faces = numpy.array(shape[1]), numpy.array(shape[2])
        normals = numpy.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]],
                              vertices[faces[:, 2]] - vertices[faces[:, 0]])
        normals /= numpy.linalg.norm(normals, axis=1)[:, None]
        pairs = {tuple(sorted((int(f[i]), int(f[(i + 1) % 3])))) for f in faces for i in range(3)}
        turn = rotation(pose[3:7])
        self.vertices = vertices @ turn.T + pose[:3]
        self.normals = normals @ turn.T
        self.edges = numpy.array([vertices[j] - vertices[i] for i, j in sorted(pairs)]) @ turn.T
        self.radius = numpy.linalg.norm(vertices, axis=1).max()
        self.low, self.high = self.vertices.min(axis=0), self.vertices.max(axis=0)


def depth(a, b):
    """Overlap of two placed hulls: the least over all axes that may separate them; <= 0: apart."""
    least = numpy.inf
    for axes in (a.normals, b.normals, numpy.cross(a.edges[:, None], b.edges[None]).reshape(-1, 3)):
        length = numpy.linalg.norm(axes, axis=1)
        axes = axes[length > 1e-8] / length[length > 1e-8, None]
        u, v = axes @ a.vertices.T, axes @ b.vertices.T
        least = min(least, numpy.minimum(u.max(1) - v.min(1), v.max(1) - u.min(1)).min(initial=numpy.inf))
        if least <= 0:
            return least
    return least


def overlaps(scene, poses):
    """All overlaps at one time, over the sum of the radii of the pair, or over the radius of a body on a plane."""
    placed = [Placed(b.shape, p) for b, p in zip(scene.bodies, poses)]
    low, high = (numpy.array([getattr(p, name) for p in placed]) for name in ("low", "high"))
    found = []
    for i, body in enumerate(placed):
        for normal, offset in scene.planes:
            sunk = offset - (body.vertices @ numpy.array(normal)).min()
            if sunk > 0:
                found.append(sunk / body.radius)
        for j in numpy.flatnonzero((low[:i] <= high[i]).all(1) & (high[:i] >= low[i]).all(1)):
            d = depth(body, placed[j])
            if d > 0:
                found.append(d / (body.radius + placed[j].radius))
    return found
