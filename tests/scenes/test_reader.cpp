#include "tests/support/catch.h"
#include "scenes/reader/scene_reader.h"
#include "tests/support/scene_registry.h"

using namespace epafi;

TEST_CASE("x", "[scenes]") {
  const auto r = read_scene(EPAFI_SOURCE_DIR "/tests/data/scenes/pebbles.toml", {}, test_registry());
  for (const auto& p : r.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(r.scene);
}
