// What a run wrote is read back whole: sizes, shapes, materials, groups, axes; and goes on with the energies it had.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "engine/state/world.h"
#include "engine/step/contact_pieces.h"
#include "scenes/full_registry.h"
#include "scenes/last_state.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/output/export.h"

using namespace epafi;

namespace {

const std::string state_head = R"(run = { duration = 0.04, time_step = 1e-5, output_interval = 0.02 }
world = { gravity = [0, 0, -9.81] }
material.stone = { density = 2500.0, youngs_modulus = "1 MPa", poissons_ratio = 0.3 }
material.wood = { density = 700.0, youngs_modulus = "1 MPa", poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.7, friction = 0.0, smooth = { law = "linear", stiffness = 50.0 } }
shape.clump = { clump = { spheres = [["-1.5 mm", 0, 0, "2 mm"], ["1.5 mm", "0.3 mm", 0, "2 mm"]] } }
shape.hull = { polyhedron = { random = { vertices = 16, seed = 3 } }, scale_to_diameter = 0.005 }
shape.ball = { sphere = { radius = 0.001 } }
shape.brick = { box = { size = [0.002, 0.001, 0.0015] } }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "stone"
fixed = true
)";

const std::string state_bodies = R"(
[[fill]]
name = "clumps"
shape = "clump"
material = "stone"
size = { distribution = "table", values = [0.71, 1.0, 1.41], shares = [25, 50, 25], by = "mass" }
count = 30
region = { box = { min = [0, 0, 0], max = [0.05, 0.05, 0.03] } }
[[fill]]
name = "hulls"
shape = "hull"
material = "wood"
size = { distribution = "uniform", min = 0.8, max = 1.1 }
count = 30
region = { box = { min = [0.05, 0, 0], max = [0.08, 0.03, 0.03] } }
[[fill]]
name = "balls"
shape = "ball"
material = "wood"
size = { distribution = "uniform", min = 0.5, max = 1.0 }
method = "pour"
rate = 5000
count = 40
region = { box = { min = [0, 0.05, 0], max = [0.02, 0.07, 0.02] } }
[[fill]]
name = "more"
shape = "brick"
material = "stone"
method = "pour"
rate = 5000
count = 40
region = { box = { min = [0.02, 0.05, 0], max = [0.04, 0.07, 0.02] } }
)";

std::unique_ptr<Assembly> assembled(const std::string& text, const std::filesystem::path& folder) {
  ReadResult read = read_scene_text(text, (folder / "scene.toml").string(), {}, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  return assemble(std::move(*read.scene));
}

/// Of a scene that stands in a file: what a checkpoint goes on with.
std::unique_ptr<Assembly> assembled_from_file(const std::filesystem::path& folder) {
  const std::string path = (folder / "scene.toml").string();
  std::ofstream(path) << state_head + state_bodies;
  ReadResult read = read_scene(path, {}, full_registry());
  REQUIRE(read.scene);
  return assemble(std::move(*read.scene));
}

}  // namespace

TEST_CASE("a state that was exported goes on with the bodies and energies it had", "[scenes][export]") {
  const TemporaryFolder folder;
  Session run(assembled(state_head + state_bodies, folder.path()), {}, folder / "out");
  REQUIRE(run.run({}, true) == Ending::completed);
  export_run(folder / "out", ExportFormat::csv);
  const std::string header = read_whole_file(folder / "out/bodies.csv").substr(0, 75);
  CHECK_THAT(header, Catch::StartsWith("x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,radius,shape,size,material,group\n"));
  auto again = assembled(state_head + "[[bodies]]\nfile = \"out/bodies.csv\"\n", folder.path());
  again->simulation->start();
  const World &was = run.assembly().simulation->world, &is = again->simulation->world;
  REQUIRE(is.size() == was.size());
  CHECK(was.size() == 141);
  for (std::uint32_t id = 0; id < was.ids_given(); ++id) {  // those of pours came late and have low ids
    const Slot s = was.slot_of(static_cast<BodyId>(id)), t = is.slot_of(static_cast<BodyId>(id));
    REQUIRE(is.position[t] == was.position[s]);
    REQUIRE(is.material[t] == was.material[s]);
    if (!was.is_movable(s)) continue;
    REQUIRE(is.velocity[t] == was.velocity[s]);
    REQUIRE(is.inverse_mass[t] == Approx(was.inverse_mass[s]).epsilon(1e-12));
    REQUIRE((is.angular_velocity[t] - was.angular_velocity[s]).norm() <= 1e-9 * was.angular_velocity[s].norm());
    const Aabb a = run.assembly().shapes->bounding_box(was, s), b = again->shapes->bounding_box(is, t);
    REQUIRE((a.min - b.min).norm() + (a.max - b.max).norm() < 1e-15);
  }
  const Energy before = run.assembly().simulation->ledger.measure(was), after = again->simulation->ledger.measure(is);
  CHECK(after.kinetic == Approx(before.kinetic).epsilon(1e-10));
  CHECK(after.potential == Approx(before.potential).epsilon(1e-10));
  CHECK(before.elastic > 0.0);
  CHECK(after.elastic == Approx(before.elastic).epsilon(1e-6));
  CHECK(again->scene.groups.size() == 5);
  CHECK(again->scene.groups[4].name == "more");
}

