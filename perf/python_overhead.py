#!/usr/bin/env python3
"""What stepping from Python costs beside the program: 1000 spheres, 1000 steps, one array looked at after every step.
   PYTHONPATH=build/python /usr/bin/python3 perf/python_overhead.py build/bin/epafi
Processor time on one thread, alternating, the least of several runs of each; the hash shows that both did the same
work."""
import json
import subprocess
import sys
import tempfile
import time

import epafi

SCENE, STEPS, SETS = "scenes/library/bed/bed.toml", 1000, ["params.n=1000"]
epafi.set_threads(1)


def by_python(look):
    run = epafi.load(SCENE, SETS)
    position = run.position  # a view of the engine's column: it moves along, nothing is copied
    start = time.process_time()
    for _ in range(STEPS):
        run.step()
        look(position)
    return time.process_time() - start, run.state_hash


def by_program():
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.argv[1], "run", SCENE, "--steps", str(STEPS), "-t", "1", "-q", "--json", "--least-output", "-o",
                   folder + "/o"]
        for s in SETS:
            command += ["--set", s]
        s = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        return s["cpu_time"], s["state_hash"]


views, minima, program = [], [], []
for k in range(7):
    runs = by_python(lambda x: x[0, 2]), by_python(lambda x: x[:, 2].min()), by_program()
    assert len({r[1] for r in runs}) == 1, "different states"
    for times, r in zip((views, minima, program), runs):
        times.append(r[0])
array = epafi.load(SCENE, SETS).position
start = time.process_time()
for _ in range(STEPS):
    array[:, 2].min()
numpy_alone = time.process_time() - start
print("processor time of %d steps of 1000 bodies: program %.4f s; Python, one height read from a view after every step "
      "%.4f s (%+.2f %%); "
      "the smallest of all %.4f s (%+.2f %%, of which NumPy alone takes %.4f s, %+.2f %%); state %s" %
      (STEPS, min(program), min(views), 100 * (min(views) / min(program) - 1), min(minima),
       100 * (min(minima) / min(program) - 1), numpy_alone, 100 * numpy_alone / min(program), runs[0][1]))
