#include <cmath>
#include <numbers>
#include <tuple>

#include "scenes/reader/scene_reader.h"

#include "scenes/cli/new_scene.h"
#include "scenes/full_registry.h"
#include "tests/support/catch.h"
#include "tests/support/scene_registry.h"

using namespace epafi;

namespace {

const std::string scene_folder = EPAFI_SOURCE_DIR "/tests/data/scenes/";

std::string all_of(const ReadResult& result) {
  std::string text;
  for (const auto& problem : result.problems) text += problem.to_string() + "\n";
  return text;
}

Scene read(const std::vector<std::string>& overrides = {}) {
  auto result = read_scene(scene_folder + "pebbles.toml", overrides, test_registry());
  INFO(all_of(result));
  REQUIRE(result.scene);
  return std::move(*result.scene);
}

Scene read_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
  auto result = read_scene_text(text, "scene.toml", overrides, test_registry());
  INFO(all_of(result));
  REQUIRE(result.scene);
  return std::move(*result.scene);
}

const std::string ball_scene =
    "[run]\nduration = 1\n[material.a]\ndensity = 1\n[[body]]\nname = \"ball\"\nmaterial = \"a\"\nshape = { sphere = { "
    "radius = 1 } }\n";

}  // namespace

TEST_CASE("expressions know the seed of the run, and jitter displaces bodies of a file by it", "[scenes][reader]") {
  const std::string scene = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/pile/polyhedra.toml";
  const auto places = [&](const std::vector<std::string>& overrides) {
    const ReadResult read = read_scene(scene, overrides, full_registry());
    REQUIRE(read.scene);
    std::vector<Vec3> out;
    for (const BodySpec& b : read.scene->bodies)
      if (!b.fixed) out.push_back(b.position);
    return out;
  };
  const auto written = places({}), some = places({"params.jitter=0.02"}),
             other = places({"params.jitter=0.02", "run.seed=7"}),
             named = places({"params.jitter=\"= 0.01*seed\"", "run.seed=2"});
  REQUIRE(written.size() == 1000);
  double largest = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < written.size(); ++k) {
    largest = std::max(largest, (some[k] - written[k]).cwiseAbs().maxCoeff());
    sum += (some[k] - written[k]).sum();
    CHECK(some[k] != other[k]);
    CHECK((named[k] - written[k]).cwiseAbs().maxCoeff() <= 0.02);
  }
  CHECK(largest <= 0.02);
  CHECK(largest > 0.0199);                                         // of 3000 draws
  CHECK(std::abs(sum / 3000) < 4 * 0.02 / std::sqrt(3.0 * 3000));  // mean 0 within four deviations
}

TEST_CASE("the settings of a scene arrive in SI", "[scenes][reader]") {
  const Scene s = read();
  CHECK(s.title == "Two thousand pebbles in a box");
  CHECK(s.run.duration.value == 2.0);
  CHECK(s.run.duration.place.line == 10);
  CHECK_FALSE(s.run.time_step.value);
  CHECK(s.run.scheme.value == "velocity-verlet");
  CHECK_FALSE(s.run.scheme.written());
  CHECK(s.run.output_interval.value == 0.02);
  CHECK(s.run.checkpoint_interval == 1.0);
  CHECK(s.run.seed == 3);
  CHECK(s.gravity == Vec3(0, 0, -9.81));
  REQUIRE(s.domain);
  CHECK(s.domain->value.max == Vec3(1, 1, 3));
}

TEST_CASE("an including file wins over what it includes, key by key", "[scenes][reader]") {
  const Scene s = read();
  REQUIRE(s.materials.size() == 2);
  CHECK(s.materials[0].material.name == "steel");
  CHECK(s.materials[0].material.youngs_modulus == 210e9);
  CHECK(s.materials[1].material.density == 2500.0);
  CHECK(s.materials[1].material.youngs_modulus == 70e9);
}

TEST_CASE("contact values of a pair stand above those of all", "[scenes][reader]") {
  const Scene s = read();
  CHECK(s.contact.method.value == Method::smooth);
  CHECK(s.contact.law.value == "hertz-mindlin");
  CHECK(s.contact.solver.value == "pgs");
  CHECK(s.contact.nonsmooth.integer("iterations") == 50);
  CHECK(s.contact.nonsmooth.number("relaxation") == 1.0);  // the default of the entry
  const MaterialTable table = material_table(s);
  CHECK(table.of(0, 1).friction == 0.2);
  CHECK(table.of(1, 0).friction == 0.2);
  CHECK(table.of(1, 1).friction == 0.5);
  CHECK(table.of(0, 1).restitution == 0.8);
  CHECK(table.of(0, 1).a.name == "steel");
}