TEST_CASE("bodies come from the last snapshot of a run.h5 as from bodies.csv", "[scenes][bodies]") {
  const TemporaryFolder folder;
  Session run(assembled(state_head + state_bodies, folder.path()), {}, folder / "out");
  REQUIRE(run.run({}, true) == Ending::completed);
  export_run(folder / "out", ExportFormat::csv);
  std::vector<std::unique_ptr<Assembly>> read;
  for (const char* file : {"out/bodies.csv", "out/run.h5"})
    read.push_back(assembled(state_head + fmt::format("[[bodies]]\nfile = \"{}\"\n", file), folder.path()));
  CHECK(state_hash(read[0]->simulation->world) == state_hash(read[1]->simulation->world));
}

TEST_CASE("bodies come from the columns of an HDF5 file", "[scenes][bodies]") {
  const TemporaryFolder folder;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const std::size_t n : {1u, 7u, 300u}) {
    std::vector<double> position(3 * n), radius(n), vx(n), zero(n);
    for (double& value : position) value = any(random);
    for (double& value : radius) value = 1e-3 * (1.5 + any(random));
    for (std::size_t k = 0; k < n; ++k) vx[k] = any(random);
    {
      Hdf5File file(folder / "own.h5", Hdf5File::Mode::create);
      file.write<double>("position", position, {.columns = 3});
      file.write<double>("radius", radius);
      file.write<double>("vx", vx);
      file.write<double>("vy", zero);
      file.write<double>("vz", zero);
    }
    const auto made = assembled(state_head + "[[bodies]]\nfile = \"own.h5\"\nmaterial = \"stone\"\n", folder.path());
    const World& world = made->simulation->world;
    REQUIRE(world.size() == n + 1);  // and the floor
    for (std::size_t k = 0; k < n; ++k) {
      const Slot s = world.slot_of(static_cast<BodyId>(k + 1));
      CHECK(world.position[s] == Vec3(position[3 * k], position[3 * k + 1], position[3 * k + 2]));
      CHECK(world.velocity[s] == Vec3(vx[k], 0, 0));
      CHECK(made->shapes->bounding_radius({world.shape[s]}) == Approx(radius[k]).epsilon(1e-12));
    }
  }
}

TEST_CASE("an HDF5 file without columns of bodies is refused by name", "[scenes][bodies]") {
  const TemporaryFolder folder;
  const auto problem_of = [&](const std::string& text) {
    const ReadResult read = read_scene_text(text, (folder.path() / "scene.toml").string(), {}, full_registry());
    REQUIRE(!read.problems.empty());
    return read.problems[0].to_string();
  };
  const std::string scene = state_head + "[[bodies]]\nfile = \"own.h5\"\nmaterial = \"stone\"\n";
  std::ofstream(folder.path() / "own.h5") << "no HDF5";
  CHECK_THAT(problem_of(scene), Catch::Contains("own.h5"));
  Hdf5File(folder / "own.h5", Hdf5File::Mode::create).make_group("states");
  CHECK_THAT(problem_of(scene), Catch::Contains("no datasets of numbers"));
  {
    Hdf5File file(folder / "own.h5", Hdf5File::Mode::create);
    file.write<double>("x", std::vector<double>(3));
    file.write<double>("y", std::vector<double>(4));
  }
  CHECK_THAT(problem_of(scene), Catch::Contains("'y' has 4 values, 'x' 3"));
}

