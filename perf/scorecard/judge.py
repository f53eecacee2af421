"""What the measures of the problems share. poses[k][body] has 13 numbers: position, orientation w x y z, velocity,
spin."""
import math


def read_poses(name, scene):
    """Times and poses of a driver's file; the scene's own state stands first where an engine keeps none of time 0."""
    times, poses = [], []
    with open(name) as file:
        for line in file:
            if line[0] == "t":
                times.append(float(line[2:]))
                poses.append([])
            else:
                poses[-1].append([float(word) for word in line.split()])
    if times[0] > 1e-9:
        times.insert(0, 0.0)
        poses.insert(0, [[*b.position, *b.turn, *b.velocity, *b.spin] for b in scene.bodies])
    return times, poses


def displacement(poses, body, since=0):
    """Of a body's centre from that sample to the last [m]."""
    return math.dist(poses[-1][body][:3], poses[since][body][:3])