TEST_CASE("shapes keep their form and parameters", "[scenes][reader]") {
  const Scene s = read();
  CHECK(s.shapes[0].name == "pebble");
  CHECK(s.shapes[0].type == "polyhedron");
  CHECK(s.shapes[0].parameters.text("file") == scene_folder + "pebble.obj");
  CHECK(s.shapes[0].scale_to_diameter == 0.01);
  CHECK(s.shapes[0].rounding == 1e-4);
  CHECK(s.shapes[1].parameters.integer("random.vertices") == 16);
  CHECK(s.shapes[1].parameters.integer("random.seed") == 3);
  CHECK(s.shapes[s.bodies[0].shape].parameters.vec3("normal") == Vec3(0, 0, 1));  // scaled to length 1
}

TEST_CASE("repeat unrolls with i, j, k and shares one shape", "[scenes][reader]") {
  const Scene s = read();
  const GroupSpec& stack = s.groups[1];
  REQUIRE(stack.count == 20);
  CHECK(body_name(s, stack.first) == "stack[0]");
  CHECK(s.bodies[stack.first + 7].position == Vec3(0, 0, 7.5 * 0.010));
  CHECK(s.bodies[stack.first + 7].shape == 0);
  const GroupSpec& grid = s.groups[2];
  REQUIRE(grid.count == 24);
  const BodySpec& last = s.bodies[grid.first + 23];
  CHECK(body_name(s, grid.first + 23) == "grid[1,2,3]");
  CHECK(last.position == Vec3(0.010, 2 * 0.010, 1 + 3 * 0.010));
  CHECK(last.shape == s.bodies[grid.first].shape);
  CHECK(s.shapes[last.shape].parameters.number("radius") == 0.005);
}

TEST_CASE("an inline shape that uses the index is one shape per copy", "[scenes][reader]") {
  const Scene s = read_text(
      "[run]\nduration = 1\n[contact]\nmethod = \"smooth\"\nrestitution = 1\nfriction = 0\n[material.a]\ndensity = 1\n"
      "[[body]]\nrepeat = 3\nmaterial = \"a\"\nshape = { sphere = { radius = \"= i + 1\" } }\nposition = [\"= 10*i\", "
      "0, 0]\n");
  REQUIRE(s.bodies.size() == 3);
  CHECK(s.shapes[s.bodies[2].shape].parameters.number("radius") == 3.0);
  CHECK(body_name(s, 0).empty());
}

TEST_CASE("driven bodies carry their motion", "[scenes][reader]") {
  const Scene s = read();
  const BodySpec& gate = s.bodies[s.groups[3].first];
  REQUIRE(gate.motion);
  CHECK(gate.motion->parts[0].velocity == Vec3(1, 0, 0));
  CHECK(gate.motion->parts[0].until == 1.2);
  CHECK((gate.remove_at && gate.remove_at->time == 1.5));
  const BodySpec& drum = s.bodies[s.groups[4].first];
  CHECK(drum.motion->parts[0].rotation_rate == Approx(90 * 2 * std::numbers::pi / 60).epsilon(1e-15));
  CHECK(drum.motion->parts[0].rotation_axis == Vec3(0, 1, 0));
  CHECK(drum.motion->parts[0].rotation_about == Vec3(0, 0, 1));
  CHECK(drum.motion->parts[0].oscillation_amplitude == 0.005);
  // pitch of 90 degrees takes x to -z and z to x
  CHECK((drum.orientation * Vec3::UnitZ() - Vec3::UnitX()).norm() < 1e-15);
}

