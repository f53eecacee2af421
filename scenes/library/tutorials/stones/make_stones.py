#!/usr/bin/env python3
"""Makes the three stones of tutorial 4: convex hulls of points near an ellipsoid, some corners of which are broken in.
The same bytes on every machine: python3 make_stones.py   (writes stone_a.obj, stone_b.stl, stone_c.ply; millimetres)"""
import math
import random


def sub(a, b):
    return [a[i] - b[i] for i in range(3)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def hull(points):
    """Triangles (outward) of the convex hull: every plane of three points that has all others on one side."""
    triangles = []
    n = len(points)
    for i in range(n):
        for j in range(i + 1, n):
            for k in range(j + 1, n):
                normal = cross(sub(points[j], points[i]), sub(points[k], points[i]))
                side = [dot(normal, sub(p, points[i])) for m, p in enumerate(points) if m not in (i, j, k)]
                if all(s < 0 for s in side):
                    triangles.append((i, j, k))
                elif all(s > 0 for s in side):
                    triangles.append((i, k, j))
    return triangles


def stone(seed, corners, semi_axes, dents, depth):
    """dents: how many corners are pulled towards the centre, to `depth` of their distance."""
    rng = random.Random(seed)
    points = []
    for k in range(corners):  # a spiral from pole to pole, shaken
        z = 1 - 2 * (k + 0.5) / corners
        angle, s, r = 2.399963 * k + rng.uniform(-0.3, 0.3), math.sqrt(1 - z * z), rng.uniform(0.82, 1.0)
        points.append([r * semi_axes[0] * s * math.cos(angle), r * semi_axes[1] * s * math.sin(angle),
                       r * semi_axes[2] * z])
    triangles = hull(points)
    used = sorted({v for t in triangles for v in t})
    name = {v: i for i, v in enumerate(used)}
    points, triangles = [points[v] for v in used], [tuple(name[v] for v in t) for t in triangles]
    neighbours = [{w for t in triangles if v in t for w in t} for v in range(len(points))]
    broken = []
    while len(broken) < dents:
        v = rng.randrange(len(points))
        if not any(v in neighbours[w] for w in broken):
            broken.append(v)
    for v in broken:
        points[v] = [depth * x for x in points[v]]
    return [[round(x, 4) for x in p] for p in points], triangles


def write_obj(path, points, triangles):
    with open(path, "w") as f:
        f.write("# a broken stone, millimetres\n")
        f.writelines("v %.4f %.4f %.4f\n" % tuple(p) for p in points)
        f.writelines("f %d %d %d\n" % tuple(v + 1 for v in t) for t in triangles)


def write_stl(path, points, triangles):
    with open(path, "w") as f:
        f.write("solid stone\n")
        for t in triangles:
            f.write("facet normal 0 0 0\nouter loop\n")
            f.writelines("vertex %.4f %.4f %.4f\n" % tuple(points[v]) for v in t)
            f.write("endloop\nendfacet\n")
        f.write("endsolid stone\n")


def write_ply(path, points, triangles):
    with open(path, "w") as f:
        f.write("ply\nformat ascii 1.0\ncomment a broken stone, millimetres\nelement vertex %d\n" % len(points))
        f.write("property double x\nproperty double y\nproperty double z\n")
        f.write("element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(triangles))
        f.writelines("%.4f %.4f %.4f\n" % tuple(p) for p in points)
        f.writelines("3 %d %d %d\n" % t for t in triangles)


if __name__ == "__main__":
    write_obj("stone_a.obj", *stone(1, 26, (10.0, 8.0, 6.0), 2, 0.55))
    write_stl("stone_b.stl", *stone(2, 32, (9.0, 6.3, 6.8), 3, 0.6))
    write_ply("stone_c.ply", *stone(3, 22, (11.0, 6.0, 5.5), 2, 0.5))
