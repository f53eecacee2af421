#!/usr/bin/env python3
"""The largest stable step of random beds, stacks, drums and presses, found by bisection of their energy balance, beside
the limit that `epafi check` states and a written step is held against.
   python3 perf/step_limits.py build/bin/epafi [--draws N] [--seed S] [kind ...]
A step fails where the balance opens by more than all energy: at stable steps it errs by percents, above the limit
it grows by factors with every step. Columns: kind, draw, the limit stated, the one found [s], stated over found, and
what was drawn. The last lines give the range of the quotient by kind."""
import argparse
import os
import random
import re
import subprocess
import sys
import tempfile

LAWS = ["hertz", "hertz-mindlin", "linear"]
OPEN = 1.0  # of the balance


def contact(draw, stiffness):
    law = f'law = "{draw["law"]}"' + (f', stiffness = {stiffness}' if draw["law"] == "linear" else "")
    return (f'contact = {{ method = "smooth", restitution = {draw["e"]}, friction = {draw["mu"]}, '
            f'smooth = {{ {law} }} }}\n')


def head(draw, duration, gravity=-9.81):
    return (f"run = {{ duration = {duration}, output_interval = {duration}, time_step = \"auto\" }}\n"
            f"world = {{ gravity = [0, 0, {gravity}] }}\n"
            f'material.m = {{ density = 2500, youngs_modulus = {draw["modulus"]}, poissons_ratio = 0.25 }}\n'
            + contact(draw, draw["modulus"] * draw["r"]))


def plane(name, normal, point, state="fixed = true"):
    return (f'[[body]]\nname = "{name}"\nshape = {{ half_space = {{ normal = {normal} }} }}\n'
            f'position = {point}\nmaterial = "m"\n{state}\n')


def walls(half):
    return "".join(plane(f"w{k}", n, p) for k, (n, p) in enumerate([
        ([1, 0, 0], [-half, 0, 0]), ([-1, 0, 0], [half, 0, 0]), ([0, 1, 0], [0, -half, 0]),
        ([0, -1, 0], [0, half, 0])]))


def fill(r, count, low, high):
    return (f'[shape.ball]\nsphere = {{ radius = {r} }}\n[[fill]]\nshape = "ball"\nmaterial = "m"\ncount = {count}\n'
            f'size = {{ distribution = "uniform", min = 0.9, max = 1.1 }}\n'
            f"region = {{ box = {{ min = {low}, max = {high} }} }}\n")


def nudge(rng, r):
    """What symmetric scenes need: a mode that nothing excites is not seen to grow."""
    v = (9.81 * r) ** 0.5
    return (f'velocity = [{0.01 * v}, {0.007 * v}, 0]\nangular_velocity = '
            f'[{rng.uniform(-0.1, 0.1) * v / r}, {rng.uniform(-0.1, 0.1) * v / r}, 0]\n')


def servo(force, mass, r):
    speed = (9.81 * r) ** 0.5
    return f"motion = {{ servo = {{ force = {force}, direction = [0, 0, -1], mass = {mass}, max_speed = {speed} }} }}"


def settle_time(r):
    return 8.0 * (20.0 * r / 9.81) ** 0.5


def bed(draw, rng):
    r, n = draw["r"], rng.choice([60, 150])
    half = 3.2 * r if n == 60 else 4.2 * r
    top = 4.0 * n * r ** 3 * 8 / (2 * half) ** 2
    draw["n"] = n
    return (head(draw, settle_time(r)) + plane("floor", [0, 0, 1], [0, 0, 0]) + walls(half)
            + fill(r, n, [-half, -half, 0], [half, half, top]))


def pressed_bed(draw, rng):
    r, n = draw["r"], 60
    half, weight = 3.2 * r, 60 * 2500 * 9.81 * 4.19 * r ** 3
    top = 4.0 * n * r ** 3 * 8 / (2 * half) ** 2
    force = weight * 10 ** rng.uniform(0, 2)
    draw["press"] = force / weight
    plate = plane("plate", [0, 0, -1], [0, 0, top], servo(force, 0.1 * weight / 9.81, r))
    return (head(draw, 1.5 * settle_time(r) + top / (9.81 * r) ** 0.5) + plane("floor", [0, 0, 1],
                                                                               [0, 0, 0]) + walls(half) + plate
            + fill(r, n, [-half, -half, 0], [half, half, top]))


def stack(draw, rng):
    a, n = draw["r"], rng.choice([1, 2, 3, 5])
    size = [round(a * rng.uniform(1, 3), 9), round(a * rng.uniform(1, 3), 9), a]
    draw["n"], draw["size"] = n, [round(s / a, 2) for s in size]
    return (head(draw, 3.0 * (20 * a / 9.81) ** 0.5) + plane("floor", [0, 0, 1], [0, 0, 0])
            + f'[[body]]\nname = "b"\nrepeat = {n}\nshape = {{ box = {{ size = {size} }} }}\nmaterial = "m"\n'
              f'position = [0, 0, "= (0.5 + i)*{a}"]\n' + nudge(rng, a))


