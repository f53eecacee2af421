"""The Python module against the program: same hash, same measures, arrays that are the engine's own memory."""
import json
import subprocess
import sys
import tempfile

import numpy as np

import epafi

program, library = sys.argv[1:3]


def check(condition, what):
    if not condition:
        sys.exit("failed: " + what)


def program_summary(scene, steps, overrides):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", scene, "--steps", str(steps), "-q", "--json", "-o", folder + "/out"]
        for o in overrides:
            command += ["--set", o]
        return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


# the same scene by both ways
scene, overrides = library + "/hopper/hopper.toml", ["params.n=300"]
run = epafi.load(scene, overrides)
check(run.steps == 0 and run.time == 0.0, "a new run is at time 0")
position = run.position
check(position.shape == (302, 3) and position.dtype == np.float64, "one row per body")
before = position.copy()
run.step(1500)  # bodies are sorted after 1000
summary = program_summary(scene, 1500, overrides)
check(run.state_hash == summary["state_hash"], "the state hash of the program")
check(run.measures()["outflow"]["mass"]["last"] == summary["measures"]["outflow"]["mass"]["last"],
      "the program's measure")
check(abs(run.energy()["kinetic"] - summary["energy"]["kinetic"]) == 0.0, "the program's kinetic energy")
check(np.shares_memory(position, run.position), "the view taken at the start is still the column")
check(not np.array_equal(position, before), "and it has moved along")
check(not position.flags.writeable, "positions are read-only")
falling = run.inverse_mass > 0
check(np.all(run.id[falling] >= 2), "walls were named first")
slot = run.slot
check(np.array_equal(run.id[slot[slot >= 0]], np.flatnonzero(slot >= 0)), "position[slot] is in the order of the scene")
momentum = (run.velocity[falling] / run.inverse_mass[falling, None]).sum(axis=0)
kinetic = 0.5 * ((run.velocity[falling] ** 2).sum(axis=1) / run.inverse_mass[falling]).sum()
check(0 < kinetic <= run.energy()["kinetic"], "translation is a part of the kinetic energy")
check(np.isfinite(momentum).all(), "momentum is finite")

# contacts: those of the loop over spheres too, and together what the bodies feel
bed = epafi.load(library + "/bed/bed.toml", ["params.n=300"])
bed.step(7000)
bodies, gap, normal, force = bed.contact_bodies, bed.contact_gap, bed.contact_normal, bed.contact_force
check(bodies.shape == (len(gap), 2) and normal.shape == force.shape == (len(gap), 3), "one row per contact")
touching = gap < 0
check(touching.sum() > 500, "300 spheres at rest touch each other")
check(np.all(np.einsum("ij,ij->i", force, normal)[touching] <= 0), "contacts push")
felt = np.zeros((bed.id.max() + 1, 3))
np.add.at(felt, bodies[:, 0], force)
np.add.at(felt, bodies[:, 1], -force)
moves = bed.inverse_mass > 0
check(np.allclose(felt[bed.id[moves]], bed.force[moves], rtol=0, atol=1e-12 * np.abs(bed.force).max()),
      "forces of contacts are those of the bodies")
kept = gap.copy()
bed.step(500)
check(np.array_equal(gap, kept), "arrays of contacts stay as they were")

# a scene built from Python: free fall from rest, then a kick
drop = epafi.build({
    "run": {"duration": 1.0, "time_step": 1e-3}, "world": {"gravity": [0, 0, -9.81]},
    "material": {"m": {"density": 1000.0, "youngs_modulus": "1 MPa", "poissons_ratio": 0.3}},
    "contact": {"method": "smooth", "restitution": 0.5, "friction": 0.0, "smooth": {"law": "hertz"}},
    "body": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "material": "m",
              "position": list(np.array([0, 0, 5.0]))}],
})
drop.step(500)
check(abs(drop.position[0, 2] - (5.0 - 0.5 * 9.81 * 0.25)) < 1e-12, "free fall is exact for velocity Verlet")
drop.velocity[0] = [1.0, 0.0, 0.0]
drop.step(100)
check(abs(drop.position[0, 0] - 0.1) < 1e-12, "a velocity written from Python is taken")

# what is wrong is an exception with the program's text
for wrong, kind, text in [(lambda: epafi.load(library + "/none.toml"), (ValueError, OSError), "does not exist"),
                          (lambda: epafi.build({"run": {"duration": -1.0}}), ValueError, "outside"),
                          (lambda: epafi.build({"run": {"duraton": 1.0}}), ValueError, "did you mean"),
                          (lambda: epafi.build({"run": {"duration": object()}}), TypeError, "a scene is made of")]:
    try:
        wrong()
        sys.exit("failed: no exception for " + text)
    except kind as error:
        check(text in str(error), text + " in " + str(error))
print("the module agrees with the program: 1500 steps,", run.state_hash)
