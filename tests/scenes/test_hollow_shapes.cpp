// What the door says of tubes and cones, and how a scene's shape is written back and drawn.
#include <algorithm>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/shape_builder.h"
#include "scenes/shape_text.h"
#include "tests/support/catch.h"
#include "viz_export/vtk/surface.h"

using namespace epafi;

namespace {

/// The scene's first body is in line 10.
ReadResult read_body(const std::string& body) {
  const std::string head =
      "[run]\nduration = 1.0\n[material.glass]\ndensity = 2500.0\n[contact]\nmethod = \"smooth\"\nsmooth = { law = "
      "\"hertz-mindlin\" }\nrestitution = 0.5\nfriction = 0.5\n";
  return read_scene_text(head + body, "scene.toml", {}, full_registry());
}

std::string wall(const std::string& shape, const std::string& rest) {
  return "[[body]]\nname = \"wall\"\nshape = { " + shape + " }\nmaterial = \"glass\"\n" + rest + "\n";
}

std::string refusal(const ReadResult& result) {
  CHECK_FALSE(result.scene.has_value());
  return result.problems.empty() ? "" : result.problems[0].to_string();
}

}  // namespace

TEST_CASE("a tube or cone that nothing holds or drives is refused at its place", "[scenes][door][hollow]") {
  CHECK(refusal(read_body(wall("tube = { radius = 0.1, length = 1.0 }", ""))) ==
        "scene.toml:10:1: error: [[body]] 'wall': a tube cannot move freely; write fixed = true or give it a motion");
  CHECK(refusal(read_body(wall("cone = { radii = [0.1, 0.2], length = 1.0 }", ""))) ==
        "scene.toml:10:1: error: [[body]] 'wall': a cone cannot move freely; write fixed = true or give it a motion");
  for (const char* held : {"fixed = true", "motion = { velocity = [1, 0, 0] }",
                           "motion = { rotation = { axis = [0, 0, 1], rate = 1.0, about = [0, 0, 0] } }"})
    CHECK(read_body(wall("tube = { radius = 0.1, length = 1.0 }", held)).scene.has_value());
}

TEST_CASE("radii and ends of hollow walls are checked", "[scenes][door][hollow]") {
  using Catch::Contains;
  const auto of = [](const char* shape) { return refusal(read_body(wall(shape, "fixed = true"))); };
  CHECK_THAT(of("cone = { radii = [0.1], length = 1.0 }"), Contains("scene.toml:12:") && Contains("found 1"));
  CHECK_THAT(of("cone = { radii = [0, 0], length = 1.0 }"), Contains("scene.toml:12:") && Contains("is positive"));
  CHECK_THAT(of("cone = { radii = [-0.1, 0.2], length = 1.0 }"), Contains("scene.toml:12:"));
  CHECK_THAT(of("tube = { radius = 0, length = 1.0 }"), Contains("scene.toml:12:") && Contains("radius"));
  CHECK_THAT(of("tube = { radius = 0.1, length = 1.0, ends = \"shut\" }"), Contains("open") && Contains("closed"));
}

TEST_CASE("a hollow wall is written back as it was, and drawn as a surface", "[scenes][hollow]") {
  const char* form = "{ cone = { ends = \"closed\", length = 2, radii = [0.5, 1.5] } }";
  const ReadResult read =
      read_body("[[body]]\nname = \"wall\"\nshape = " + std::string(form) + "\nmaterial = \"glass\"\nfixed = true\n");
  REQUIRE(read.scene.has_value());
  CHECK(shape_text(read.scene->shapes[0]) == form);
  ShapeStore store;
  ShapeBuilder builder(*read.scene, store);
  const BuiltShape built = builder.build(0);
  CHECK_FALSE(built.is_solid);
  CHECK(built.radius == Approx(std::sqrt(1.0 + 1.5 * 1.5)));
  const Surface drawn = surface_of(store, built.ref, 1.0, Vec3::Zero());
  CHECK(drawn.points.size() == 2 * 48 + 2);
  CHECK(drawn.offsets.size() == 4 * 48);
}