def drum(draw, rng):
    r = draw["r"]
    radius, length = 14 * r, 5 * r
    froude = rng.choice([0.02, 0.3])
    rate = (froude * 9.81 / radius) ** 0.5
    draw["froude"] = froude
    return (head(draw, 1.2 * settle_time(3 * r)) + f'[[body]]\nname = "drum"\nshape = {{ tube = {{ radius = {radius}, '
            f'length = {length}, ends = "closed" }} }}\neuler_deg = [90, 0, 0]\nmaterial = "m"\n'
            f"motion = {{ rotation = {{ axis = [0, 1, 0], rate = {rate}, about = [0, 0, 0] }} }}\n"
            + fill(r, 120, [-9 * r, -2.5 * r, -9 * r], [9 * r, 2.5 * r, 9 * r]))


def press(draw, rng):
    r, n = draw["r"], rng.choice([1, 2, 3, 5])
    mass = 2500 * 4.19 * r ** 3
    force = 9.81 * mass * 10 ** rng.uniform(0.5, 3)
    draw["n"], draw["press"] = n, force / mass / 9.81
    gravity = rng.choice([0.0, -9.81])
    return (head(draw, 2.0 * settle_time(r), gravity) + plane("floor", [0, 0, 1], [0, 0, 0])
            + f'[[body]]\nname = "b"\nrepeat = {n}\nshape = {{ sphere = {{ radius = {r} }} }}\nmaterial = "m"\n'
              f'position = [0, 0, "= (1 + 2*i)*{r}"]\n' + nudge(rng, r)
            + plane("plate", [0, 0, -1], [0, 0, (2 * n + 0.02) * r], servo(force, rng.choice([0.3, 3.0]) * mass, r)))


KINDS = {"bed": bed, "pressed_bed": pressed_bed, "stack": stack, "drum": drum, "press": press}


def program(args, folder):
    return subprocess.run([*args], capture_output=True, text=True, cwd=folder, check=False)


def stays_closed(epafi, scene, dt, folder):
    out = program([epafi, "run", scene, "-q", "--json", "--force", "-o", "out", "-t", "1", "--set",
                   f"run.time_step={dt:.6g}", "--set", "run.allow_unstable=true", "--set",
                   f"bounds.energy_error={OPEN}"], folder)
    if out.returncode not in (0, 1, 4):
        sys.exit(out.stderr)
    return out.returncode == 0


def bisect(epafi, scene, guess, folder):
    """Between a step that holds and one that does not, to 2 %: from half and twice the one stated."""
    low, high = 0.5 * guess, 2.0 * guess
    while not stays_closed(epafi, scene, low, folder):
        low, high = 0.5 * low, low
    while stays_closed(epafi, scene, high, folder):
        low, high = high, 2.0 * high
    while high > 1.02 * low:
        middle = (low * high) ** 0.5
        if stays_closed(epafi, scene, middle, folder):
            low = middle
        else:
            high = middle
    return (low * high) ** 0.5


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("epafi")
    parser.add_argument("--draws", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("kinds", nargs="*")
    args = parser.parse_intermixed_args()
    epafi = os.path.abspath(args.epafi)
    found = {}
    print(f"{'kind':12} draw   stated    found  quotient  drawn", flush=True)
    for kind in args.kinds or KINDS:
        for k in range(args.draws):
            rng = random.Random(f"{args.seed} {kind} {k}")
            draw = {"law": rng.choice(LAWS), "e": rng.choice([0.0, 0.1, 0.3, 0.5, 0.8, 0.95]),
                    "mu": rng.choice([0.0, 0.3, 0.6]), "r": 10 ** rng.uniform(-3, -1.5),
                    "modulus": 10 ** rng.uniform(5.5, 7)}
            with tempfile.TemporaryDirectory() as folder:
                with open(f"{folder}/s.toml", "w", encoding="utf-8") as file:
                    file.write(KINDS[kind](draw, rng))
                check = program([epafi, "check", "s.toml"], folder)
                if check.returncode != 0:
                    sys.exit(check.stderr + check.stdout)
                limit = float(re.search(r"its limit +(\S+) s", check.stdout)[1])
                best = bisect(epafi, "s.toml", limit, folder)
            found.setdefault(kind, []).append(limit / best)
            text = ", ".join(f"{a} {b:.3g}" if isinstance(b, float) else f"{a} {b}" for a, b in draw.items())
            print(f"{kind:12} {k:4} {limit:8.3g} {best:8.3g} {limit / best:9.2f}  {text}", flush=True)
    for kind, q in found.items():
        print(f"# {kind}: stated over found {min(q):.2f} to {max(q):.2f} in {len(q)} draws")


if __name__ == "__main__":
    main()
