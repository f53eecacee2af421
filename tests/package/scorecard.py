#!/usr/bin/env python3
"""Tests of perf/scorecard.  scorecard.py read: bodies, measures and pages, without any engine.
scorecard.py run BUILD: Epafi's rows and, where ODE is installed, one peer's on two short problems."""
import csv
import math
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "perf", "scorecard"))
from engines import FOLDER, all_engines
from pages import pages
from problems import ORDER, load
from table import front, good, read, standing

TABLE = os.path.join(ROOT, "docs", "scorecard", "scorecard.csv")
G = 9.81
NUMBERS = ("none one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "
           "seventeen eighteen "
           "nineteen twenty").split()


def tetrahedra(shape):
    """Volume, centre and second moments of a hull, by the tetrahedra between its triangles and its origin."""
    volume, first, second = 0.0, [0.0] * 3, [[0.0] * 3 for _ in range(3)]
    for face in shape[2]:
        a, b, c = (shape[1][k] for k in face)
        v = sum(a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]) for i in range(3)) / 6
        assert v > 0, "a triangle that faces inwards"
        volume += v
        total = [a[i] + b[i] + c[i] for i in range(3)]
        for i in range(3):
            first[i] += v * total[i] / 4
            for j in range(3):
                second[i][j] += v * (total[i] * total[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]) / 20
    return volume, first, second


def check_hulls():
    """Mass, centre and moments of arch and card house are those of their corners; the frames are principal axes."""
    for name in ("arch", "cards"):
        for body in load(name).scene().bodies:
            if body.shape[0] != "hull":
                continue
            volume, first, second = tetrahedra(body.shape)
            density = body.mass / volume
            size = volume ** (1 / 3)
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                assert abs(first[i]) < 1e-12 * volume * size
                assert abs(second[i][j]) < 1e-12 * volume * size**2, "no principal axes"
                moment = density * (second[j][j] + second[k][k])
                assert abs(moment / body.inertia[i] - 1) < 1e-9, (name, moment, body.inertia)


def error_of(name, motion, samples, **parts):
    """A measure's errors on a motion given in closed form: motion(t) lists the 13 numbers of each body."""
    problem = load(name)
    times = [problem.DURATION * k / samples for k in range(samples + 1)]
    found = problem.measure(times, [motion(t) for t in times], problem.scene())
    return {part: error for part, (error, status) in found.items()}


def state(body, position=None, velocity=(0, 0, 0), spin=(0, 0, 0)):
    return [*(position or body.position), *body.turn, *velocity, *spin]


def check_measures():
    """Exact motions have no error, and wrong ones the error that their formula gives."""
    for name in ("stack", "heavy", "arch", "cards", "stick"):
        bodies = load(name).scene().bodies
        assert error_of(name, lambda t: [state(b) for b in bodies], 10) == {"": 0.0}
    slide = load("slide")
    box, azimuth = slide.scene().bodies[0], slide.stick.AZIMUTH
    along = G * (math.sin(slide.ANGLE) - slide.stick.FRICTION * math.cos(slide.ANGLE))

    def slides(t, share):
        way = share * along * t * t / 2
        return [state(box, (way * math.cos(azimuth), way * math.sin(azimuth), 0.25))]

    assert error_of("slide", lambda t: slides(t, 1.0), 10)[""] < 1e-12
    assert abs(error_of("slide", lambda t: slides(t, 0.0), 10)[""] - 1) < 1e-12
    assert abs(error_of("stick", lambda t: slides(t, 1.0), 10)[""] - along * 1.5) < 1e-12  # (2^2 - 1^2)/2 over 1 s

    def rolls(t, v0=2.0, r=0.05, mu=0.2):
        t_roll = 2 * v0 / (7 * mu * G)
        v = v0 - mu * G * min(t, t_roll)
        return [state(load("rolling").scene().bodies[0], velocity=(v, 0, 0),
                      spin=(0, 2.5 * mu * G * min(t, t_roll) / r, 0))]

    found = error_of("rolling", rolls, 1000)
    assert found["speed"] < 1e-12 and found["onset"] < 1e-12, found
    sphere = load("bounce").scene().bodies[0]

    def bounces(t, e=0.8):
        fall = math.sqrt(2 / G)
        start, speed = -fall, G * fall  # the flight that began below, at the speed of its landing
        while t >= start + 2 * speed / G:
            start += 2 * speed / G
            speed *= e
        since = t - start
        return [state(sphere, (0, 0, 0.5 + speed * since - G * since**2 / 2), (0, 0, speed - G * since))]

    assert error_of("bounce", bounces, 3200)[""] < 1e-9
    assert abs(error_of("bounce", lambda t: bounces(t, 0.79), 3200)[""] - (1 - (0.79 / 0.8) ** 10)) < 1e-9
    balls = load("cradle").scene().bodies
    for speeds, error in (((0, 0, 0, 0, 1), 0.0), ((-0.6, 0.4, 0.4, 0.4, 0.4), math.sqrt(0.24))):
        moving = [state(b, velocity=(3 * v, 0, 0)) for b, v in zip(balls, speeds)]
        assert abs(error_of("cradle", lambda t: moving, 10)[""] - error) < 1e-12


