"""Opens what Epafi writes with VTK and h5py and compares with the formulas of small_scene.h and test_read_back.cpp.

usage: read_back.py TEST_VIZ_EXPORT   (the test program, which writes the sample); exit code 77: VTK or h5py is absent
"""
import csv
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

try:
    import h5py
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkCommand
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError as missing:
    print(f"skipped: {missing} (apt-get install python3-vtk9 python3-h5py)")
    sys.exit(77)

SPHERES = 1000
k = np.arange(SPHERES)
START = np.stack([k, 2.0 * k, np.full(SPHERES, 0.5)], axis=1)
VELOCITY = np.stack([np.ones(SPHERES), k, -np.ones(SPHERES)], axis=1)
KINETIC = 0.5 * (k + 1) * (VELOCITY**2).sum(axis=1) + 0.5 * 0.5 * k**2  # m v^2 / 2 + I w^2 / 2


def read(path):
    """PolyData of a file; any complaint of VTK is an error."""
    errors = []
    reader = vtkXMLPolyDataReader()
    reader.AddObserver(vtkCommand.ErrorEvent, lambda *_: errors.append(path))
    reader.SetFileName(path)
    assert reader.CanReadFile(path), path
    reader.Update()
    assert not errors, errors
    return reader.GetOutput()


def column(data, name):
    array = data.GetArray(name)
    assert array is not None, name
    return vtk_to_numpy(array)


def points(poly):
    return vtk_to_numpy(poly.GetPoints().GetData())


def same(found, expected, tolerance=0.0):
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=0)


def frames(folder):
    """{time: {part: path}} of frames.pvd"""
    out = {}
    for entry in ElementTree.parse(os.path.join(folder, "frames.pvd")).iter("DataSet"):
        path = os.path.join(folder, entry.get("file"))
        out.setdefault(float(entry.get("timestep")), {})[int(entry.get("part"))] = path
    return out


FLOAT = 6e-8  # half a unit in the last place of float32


def check_frames(folder):
    listed = frames(folder)
    assert sorted(listed) == [0.0, 0.5, 1.0], listed
    for time, parts in listed.items():
        spheres = read(parts[0])
        assert spheres.GetNumberOfPoints() == spheres.GetNumberOfVerts() == SPHERES
        same(points(spheres), START + [time, 0, 0], FLOAT)
        data = spheres.GetPointData()
        same(column(data, "id"), k + 1)
        same(column(data, "radius"), 0.1 + 0.01 * k, FLOAT)
        same(column(data, "velocity"), VELOCITY, FLOAT)
        same(column(data, "speed"), np.sqrt((VELOCITY**2).sum(axis=1)), FLOAT)
        same(column(data, "kinetic_energy"), KINETIC, 2 * FLOAT)
        same(column(data, "material"), 0 * k)
        same(column(spheres.GetFieldData(), "TimeValue"), [time])
        contacts = read(parts[2])
        assert contacts.GetNumberOfLines() == 2 and contacts.GetNumberOfPoints() == 4
        same(column(contacts.GetCellData(), "force_magnitude"), [7, 5])
        same(column(contacts.GetCellData(), "normal_force"), [7, 3])
        same(column(contacts.GetCellData(), "overlap"), [0.01, 0.03], FLOAT)
        floor = read(parts[3])
        assert floor.GetNumberOfPolys() == 1 and floor.GetNumberOfPoints() == 4
        same(points(floor)[:, 2], np.zeros(4))
        low, high = points(floor).min(axis=0), points(floor).max(axis=0)
        assert (low[:2] < START.min(axis=0)[:2]).all() and (high[:2] > START.max(axis=0)[:2]).all()
    assert len({parts[3] for parts in listed.values()}) == 1  # the floor does not move


def check_grids(folder, n=300):
    number = np.arange((n + 1) ** 2)
    expected = np.stack([number % (n + 1), number // (n + 1), 0 * number], axis=1)
    sizes = []
    for name in ("grid_plain.vtp", "grid_compressed.vtp"):
        path = os.path.join(folder, name)
        grid = read(path)
        same(points(grid), expected)
        assert grid.GetNumberOfPolys() == n * n
        same(column(grid.GetCellData(), "number"), np.arange(n * n))
        corner = np.arange(n * n) % n + np.arange(n * n) // n * (n + 1)
        ids = vtk_to_numpy(grid.GetPolys().GetConnectivityArray()).reshape(-1, 4)
        same(ids, np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1))
        sizes.append(os.path.getsize(path))
    assert sizes[1] < sizes[0] / 3, sizes  # measured: 0.27
    assert read(os.path.join(folder, "nothing.vtp")).GetNumberOfPoints() == 0


def check_run(folder):
    with h5py.File(os.path.join(folder, "run.h5"), "r") as run:
        assert run.attrs["title"].decode() == "Kies \u00b5"
        assert run["scene"][()].decode() == "[run]\nduration = 1\n"
        assert run["overrides"][()].decode().split("\n") == ["a=1", "b=2"]
        assert sorted(run["snapshots"]) == ["000000", "000001", "000002"]
        same(run["bodies/radius"][1:], 0.1 + 0.01 * k, 1e-15)
        same(run["bodies/mass"][1:], k + 1, 1e-15)  # 1 / (1 / m)
        assert run["bodies/surface"][0] == 0 and (run["bodies/surface"][1:] == -1).all()
        assert run["shapes/000000/points"].shape == (4, 3)
        for s, snapshot in enumerate(run["snapshots"].values()):
            assert snapshot.attrs["time"] == 0.5 * s and snapshot.attrs["step"] == s
            assert len(snapshot.attrs["state_hash"]) == 16
            same(snapshot["id"], np.arange(SPHERES + 1))
            same(snapshot["position"][1:], START + [0.5 * s, 0, 0])
            same(snapshot["velocity"][1:], VELOCITY)
            same(snapshot["orientation"][:], np.tile([1.0, 0, 0, 0], (SPHERES + 1, 1)))
            same(snapshot["angular_velocity"][1:, 2], k)
            same(snapshot["kinetic_energy"][1:], KINETIC, 1e-14)
        position = run["measures/position"]
        assert position.attrs["components"].decode() == "sum,count"
        same(position["time"], [0, 0.5, 1])
        same(position["value"][:, 0], k.sum() + 0.5 * SPHERES * np.arange(3))
    with open(os.path.join(folder, "measures.csv"), newline="") as rows:
        table = list(csv.DictReader(rows))
    assert [r["component"] for r in table] == ["sum", "count"] * 3
    assert [float(r["value"]) for r in table][::2] == list(k.sum() + 0.5 * SPHERES * np.arange(3))


with tempfile.TemporaryDirectory() as sample:
    environment = dict(os.environ, EPAFI_SAMPLE_FOLDER=sample)
    subprocess.run([sys.argv[1], "[sample]"], check=True, env=environment, stdout=subprocess.DEVNULL)
    check_frames(sample)
    check_grids(sample)
    check_run(sample)
print("VTK and h5py read what was written")