TEST_CASE("bodies of a run that was stopped are those of where it stopped", "[scenes][export]") {
  for (const std::uint64_t steps : {2100u, 2737u, 3999u}) {
    INFO("after " << steps << " steps, snapshots after 0 and 2000");
    const TemporaryFolder folder;
    Session run(assembled_from_file(folder.path()), {}, folder / "out");
    REQUIRE(run.run({.steps = steps}, true) == Ending::until);
    const LastState last = last_state(folder / "out");
    CHECK_THAT(last.note, Catch::StartsWith("bodies.csv is of 0.0") && Catch::Contains("last snapshot is of 0.02 s"));
    export_run(folder / "out", ExportFormat::csv, last.bodies);
    auto again = assembled(state_head + "[[bodies]]\nfile = \"out/bodies.csv\"\n", folder.path());
    const World &was = run.assembly().simulation->world, &is = again->simulation->world;
    REQUIRE(is.size() == was.size());
    for (std::uint32_t id = 0; id < was.ids_given(); ++id) {
      const Slot s = was.slot_of(static_cast<BodyId>(id)), t = is.slot_of(static_cast<BodyId>(id));
      REQUIRE(is.position[t] == was.position[s]);
    }
  }
}

TEST_CASE("of a run that is done or was stopped before its bodies came the last snapshot stays", "[scenes][export]") {
  for (const std::uint64_t steps : {50u, 4000u}) {
    const TemporaryFolder folder;
    Session run(assembled_from_file(folder.path()), {}, folder / "out");
    run.run({.steps = steps}, true);
    const LastState last = last_state(folder / "out");
    CHECK(last.bodies.empty());
    if (steps == 50u) CHECK_THAT(last.note, Catch::Contains("not of the state where the run stopped"));
    if (steps == 4000u) CHECK(last.note.empty());
  }
}

TEST_CASE("every body that ever came has its row in run.h5, the axes are those of the scene", "[scenes][export]") {
  const TemporaryFolder folder;
  Session run(assembled(state_head + state_bodies, folder.path()), {}, folder / "out");
  REQUIRE(run.run({std::nullopt, 500, std::nullopt}, true) == Ending::until);
  auto more = Session::resume(assembled(state_head + state_bodies, folder.path()), {}, folder / "out");
  REQUIRE(more->run({}, true) == Ending::completed);
  const StoredRun stored(folder / "out/run.h5");
  const World& w = more->assembly().simulation->world;
  const StoredSnapshot last = stored.snapshot(stored.snapshots() - 1);
  REQUIRE(last.bodies.size() == w.size());
  for (const BodyRecord& b : last.bodies) {
    const Slot s = w.slot_of(static_cast<BodyId>(b.id));
    if (!w.is_movable(s)) continue;
    CHECK(b.mass == Approx(1.0 / w.inverse_mass[s]).epsilon(1e-14));
    CHECK(b.radius > 0.0);
    CHECK(stored.words(b).group != "");
    if (b.surface == nullptr) continue;
    // corners in the axes of the file, turned as the file says, lie in the box of the body
    const Aabb box = more->assembly().shapes->bounding_box(w, s);
    Aabb drawn{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
    for (const Vec3& p : b.surface->points) {
      const Vec3 x = b.pose.position + b.pose.orientation * p;
      drawn.min = drawn.min.cwiseMin(x);
      drawn.max = drawn.max.cwiseMax(x);
    }
    const bool is_round = stored.words(b).shape == "clump";  // drawn with flat facets
    CHECK((drawn.min - box.min).norm() + (drawn.max - box.max).norm() < (is_round ? 0.1 : 1e-12) * b.radius);
  }
}

TEST_CASE("a hull without orientation is exported without one", "[scenes][export]") {
  const TemporaryFolder folder;
  const std::string text =
      state_head + "[[body]]\nname = \"b\"\nshape = \"hull\"\nmaterial = \"wood\"\nposition = [0, 0, 1]\n";
  Session run(assembled(text, folder.path()), {}, folder / "out");
  run.run({std::nullopt, 1, std::nullopt}, true);
  export_run(folder / "out", ExportFormat::csv);
  std::ifstream in(folder / "out/bodies.csv");
  std::string header, row;
  std::getline(in, header);
  std::getline(in, row);
  CHECK_THAT(header, Catch::StartsWith("x,y,z,vx,vy,vz,qw,qx,qy,qz"));
  std::vector<double> values;
  for (std::size_t at = 0, k = 0; k < 10; ++k, at = row.find(',', at) + 1) values.push_back(std::stod(row.substr(at)));
  CHECK(values[6] == Approx(1.0).epsilon(1e-15));
  CHECK(std::abs(values[7]) + std::abs(values[8]) + std::abs(values[9]) < 1e-15);
}

namespace {

/// Four walls on a floor; SHAPE stands for that of the grains.
const std::string walls_and_shape = R"x(
shape.g = { SHAPE }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "stone"
fixed = true
[[body]]
name = "side"
repeat = 4
shape = { half_space = { normal = ["= cos(i*pi/2)", "= sin(i*pi/2)", 0] } }
position = ["= -0.012*cos(i*pi/2)", "= -0.012*sin(i*pi/2)", 0]
material = "stone"
fixed = true
)x";

/// Free bodies as older versions wrote them: principal axes are those of the world's bodies.
std::string principal_rows(const World& w) {
  std::string rows = "x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz\n";
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s)) continue;
    const Vec3 &x = w.position[s], &v = w.velocity[s], &spin = w.angular_velocity[s];
    const Quat& q = w.orientation[s];
    for (const double value :
         {x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), q.w(), q.x(), q.y(), q.z(), spin.x(), spin.y()})
      rows += fmt::format("{:.17g},", value);
    rows += fmt::format("{:.17g}\n", spin.z());
  }
  return rows;
}

}  // namespace