def check_engines():
    """Every engine has a row or a reason for every problem, and an answer to one; no driver hides a package that it
    opens."""
    answers = {r["engine"] for r in read(TABLE) if good(r)}
    for engine in all_engines():
        assert os.path.exists(os.path.join(ROOT, "perf", "scorecard", "engines", engine.source)), engine.name
        assert engine.name in answers, engine.name + " has failed everywhere"
        with open(os.path.join(FOLDER, engine.source)) as file:
            opened = re.findall(r"^(?:import|from) (\w+)", file.read(), re.MULTILINE)
        assert os.path.splitext(engine.source)[0] not in opened, engine.source + " hides the package that it opens"
        for problem in map(load, ORDER):
            assert problem.settings(engine) or engine.why_not(problem), (engine.name, problem.name)


def check_pages():
    """The pages say what the table says; the front is what its definition asks."""
    table = read(TABLE)
    assert table, "no table"
    for file, text in pages(table, os.path.dirname(TABLE)).items():
        with open(os.path.join(ROOT, "docs", "scorecard", file)) as f:
            assert f.read() == text, file + " is not what `run.py --pages` writes"
    verdicts = [line.split("|")[-2].strip() for line in pages(table, os.path.dirname(TABLE))["README.md"].splitlines()
                if "](" in line and ".md)" in line and line[0] == "|"]
    with open(os.path.join(ROOT, "README.md")) as f:
        claim = re.search(r"In (\w+) of (\w+) such tables", f.read())
    assert claim.groups() == (NUMBERS[verdicts.count("yes")], NUMBERS[len(verdicts)]), verdicts
    for name in {(r["problem"], r["measure"]) for r in table if r["error"]}:
        rows = [r for r in table if (r["problem"], r["measure"]) == name]
        best = front(rows)
        for r in filter(good, rows):
            beaten = any(float(b["seconds"]) <= float(r["seconds"])
                         and float(b["error"]) <= max(float(r["error"]), 1e-12) for b in best)
            assert beaten or r in best, r


def check_arguments():
    """What is no engine, problem, duration or number is refused with what is."""
    for words, said in ((["--engine", "Nobody"], "there is no engine 'Nobody'; there are Epafi"),
                        (["--problem", "none"], "there are stack, heavy"),
                        (["--budget", "foo"], "write 90s"), (["--turns", "0"], "no number from 1 on"),
                        (["--limit", "-1"], "no number from 1 on"),
                        (["--table", "nowhere/t.csv"], "there is no '")):
        ran = subprocess.run([sys.executable, os.path.join(ROOT, "perf", "scorecard", "run.py"), "--no-install",
                              "--as-built", *words],
                             capture_output=True, text=True)
        assert ran.returncode != 0 and said in ran.stderr and "Traceback" not in ran.stderr, (words, ran.stderr)


def check_rows():
    """Rows for a chart of one's own: the columns that `epafi chart --with` asks for, each answer of the first measure
    once."""
    ran = subprocess.run([sys.executable, os.path.join(ROOT, "perf", "scorecard", "run.py"), "--rows", "rolling"],
                         capture_output=True, text=True, check=True)
    rows = list(csv.DictReader(ran.stdout.splitlines()))
    wanted = [r for r in read(TABLE) if r["problem"] == "rolling" and r["measure"] == "speed" and good(r)]
    assert [(float(r["time"]), float(r["error"])) for r in rows] == [(float(r["seconds"]), float(r["error"]))
                                                                     for r in wanted], ran.stdout
    assert len({r["method"] for r in rows}) == len(rows), "two rows of one name"


def check_run(build):
    """Newton's method holds 1:1000 and the incline; ODE, whose pyramid is around the cone, does not let the box
    slide."""
    with tempfile.TemporaryDirectory() as folder:
        table = os.path.join(folder, "rows.csv")
        subprocess.run([sys.executable, os.path.join(ROOT, "perf", "scorecard", "run.py"), "--no-install", "--engine",
                        "Epafi", "ODE", "--problem",
                        "slide", "heavy", "--turns", "1", "--limit", "20", "--build", build, "--table", table],
                        check=True)
        with open(table) as file:
            rows = list(csv.DictReader(file))
    ours = [r for r in rows if r["engine"] == "Epafi" and "newton" in r["settings"]]
    assert len(ours) == 4, rows
    assert all(r["status"] == "ok" and float(r["error"]) < 1e-6 and float(r["seconds"]) > 0 for r in ours), ours
    theirs = [r for r in rows if r["engine"] == "ODE" and r["problem"] == "slide" and r["default"] == "yes"]
    assert all(float(r["error"]) > 0.5 for r in theirs), theirs
    print("%d rows, %d of them of ODE" % (len(rows), sum(r["engine"] == "ODE" for r in rows)))


if sys.argv[1] == "read":
    check_hulls()
    check_measures()
    check_engines()
    check_arguments()
    check_rows()
    check_pages()
else:
    check_run(os.path.abspath(sys.argv[2]))