TEST_CASE("euler_deg turns about x, then y, then z of the world", "[scenes][reader]") {
  const Scene s = read_text(ball_scene + "euler_deg = [90, 0, 90]\n");
  // x -> x -> y;  y -> z -> z;  z -> -y -> x
  CHECK((s.bodies[0].orientation * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
  CHECK((s.bodies[0].orientation * Vec3::UnitY() - Vec3::UnitZ()).norm() < 1e-15);
}

TEST_CASE("rows of a CSV file become bodies; those with a radius share a shape, each of its size", "[scenes][reader]") {
  const Scene s = read();
  const GroupSpec& rain = s.groups[5];
  REQUIRE(rain.count == 3);
  const BodySpec* b = &s.bodies[rain.first];
  CHECK(b[0].position == Vec3(0.5, 0, 1));
  CHECK(b[1].velocity == Vec3(0, 0, -1));
  CHECK(b[0].shape == b[2].shape);
  CHECK(b[1].shape == b[2].shape);
  CHECK(b[1].size == b[2].size);
  CHECK(b[0].size != b[1].size);
  CHECK(s.materials[b[0].material].material.name == "steel");
  CHECK(body_name(s, rain.first + 2) == "rain[2]");
}

TEST_CASE("fills, measures, bounds and studies are resolved", "[scenes][reader]") {
  const Scene s = read();
  REQUIRE(s.fills.size() == 1);
  CHECK(s.fills[0].count == 200);
  CHECK(s.fills[0].weights == std::vector<double>{3, 1});
  CHECK(s.fills[0].seed == 3);  // that of [run]
  CHECK(s.fills[0].region.max == Vec3(0.9, 0.9, 2.9));
  REQUIRE(s.measures.size() == 2);
  CHECK(s.measures[0].parameters.vec3("plane.normal") == Vec3(0, 0, -1));
  REQUIRE(s.measures[1].bodies.size() == 2);
  CHECK(s.measures[1].bodies[0].bodies == std::vector<NamedBodies::Range>{{s.groups[1].first, 1}});
  REQUIRE(s.bounds.size() == 3);
  CHECK(s.bounds[2].quantity == "drift");
  CHECK(s.bounds[2].limit == 0.01 * 0.010);
  REQUIRE(s.bounds[2].bodies.bodies.size() == 1);
  CHECK(s.bounds[2].bodies.bodies[0].count == 20);
  CHECK(s.accuracy.size() == 2);
  REQUIRE(s.sweep.size() == 2);
  CHECK(s.sweep[0].values == std::vector<std::string>{"\"smooth\"", "\"nonsmooth\""});
  CHECK(s.sweep[1].key == "params.n");
  REQUIRE(s.benchmark);
  CHECK(s.benchmark->sizes[0].values == std::vector<std::string>{"1000", "10000"});
}

TEST_CASE("overrides by --set change values by key, index and name", "[scenes][reader]") {
  const Scene s = read({"params.n=5", "contact.method=nonsmooth", "body.stack.material=steel", "body.0.name=ground",
                        "measure.touch.between=[\"stack\", \"ground\"]", "contact.nonsmooth.tolerance = 1e-9"});
  CHECK(s.groups[1].count == 5);
  CHECK(s.contact.method.value == Method::nonsmooth);
  CHECK(s.contact.method.place.file == "--set contact.method=nonsmooth");
  CHECK(s.run.scheme.value == "moreau-jean");
  CHECK(s.materials[s.bodies[s.groups[1].first].material].material.name == "steel");
  CHECK(s.groups[0].name == "ground");
  CHECK(s.contact.nonsmooth.number("tolerance") == 1e-9);
  CHECK(s.text.find("params.n=5") != std::string::npos);  // part of what identifies the run
}

TEST_CASE("wrong overrides are named by their own text", "[scenes][reader]") {
  const auto said = [](const std::string& text) {
    const auto result = read_scene(scene_folder + "pebbles.toml", {text}, test_registry());
    CHECK_FALSE(result.scene);
    std::string errors;
    for (const Problem& p : result.problems)  // the file has tables for both methods, of which one is not used
      if (p.level == Problem::Level::error) errors += (errors.empty() ? "" : "\n") + p.to_string();
    return errors;
  };
  CHECK(said("contact.friction=-1") ==
        "--set contact.friction=-1: error: [contact] friction = -1 is outside [0, 10] (coefficient, no unit)");
  CHECK(said("run.sed=3") == "--set run.sed=3: error: unknown key 'sed' in [run]; did you mean 'seed'?");
  CHECK(said("body.stak.material=steel") ==
        "--set body.stak.material=steel: error: no element has the name 'stak'; did you mean 'stack'?");
  CHECK(said("body.9.name=x") == "--set body.9.name=x: error: there is no element 9; the list has 5, counted from 0");
  CHECK(said("run.duration.x=1") == "--set run.duration.x=1: error: there is nothing inside a number to set 'x' of");
  CHECK(said("friction") == "--set friction: error: expected KEY.PATH=VALUE");
  CHECK(said("run.duration== 2*") ==
        "--set run.duration== 2*: error: [run] duration: a value is missing at the end in \"= 2*\" at character 5");
}

TEST_CASE("a shear modulus stands for Young's modulus", "[scenes][reader]") {
  const Scene s = read_text("[run]\nduration = 1\n[material.a]\nshear_modulus = 80e9\npoissons_ratio = 0.25\n");
  CHECK(s.materials[0].material.youngs_modulus == 2 * 80e9 * 1.25);
}

TEST_CASE("a law's parameter may stand in every pair instead", "[scenes][reader]") {
  const Scene s = read_text(
      ball_scene +
      "[contact]\nmethod = \"smooth\"\n[contact.smooth]\nlaw = \"linear\"\n[[contact.pair]]\nbetween = [\"a\", \"a\"]\n"
      "restitution = 0.5\nfriction = 0\nstiffness = \"1 kN/m\"\n"
      "[[body]]\nmaterial = \"a\"\nshape = { half_space = { normal = [0, 0, 1] } }\nfixed = true\n");
  CHECK(material_table(s).of(0, 0).parameters.number("stiffness") == 1000.0);
  CHECK(material_table(s).of(0, 0).parameters.number("stiffness_ratio") == 2.0 / 7.0);
  CHECK(material_table(s).of(0, 0).restitution == 0.5);
}

TEST_CASE("100 000 repeated bodies share one shape", "[scenes][reader]") {
  const Scene s = read_text(ball_scene +
                            "repeat = [100, 100, 10]\nposition = [\"= 3*i\", \"= 3*j\", \"= 3*k\"]\n"
                            "[contact]\nmethod = \"smooth\"\nrestitution = 1\nfriction = 0\n");
  REQUIRE(s.bodies.size() == 100000);
  CHECK(s.bodies.back().position == Vec3(297, 297, 27));
  CHECK(s.shapes.size() == 1);
}

TEST_CASE("every starter scene reads without a problem", "[scenes][reader]") {
  for (const auto& kind : starter_kinds()) {
    const auto result = read_scene_text(starter_scene(kind), kind + ".toml", {}, full_registry());
    INFO(kind << "\n" << all_of(result));
    CHECK(result.problems.empty());
    CHECK(result.scene);
  }
  CHECK_THROWS_WITH(starter_scene("hoper"), "error: there is no starter scene 'hoper'; did you mean 'hopper'?");
}

TEST_CASE("one scene runs by both methods: what belongs to the other one is a warning", "[scenes][reader]") {
  const std::string scene =
      "[run]\nduration = 1\nscheme = \"velocity-verlet\"\n[contact]\nmethod = \"smooth\"\nrestitution = 1\n"
      "friction = 0\n[contact.smooth]\nlaw = \"hertz\"\n[contact.nonsmooth]\nsolver = \"pgs\"\n"
      "[material.a]\ndensity = 1\n";
  for (const auto& [method, scheme, expected] :
       {std::tuple{"smooth", "velocity-verlet", "[contact.nonsmooth] is not used by method 'smooth'"},
        std::tuple{"nonsmooth", "moreau-jean", "[contact.smooth] is not used by method 'nonsmooth'"}}) {
    const ReadResult r =
        read_scene_text(scene, "both.toml", {std::string("contact.method=") + method}, full_registry());
    REQUIRE(r.scene);
    CHECK(r.scene->run.scheme.value == scheme);
    std::string all;
    for (const Problem& p : r.problems) all += p.to_string() + "\n";
    CHECK_THAT(all, Catch::Contains(expected));
    const bool foreign = std::string(method) == "nonsmooth";
    const std::string of_scheme =
        "both.toml:3:10: warning: [run] scheme 'velocity-verlet' is not used by method 'nonsmooth', which takes "
        "'moreau-jean'";
    CHECK((all.find(of_scheme) != std::string::npos) == foreign);
    CHECK(r.problems.size() == (foreign ? 2 : 1));
  }
}