TEST_CASE("rows with orientations of principal axes, as older versions wrote them, are read as the state they were",
          "[scenes][export]") {
  std::string head = state_head.substr(0, state_head.find("[[body]]"));
  head.replace(head.find("0.04"), 4, "0.08");
  const auto shapes = {
      "polyhedron = { random = { vertices = 16, seed = 3 } }, scale_to_diameter = 0.005",
      "polyhedron = { random = { vertices = 8, seed = 11 } }, scale_to_diameter = 0.004",
      "clump = { spheres = [[0, 0, 0, 0.0015], [0.002, 0.001, 0, 0.001], [0, 0.002, 0.0015, 0.001]] }"};
  for (const std::string shape : shapes) {
    INFO(shape);
    const TemporaryFolder folder;
    std::string walls = walls_and_shape;
    walls.replace(walls.find("SHAPE"), 5, shape);
    const std::string fill =
        "[[fill]]\nname = \"g\"\nshape = \"g\"\nmaterial = \"wood\"\ncount = 40\n"
        "region = { box = { min = [-0.012, -0.012, 0], max = [0.012, 0.012, 0.03] } }\n";
    Session run(assembled(head + walls + fill, folder.path()), {}, folder / "out");
    REQUIRE(run.run({}, true) == Ending::completed);
    const Assembly& was = run.assembly();
    const World& w = was.simulation->world;
    const ContactPieces pieces(w, was.simulation->work.contacts);
    REQUIRE(measure_overlap(w, pieces, *was.shapes).max_relative < 0.1);
    std::ofstream(folder / "old.csv") << principal_rows(w);
    const std::string file = "[[bodies]]\nfile = \"old.csv\"\nmaterial = \"wood\"\nshape = \"g\"\n";
    const auto again = assembled(head + walls + file, folder.path());
    REQUIRE(!again->warnings.empty());
    CHECK_THAT(again->warnings.back().text, Catch::Contains("read as those of principal axes"));
    again->simulation->start();
    const World& is = again->simulation->world;
    const Energy before = was.simulation->ledger.measure(w), after = again->simulation->ledger.measure(is);
    CHECK(after.kinetic == Approx(before.kinetic).epsilon(1e-9));
    CHECK(after.potential == Approx(before.potential).epsilon(1e-9));
    CHECK(after.elastic == Approx(before.elastic).epsilon(1e-6));
    // what this version writes is taken as it stands
    export_run(folder / "out", ExportFormat::csv);
    const auto own = assembled(head + walls + "[[bodies]]\nfile = \"out/bodies.csv\"\n", folder.path());
    CHECK(own->warnings.empty());
    own->simulation->start();
    CHECK(own->simulation->ledger.measure(own->simulation->world).elastic == Approx(before.elastic).epsilon(1e-6));
  }
}

TEST_CASE("a run that fails keeps a state no older than its last checkpoint", "[scenes][restart]") {
  const TemporaryFolder folder;
  for (const int every : {30, 77, 100, 200}) {
    INFO("a checkpoint every " << every << " steps");
    const std::string text =
        "run = { duration = 1, time_step = 1e-3, output_interval = 0.1, checkpoint_interval = " +
        fmt::format("{} }}\n", 1e-3 * every) +
        "world = { gravity = [0, 0, -9.81], domain = { min = [-1, -1, -1], max = [1, 1, 1] } }\n"
        "material.glass = { density = 2500.0 }\n"
        "contact = { method = \"nonsmooth\", restitution = 0, friction = 0.5 }\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"glass\"\n";
    Session run(assembled(text, folder.path()), {}, folder / fmt::format("out{}", every));
    REQUIRE(run.run({}, true) == Ending::failed);
    // it falls from 0 to the lower side at sqrt(2/g) = 0.4515 s
    CHECK(452 - static_cast<int>(run.assembly().simulation->steps()) <= every);
  }
}
