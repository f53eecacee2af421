"""Engines of the scorecard: engines/NAME.toml says what an engine is, how its driver is built and which settings it
gets."""
import glob
import os
import shutil
import subprocess
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDER = os.path.join(HERE, "engines")
ROOT = os.path.dirname(os.path.dirname(HERE))


class Engine:
    def __init__(self, file):
        defaults = dict(packages=[], npm=[], flags=[], libraries=[], prefix="", always="", left_out={}, version="?")
        with open(file, "rb") as f:
            self.__dict__.update(defaults, **tomllib.load(f))
        self.stem = os.path.splitext(os.path.basename(file))[0]
        self.command = None  # of the driver, once there is one

    def rows(self, kind):
        """Settings for a kind of problem, the default first; none where the engine is left out."""
        return self.settings.get(kind, [])

    def why_not(self, problem):
        """The reason for which it has no row on a problem, or None."""
        own = self.left_out.get(problem.name) or self.left_out.get(problem.KIND)
        return own or (None if problem.settings(self) else self.left_out.get("all") or getattr(problem, "OTHERS", None))

    def arguments(self, setting):
        """Of a setting: the time step (0: the engine's own) and the options as the driver takes them."""
        words = (setting + " " + self.always).split()
        dt = next((w[3:] for w in words if w.startswith("dt=")), "0")
        over = dt.split("/")
        step = float(over[0]) / (float(over[1]) if len(over) > 1 else 1.0)
        options = [w if "." in w.split("=")[0] else self.prefix + w for w in words if not w.startswith("dt=")]
        return step, options


def all_engines():
    """In the order of the pages: Epafi first."""
    found = [Engine(f) for f in sorted(glob.glob(os.path.join(FOLDER, "*.toml")))]
    return sorted(found, key=lambda e: (not e.name.startswith("Epafi"), e.name))


def build_epafi(build, as_built, target="perf_scorecard_epafi"):
    if not as_built:
        subprocess.run(["ninja", "-C", build, target], check=True, stdout=subprocess.DEVNULL)
    return [os.path.join(build, "perf", target)]


def compile_driver(source, flags, libraries, program, as_built):
    """Against the installed engine, unless the program is newer than its sources."""
    if as_built and os.path.exists(program):
        return [program]
    sources = [os.path.join(FOLDER, source), os.path.join(FOLDER, "driver.h")]
    if not os.path.exists(program) or os.path.getmtime(program) < max(map(os.path.getmtime, sources)):
        subprocess.run(["g++", "-O2", "-std=c++17", *flags, sources[0], "-o", program, *libraries], check=True)
    return [program]


def make_driver(engine, build, work, as_built):
    """Sets engine.command and engine.version, or returns why there is none."""
    kind = os.path.splitext(engine.source)[1]
    if engine.stem.startswith("epafi"):
        engine.command = build_epafi(build, as_built)
        described = subprocess.run(["git", "-C", ROOT, "describe", "--always"], capture_output=True,
                                   text=True).stdout.strip()
        engine.version = described or "?"
        return None
    missing = [p for p in engine.packages if not installed(p)]
    if missing:
        return "not installed: " + " ".join(missing)
    if kind == ".mjs":
        for name in engine.npm:
            if not os.path.isdir(os.path.join(work, "node_modules", name.rsplit("@", 1)[0])):
                return "not installed: npm " + name
        if not shutil.which("node"):
            return "not installed: node"
        if hasattr(engine, "helper"):
            compile_driver(engine.helper, engine.helper_flags, [], os.path.join(work, engine.stem + "_describe"),
                           as_built)
        # without --no-liftoff V8's quick tier of WebAssembly is in the times: Rapier looks eight times too dear
        engine.command = ["node", "--no-liftoff", os.path.join(FOLDER, engine.source)]
        engine.version = ", ".join(engine.npm)
        return None
    engine.version = package_version(engine.packages[0])
    if kind == ".py":
        engine.command = ["/usr/bin/python3", os.path.join(FOLDER, engine.source)]
    else:
        engine.command = compile_driver(engine.source, engine.flags, engine.libraries, os.path.join(work, engine.stem),
                                        as_built)
    return None


def package_version(package):
    shown = subprocess.run(["dpkg-query", "-W", "-f", "${Status}|${Version}", package], capture_output=True,
                           text=True).stdout
    return shown.split("|")[1] if shown.startswith("install ok installed") else None


def installed(package):
    return package_version(package) is not None


def install(engines, work):
    """What is missing: Debian packages where we are root or may be, npm packages where the registry answers."""
    packages = sorted({p for e in engines for p in e.packages if not installed(p)})
    if packages:
        command = ([] if os.geteuid() == 0 else ["sudo", "-n"]) + ["apt-get", "install", "-y",
                                                                   "--no-install-recommends", *packages]
        if subprocess.run(command, stdout=subprocess.DEVNULL).returncode != 0:
            print("could not be installed, left out: " + " ".join(packages))
    names = [n for e in engines for n in e.npm
             if not os.path.isdir(os.path.join(work, "node_modules", n.rsplit("@", 1)[0]))]
    if names and shutil.which("npm"):
        if subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--prefix", work, *names],
                          stdout=subprocess.DEVNULL).returncode != 0:
            print("could not be installed, left out: npm " + " ".join(names))
