#include "viz_export/output/export.h"

#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/run_file.h"
#include "viz_export/measures/measures_csv.h"
#include "viz_export/vtk/frame_writer.h"

using namespace epafi;

namespace {

/// A run that wrote frames and measures itself.
void make_run(const std::filesystem::path& folder) {
  SmallScene scene(4);
  SurfaceCache surfaces(scene.shapes);
  RunFile run(folder / "run.h5", {"0.1.0", "00ff", "t", "", {}});
  FrameWriter frames(folder);
  MeasuresCsv csv(folder / "measures.csv");
  const std::size_t a = run.define_measure("a", {"x", "y"}), b = run.define_measure("b", {"z"});
  for (std::uint64_t k = 0; k < 3; ++k) {
    const auto bodies = body_records(scene.world, surfaces);
    const double t = scene.world.time;
    run.add_measure(a, t, {t / 3, -t});
    run.add_measure(b, t, {1.0});
    csv.add(t, "a", "x", t / 3);
    csv.add(t, "a", "y", -t);
    csv.add(t, "b", "z", 1.0);
    run.add_snapshot({k, t, "", true}, bodies);
    frames.write(t, bodies, {});
    scene.move(0.125);
  }
}

}  // namespace

TEST_CASE("exported frames and measures are those that the run wrote itself, byte for byte", "[viz_export][export]") {
  const TemporaryFolder folder, copy;
  make_run(folder.path());
  std::filesystem::copy_file(folder / "run.h5", copy / "run.h5");
  CHECK(export_run(copy.path(), ExportFormat::vtk).snapshots == 3);
  CHECK(export_run(copy.path(), ExportFormat::csv).measures == 2);
  const std::string list = read_whole_file(folder / "frames.pvd");
  export_run(folder.path(), ExportFormat::vtk);  // contacts are those of the run: run.h5 holds none
  CHECK(read_whole_file(folder / "frames.pvd") == list);
  CHECK_FALSE(std::filesystem::exists(copy / "frames/contacts_000000.vtp"));
  for (const char* name : {"measures.csv", "frames/spheres_000002.vtp", "frames/walls_000000.vtp"})
    CHECK(read_whole_file(copy / name) == read_whole_file(folder / name));
  const std::string rows = read_whole_file(copy / "snapshots.csv");
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 1 + 3 * 5);
  // sphere 1 of the second snapshot: id 2, mass 2, radius 0.11, at (1.125, 2, 0.5) with velocity (1, 1, -1), spinning
  // by 1
  CHECK_THAT(rows, Catch::Contains("\n0.125,1,2,0,2,0.11,1.125,2,0.5,1,1,-1,1,0,0,0,0,0,1\n"));
  // the same sphere in the last snapshot, without the wall: a start for another scene
  const std::string bodies = read_whole_file(copy / "bodies.csv");
  CHECK_THAT(bodies, Catch::StartsWith("x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,radius\n"));
  CHECK(std::count(bodies.begin(), bodies.end(), '\n') == 1 + 4);
  CHECK_THAT(bodies, Catch::Contains("\n1.25,2,0.5,1,1,-1,1,0,0,0,0,0,1,0.11\n"));
}

TEST_CASE("export of a folder without a run is an error that names the file", "[viz_export][export]") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(export_run(folder.path(), ExportFormat::vtk), Catch::Contains("run.h5"));
}
