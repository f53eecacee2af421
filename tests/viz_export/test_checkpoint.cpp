#include "viz_export/hdf5/checkpoint.h"

#include <fstream>

#include "engine/state/world.h"
#include "engine/step/energy.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/hdf5_file.h"

using namespace epafi;
using Catch::Contains;

namespace {

const CheckpointHeader header{"0.1.0", "00ff", "scenes/a.toml", "[run]\nduration = 1\n", {"params.n=5", "x=\"y\""},
                              1234,    0.1};
const std::string expected = "00ff";

World some_world(std::uint64_t seed, int bodies) {
  World world({.rotation = true, .anisotropy = true, .force = true, .external_force = true});
  Random random(seed, 0);
  const auto any = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  std::vector<BodyId> leaving;
  for (int k = 0; k < bodies; ++k) {
    const Vec3 v = any();
    Body body;
    body.position = any();
    body.orientation = Quat(1, v.x(), v.y(), v.z());
    body.velocity = any();
    body.angular_velocity = any();
    body.mass = 2.0;
    body.inertia = {1, 2, 3};
    body.material = static_cast<std::uint16_t>(k);
    const BodyId id = world.add(body);
    if (k % 7 == 3) leaving.push_back(id);
  }
  world.remove(leaving);
  world.time = random.uniform();
  return world;
}

StateWalk walk_of(World& world) {
  return [&world](StateVisitor& v) { world.visit(v); };
}

std::string message_of(const std::filesystem::path& path) {
  World world = some_world(2, 3);
  try {
    load_checkpoint(path, expected, walk_of(world));
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a loaded checkpoint gives the saved bits and header, into a world of another size too",
          "[viz_export][checkpoint]") {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5";
  World saved = some_world(1, 50), loaded = some_world(2, 3);
  std::vector<std::uint64_t> empty, loaded_empty(4);
  save_checkpoint(path, header, [&](StateVisitor& v) {
    saved.visit(v);
    v.column("extra/empty", empty);
  });
  const CheckpointHeader h = load_checkpoint(path, expected, [&](StateVisitor& v) {
    // the order of the walk does not matter
    v.column("extra/empty", loaded_empty);
    loaded.visit(v);
  });
  CHECK(state_hash(loaded) == state_hash(saved));
  CHECK(loaded.time == saved.time);
  CHECK(loaded.ids_given() == 50);
  CHECK(loaded.size() == saved.size());
  CHECK(loaded_empty.empty());
  CHECK((h.step == 1234 && h.time == 0.1 && h.overrides == header.overrides && h.scene_text == header.scene_text));
  const CheckpointHeader alone = read_checkpoint_header(path);
  CHECK((alone.scene_path == header.scene_path && alone.version == "0.1.0" && alone.scene_hash == "00ff"));
}

TEST_CASE("a checkpoint of another format or scene is refused, of another version it is read",
          "[viz_export][checkpoint]") {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5";
  World world = some_world(1, 5);
  CheckpointHeader other = header;
  other.version = "0.2.0";
  save_checkpoint(path, other, walk_of(world));
  CHECK(message_of(path).empty());
  CHECK(read_checkpoint_header(path).version == "0.2.0");
  other = header;
  other.scene_hash = "beef";
  save_checkpoint(path, other, walk_of(world));
  CHECK_THAT(message_of(path), Contains("another scene") && Contains("beef"));
  {
    Hdf5File file(path, Hdf5File::Mode::append);
    file.set_attribute("/", "format", std::uint64_t{99});
    file.close();
  }
  CHECK_THAT(message_of(path), Contains("format 99"));
  {
    Hdf5File file(path, Hdf5File::Mode::create);
    file.close();
  }
  CHECK_THAT(message_of(path), Contains("is not a checkpoint"));
}

TEST_CASE("columns that the simulation lacks or has beside the stored ones are named", "[viz_export][checkpoint]") {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5";
  World world = some_world(1, 5);
  std::vector<double> springs(7);
  save_checkpoint(path, header, [&](StateVisitor& v) {
    world.visit(v);
    v.column("law/springs", springs);
  });
  CHECK_THAT(message_of(path), Contains("'law/springs' is not a part of this simulation"));
  save_checkpoint(path, header, walk_of(world));
  const auto with_springs = [&](StateVisitor& v) {
    world.visit(v);
    v.column("law/springs", springs);
  };
  CHECK_THROWS_WITH(load_checkpoint(path, expected, with_springs), Contains("'law/springs' is missing"));
  std::vector<float> narrow(5);
  const auto other_size = [&](StateVisitor& v) { v.column("world/inverse_mass", narrow); };
  CHECK_THROWS_WITH(load_checkpoint(path, expected, other_size), Contains("'world/inverse_mass'") && Contains("size"));
  const auto twice = [&](StateVisitor& v) {
    world.visit(v);
    world.visit(v);
  };
  CHECK_THROWS_WITH(load_checkpoint(path, expected, twice), Contains("twice"));
}

TEST_CASE("every cut and every changed byte of a checkpoint is either harmless or refused",
          "[viz_export][checkpoint]") {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5", damaged = folder / "damaged.h5";
  World world = some_world(1, 40);
  const std::string hash = state_hash(world);
  save_checkpoint(path, header, walk_of(world));
  const std::string good = read_whole_file(path);
  for (std::size_t size = 0; size < good.size(); size += good.size() / 23) {
    write_whole_file(damaged, {std::string_view(good).substr(0, size)});
    CHECK_FALSE(message_of(damaged).empty());
  }
  int refused = 0, harmless = 0;
  for (std::size_t at = 0; at < good.size(); at += 97) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x55);
    write_whole_file(damaged, {bad});
    World loaded = some_world(2, 3);
    try {
      load_checkpoint(damaged, expected, walk_of(loaded));
      CHECK(state_hash(loaded) == hash);  // the byte lay in a gap between HDF5's blocks
      ++harmless;
    } catch (const FileError&) {
      ++refused;
    }
  }
  CHECK(refused > harmless);  // state and structure fill most of the file
}

TEST_CASE("a save that fails leaves the checkpoint of before", "[viz_export][checkpoint]") {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5";
  World world = some_world(1, 5);
  save_checkpoint(path, header, walk_of(world));
  const std::string before = read_whole_file(path);
  const auto failing = [&](StateVisitor& v) {
    world.visit(v);
    world.visit(v);
  };  // the same columns twice
  CHECK_THROWS_WITH(save_checkpoint(path, header, failing), Contains("world/time"));
  CHECK(read_whole_file(path) == before);
  CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
}
