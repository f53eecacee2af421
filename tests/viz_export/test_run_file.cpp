#include "viz_export/hdf5/run_file.h"

#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/stored_run.h"

using namespace epafi;
using Catch::Contains;

namespace {

const RunFileHeader run_header{"0.1.0", "00ff", "a title", "[run]\n", {"params.n=2"}};

/// Writes snapshots `from` .. `to` of a scene whose step k is at time 0.1 k; body 6 is added at step 3, body 2 leaves
/// at 4.
void run_steps(RunFile& file, SmallScene& scene, SurfaceCache& surfaces, std::uint64_t from, std::uint64_t to) {
  const std::size_t flow = file.define_measure("a/b", {"rate", "mass"});
  for (std::uint64_t k = from; k < to; ++k) {
    if (k == 3) scene.add_sphere();
    if (k == 4) scene.world.remove(std::vector<BodyId>{BodyId{2}});
    scene.world.time = 0.1 * static_cast<double>(k);
    scene.world.position[1].x() = static_cast<double>(k);
    file.add_measure(flow, scene.world.time, {static_cast<double>(k), 1.0 / 3.0});
    const auto records = body_records(scene.world, surfaces);  // written from records and one by one in turns
    file.add_snapshot({k, scene.world.time, state_hash(scene.world), true},
                      k % 2 == 0 ? BodyList(records) : BodyList(scene.world, surfaces));
  }
  file.flush();
}

void check_equal(const BodyRecord& a, const BodyRecord& b) {
  CHECK((a.id == b.id && a.shape == b.shape && a.material == b.material && a.mass == b.mass && a.radius == b.radius));
  CHECK((a.pose.position == b.pose.position && a.pose.orientation.coeffs() == b.pose.orientation.coeffs()));
  CHECK((a.velocity == b.velocity && a.angular_velocity == b.angular_velocity && a.kinetic_energy == b.kinetic_energy));
  CHECK((a.surface == nullptr) == (b.surface == nullptr));
  if (a.surface != nullptr && b.surface != nullptr) CHECK(a.surface->points == b.surface->points);
}

void check_equal(const StoredRun& a, const StoredRun& b) {
  REQUIRE(a.snapshots() == b.snapshots());
  for (std::size_t k = 0; k < a.snapshots(); ++k) {
    const StoredSnapshot p = a.snapshot(k), q = b.snapshot(k);
    CHECK((p.stamp.step == q.stamp.step && p.stamp.time == q.stamp.time && p.stamp.state_hash == q.stamp.state_hash));
    REQUIRE(p.bodies.size() == q.bodies.size());
    for (std::size_t i = 0; i < p.bodies.size(); ++i) check_equal(p.bodies[i], q.bodies[i]);
  }
  const auto m = a.measures(), n = b.measures();
  REQUIRE(m.size() == n.size());
  for (std::size_t i = 0; i < m.size(); ++i)
    CHECK((m[i].name == n[i].name && m[i].times == n[i].times && m[i].values == n[i].values));
}

}  // namespace

TEST_CASE("run.h5 gives back every snapshot and measure bit for bit", "[viz_export][run_file]") {
  const TemporaryFolder folder;
  SmallScene scene(5);
  SurfaceCache surfaces(scene.shapes);
  RunFile file(folder / "run.h5", run_header);
  run_steps(file, scene, surfaces, 0, 6);
  const StoredRun run(folder / "run.h5");
  REQUIRE(run.snapshots() == 6);
  CHECK(run.snapshot(0).bodies.size() == 6);
  CHECK(run.snapshot(3).bodies.size() == 7);
  const StoredSnapshot last = run.snapshot(5);
  const auto now = body_records(scene.world, surfaces);
  REQUIRE(last.bodies.size() == 6);
  REQUIRE(now.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) check_equal(last.bodies[i], now[i]);
  CHECK(last.stamp.state_hash == state_hash(scene.world));
  const auto measures = run.measures();
  REQUIRE(measures.size() == 1);
  CHECK((measures[0].name == "a/b" && measures[0].components == std::vector<std::string>{"rate", "mass"}));
  CHECK((measures[0].times.size() == 6 && measures[0].values[10] == 5.0 && measures[0].values[11] == 1.0 / 3.0));
}

TEST_CASE("a run continued from a checkpoint leaves the file of an uninterrupted run", "[viz_export][run_file]") {
  const TemporaryFolder folder;
  const auto checkpoint = GENERATE(0, 2, 3, 4);  // also before the body is added and before one leaves
  SmallScene straight_scene(5), scene(5);
  SurfaceCache straight_surfaces(straight_scene.shapes), surfaces(scene.shapes);
  RunFile straight(folder / "straight.h5", run_header);
  run_steps(straight, straight_scene, straight_surfaces, 0, 8);
  {
    RunFile file(folder / "run.h5", run_header);
    run_steps(file, scene, surfaces, 0, 6);
  }
  const auto step = static_cast<std::uint64_t>(checkpoint);
  SmallScene again(5);  // the state of the checkpoint
  SurfaceCache again_surfaces(again.shapes);
  RunFile unused(folder / "unused.h5", run_header);
  run_steps(unused, again, again_surfaces, 0, step + 1);
  RunFile file(folder / "run.h5", run_header, step, 0.1 * checkpoint);
  file.add_snapshot({step, 0.1 * checkpoint, "is there already", true}, std::vector<BodyRecord>{});
  run_steps(file, again, again_surfaces, step + 1, 8);
  check_equal(StoredRun(folder / "run.h5"), StoredRun(folder / "straight.h5"));
}

TEST_CASE("run files that are cut, of another scene or no run files are refused", "[viz_export][run_file]") {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  SmallScene scene(5);
  SurfaceCache surfaces(scene.shapes);
  {
    RunFile file(path, run_header);
    run_steps(file, scene, surfaces, 0, 3);
  }
  RunFileHeader other = run_header;
  other.scene_hash = "beef";
  CHECK_THROWS_WITH(RunFile(path, other, 1, 0.1), Contains("another scene"));
  const std::string good = read_whole_file(path);
  for (std::size_t size : {good.size() - 1, good.size() / 2, std::size_t{100}, std::size_t{0}}) {
    write_whole_file(path, {std::string_view(good).substr(0, size)});
    CHECK_THROWS_WITH(StoredRun(path), Contains(size > 0 ? "run.h5: is cut short" : "run.h5: is empty"));
  }
}

TEST_CASE("files of the format before are read, not continued; those of a later one are refused",
          "[viz_export][run_file]") {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  SmallScene scene(3);
  SurfaceCache surfaces(scene.shapes);
  {
    RunFile file(path, run_header);
    run_steps(file, scene, surfaces, 0, 2);
  }
  const auto set_format = [&](std::uint64_t format) {
    Hdf5File file(path, Hdf5File::Mode::append);
    file.set_attribute("/", "format", format);
    file.close();
  };
  CHECK(StoredRun(path).has_axes_of_the_scene());
  set_format(1);
  CHECK(StoredRun(path).snapshots() == 2);
  CHECK_FALSE(StoredRun(path).has_axes_of_the_scene());
  CHECK(damage_of(path).empty());
  CHECK_THROWS_WITH(RunFile(path, run_header, 1, 0.1), Contains("cannot continue it: it has run format 1"));
  set_format(3);
  CHECK_THROWS_WITH(StoredRun(path), Contains("has run format 3, this program reads 1 to 2"));
}
