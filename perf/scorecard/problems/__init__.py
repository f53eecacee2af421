"""The problems: problems/NAME/problem.py holds title, kind, duration, bodies, exact answer with its derivation,
measure."""
import importlib.util
import os

ORDER = ["stack", "heavy", "arch", "cards", "pile", "stick", "slide", "rolling", "bounce", "cradle", "oblique", "bed",
         "hopper", "drum", "penetration", "mixing"]
HERE = os.path.dirname(os.path.abspath(__file__))


def load(name):
    spec = importlib.util.spec_from_file_location("problem_" + name, os.path.join(HERE, name, "problem.py"))
    problem = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(problem)
    problem.name = name
    extra = getattr(problem, "SETTINGS", {})
    problem.settings = lambda engine: extra.get(engine.name, engine.rows(problem.KIND))
    return problem


def all_problems():
    return [load(name) for name in ORDER]
