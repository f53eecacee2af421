// Warnings of a scene, of its start and of its models: who deserves one gets it, and nobody else.
#include <fmt/format.h>

#include <fstream>
#include <numbers>

#include "engine/units/random.h"
#include "tests/support/captured_run.h"
#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/support/library_scenes.h"
#include "tests/support/scene_run.h"
#include "tests/support/scene_text.h"
#include "viz_export/files/json_reader.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Of the run of a scene written in a test: its exit code, all it printed, and the warnings of its summary.
struct Warned {
  int code = 0;
  std::string err;
  std::vector<std::string> warnings;
  double energy_error = 0.0;
};

Warned run_warned(const std::string& text, bool strict = false) {
  const TemporaryFolder folder;
  std::ofstream(folder / "scene.toml") << text;
  RunOptions options = quiet_into(folder / "out");
  options.strict = strict;
  options.least_output = true;
  const Captured run = run_of(folder / "scene.toml", options);
  Warned out{run.code, run.err, {}, 0.0};
  if (!std::filesystem::exists(folder / "out" / "summary.json")) return out;
  const FlatJson summary = read_json(folder / "out" / "summary.json");
  for (int k = 0; !summary.text(fmt::format("warnings.{}", k)).empty(); ++k)
    out.warnings.push_back(summary.text(fmt::format("warnings.{}", k)));
  out.energy_error = summary.number("energy.relative_error").value_or(0.0);
  return out;
}

}  // namespace

TEST_CASE("no scene of the library warns of itself as it is read", "[scenes][warnings][library]") {
  for (const std::string& scene : all_scenes()) {
    const ReadResult read = read_scene(library(scene), {}, full_registry());
    INFO(scene);
    for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
    CHECK(read.scene);
    CHECK(read.problems.empty());
  }
}

TEST_CASE("strict runs count the warnings of the scene", "[scenes][warnings]") {
  const std::string ball =
      "run = { duration = 0.01, time_step = 1e-3 }\nmaterial.m = { density = 1000 }\n[[body]]\nname = \"ball\"\n"
      "shape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\n";
  const std::string contact = "contact = { method = \"nonsmooth\", restitution = 0, friction = 0";
  const std::string plain = contact + " }\n" + ball;
  CHECK(run_warned(plain, true).code == exit_done);
  // a table of the other method, a key that the solver does not use, a quaternion that is not one
  for (const std::string& warned : {contact + ", smooth = { law = \"hertz\" } }\n" + ball,
                                    contact + ", nonsmooth = { solver = \"nsgs\", sides = 5 } }\n" + ball,
                                    plain + "orientation = [1, 1, 0, 0]\n"}) {
    INFO(warned);
    CHECK(run_warned(warned).code == exit_done);
    const Warned strict = run_warned(warned, true);
    CHECK(strict.code == exit_bound);
    CHECK_THAT(strict.err, Catch::Contains("by --strict: 1 warnings of the scene, 0 of the run"));
  }
}

TEST_CASE("a law of the default that lacks a constant of the material is reported with a line", "[scenes][warnings]") {
  const std::string text =
      "run = { duration = 0.01 }\nmaterial.m = { density = 1000 }\n[contact]\nmethod = \"smooth\"\n"
      "restitution = 0\nfriction = 0\n[[body]]\nname = \"ball\"\nrepeat = 2\nshape = { sphere = { radius = 0.1 } }\n"
      "material = \"m\"\nposition = [\"= i\", 0, 0]\n";
  CHECK_THAT(run_warned(text).err, Catch::Contains("scene.toml:4:") && Catch::Contains("needs youngs_modulus"));
}

TEST_CASE("bodies that lie deep in each other are named, others are not", "[scenes][warnings][overlap]") {
  Random random(51, 0);
  for (int draw = 0; draw < 24; ++draw) {
    const double share = draw % 2 == 0 ? random.uniform(0.51, 1.9) : random.uniform(0.0, 0.49);
    const double radius = std::pow(10.0, random.uniform(-4, 1));
    const char* method = draw % 4 < 2 ? "nonsmooth" : "smooth";
    // soft, so that smooth contact does not blow up before its first step
    const std::string text = fmt::format(
        "run = {{ duration = 1e-6, time_step = 1e-7, allow_unstable = true }}\n"
        "material.m = {{ density = 1000, youngs_modulus = 1e-3, poissons_ratio = 0.3 }}\n"
        "contact = {{ method = \"{}\", restitution = 0.5, friction = 0.3 }}\n"
        "[[body]]\nname = \"ball\"\nrepeat = 2\nshape = {{ sphere = {{ radius = {:.17g} }} }}\nmaterial = \"m\"\n"
        "position = [\"= {:.17g}*i\", 0, 0]\n",
        method, radius, (2.0 - share) * radius);
    const Warned run = run_warned(text);
    INFO(text);
    for (const std::string& w : run.warnings) UNSCOPED_INFO(w);
    const bool named = !run.warnings.empty() && run.warnings[0].find("bodies overlap by") == 0;
    CHECK(named == (share > 0.5));
    if (named) CHECK_THAT(run.warnings[0], Catch::Contains("body 'ball["));
  }
}

TEST_CASE("a soft impact is predicted, and the stiffness that is named keeps it shallow",
          "[scenes][warnings][overlap]") {
  // overlaps of a ball on a wall: Hertz ~ E^(-2/5), exactly; springs ~ k^(-1/2), so that they end up below what is said
  Random random(53, 0);
  for (int draw = 0; draw < 12; ++draw) {
    const bool hertz = draw % 2 == 0;
    const double radius = std::pow(10.0, random.uniform(-3, 0)), speed = std::pow(10.0, random.uniform(-1, 1));
    const double share = random.uniform(0.55, 1.5), nu = 0.3, density = 1000.0;
    const double mass = density * 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
    // m v^2/2 = 8/15 E*/2 sqrt(R) d^(5/2), two like bodies; = k d^2/2
    const double depth = share * radius, energy = 0.5 * mass * speed * speed;
    const double modulus = energy / (4.0 / 15.0 * std::sqrt(radius) * std::pow(depth, 2.5)) * (1.0 - nu * nu);
    const double spring = 2.0 * energy / (depth * depth);
    const auto text = [&](double stiffer) {
      const std::string law =
          hertz ? "law = \"hertz\"" : fmt::format("law = \"linear\", stiffness = {:.17g}", stiffer * spring);
      return fmt::format(
          "run = {{ duration = {:.17g} }}\nworld.gravity = [0, 0, 0]\n"
          "material.m = {{ density = {}, youngs_modulus = {:.17g}, poissons_ratio = {} }}\n"
          "contact = {{ method = \"smooth\", restitution = 1, friction = 0, smooth = {{ {} }} }}\n"
          "[[body]]\nname = \"wall\"\nshape = {{ half_space = {{ normal = [0, 0, 1] }} }}\nmaterial = \"m\"\nfixed = "
          "true\n"
          "[[body]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = {:.17g} }} }}\nmaterial = \"m\"\n"
          "position = [0, 0, {:.17g}]\nvelocity = [0, 0, {:.17g}]\n",
          4.0 * radius / speed, density, stiffer * modulus, nu, law, radius, 1.01 * radius, -speed);
    };
    const auto number_after = [](const std::string& in, const std::string& before) {
      const auto at = in.find(before);
      return at == std::string::npos ? 0.0 : std::stod(in.substr(at + before.size()));
    };
    const Warned run = run_warned(text(1.0));
    INFO(text(1.0) << run.err);
    REQUIRE_FALSE(run.warnings.empty());
    const double seen = number_after(run.warnings[0], "bodies overlap by "),
                 times = number_after(run.warnings[0], "not right; ");
    CHECK(seen == Approx(share).epsilon(0.06));  // two digits, 1.0 to 5 %
    SceneRun soft = prepare(read_scene_text(text(1.0), "scene.toml", {}, full_registry()));
    CHECK(number_after(soft.assembly->time_step.reason, "m/s overlap by ") == Approx(share).epsilon(0.06));
    SceneRun stiff = start_text(text(times));
    CHECK(stiff.assembly->time_step.reason.find("overlap") == std::string::npos);
    double deepest = 0.0;
    while (stiff.simulation().steps() < stiff.assembly->steps) {
      REQUIRE_FALSE(stiff.simulation().advance(true));
      deepest = std::max(deepest, stiff.simulation().work.report.deepest / radius);
    }
    if (hertz) CHECK(deepest == Approx(0.05).epsilon(0.04));  // two digits of the factor
    CHECK(deepest < 0.05 * 1.04);
  }
}

namespace {

struct Drop {
  Vec3 down;
  double rate = 0.0;    ///< acceleration [m/s^2]
  double height = 0.0;  ///< below the ball [m]
  bool by_force = false;
  std::string wall;  ///< shape and position of what is below
};

constexpr double drop_radius = 0.01, drop_density = 1000.0;

std::string vector_text(const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()); }

/// Along an axis onto a plate or the end of a tube; along any direction onto a half-space. From the origin.
Drop random_drop(Random& random) {
  Drop d;
  const int kind = static_cast<int>(random.uniform(0, 3));
  d.by_force = random.uniform(0, 1) < 0.5;
  d.rate = std::pow(10.0, random.uniform(0, 3));
  d.height = drop_radius * std::pow(10.0, random.uniform(1.7, 2.7));
  const Vec3 floor_depth = Vec3::Constant(d.height + drop_radius);
  d.down = -Vec3::UnitZ();
  if (kind == 0) {
    d.down = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    d.wall = fmt::format("half_space = {{ normal = {} }} }}\nposition = {}", vector_text(-d.down),
                         vector_text(d.down.cwiseProduct(floor_depth)));
  } else if (kind == 1) {
    const double thickness = random.uniform(0.1, 1.0) * d.height;
    d.wall = fmt::format("box = {{ size = [1, 1, {:.17g}] }} }}\nposition = [0, 0, {:.17g}]", thickness,
                         -floor_depth.z() - 0.5 * thickness);
  } else {
    d.wall = fmt::format("tube = {{ radius = 0.1, length = {:.17g}, ends = \"closed\" }} }}\nposition = [0, 0, 0]",
                         2.0 * floor_depth.z());
  }
  return d;
}

std::string drop_scene(const Drop& d, double modulus, const std::string& step = "auto") {
  const double mass = drop_density * 4.0 / 3.0 * std::numbers::pi * std::pow(drop_radius, 3);
  const Vec3 gravity = d.by_force ? Vec3(Vec3::Zero()) : Vec3(d.rate * d.down);
  const Vec3 force = d.by_force ? Vec3(mass * d.rate * d.down) : Vec3(Vec3::Zero());
  return fmt::format(
      "run = {{ duration = {:.17g}, time_step = \"{}\" }}\nworld.gravity = {}\n"
      "material.m = {{ density = {}, youngs_modulus = {:.17g}, poissons_ratio = 0.3 }}\n"
      "contact = {{ method = \"smooth\", restitution = 1, friction = 0, smooth = {{ law = \"hertz\" }} }}\n"
      "[[body]]\nname = \"wall\"\nshape = {{ {}\nmaterial = \"m\"\nfixed = true\n"
      "[[body]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = {} }} }}\nmaterial = \"m\"\n{}",
      1.3 * std::sqrt(2.0 * d.height / d.rate), step, vector_text(gravity), drop_density, modulus, d.wall, drop_radius,
      d.by_force ? "force = " + vector_text(force) + "\n" : "");
}

TimeStep expected_step(const std::string& text) {
  return prepare(read_scene_text(text, "scene.toml", {}, full_registry())).assembly->time_step;
}

}  // namespace

TEST_CASE("a fall onto a wall is expected, by weight and by a body's own force", "[scenes][warnings][overlap]") {
  Random random(54, 0);
  for (int draw = 0; draw < 16; ++draw) {
    const Drop drop = random_drop(random);
    const double share = random.uniform(0.6, 0.95), speed = std::sqrt(2.0 * drop.rate * drop.height);
    // m v^2/2 = 8/15 E*/2 sqrt(R) d^(5/2), two like bodies
    const double energy = drop_density * 2.0 / 3.0 * std::numbers::pi * std::pow(drop_radius, 3) * speed * speed;
    const double modulus =
        energy / (4.0 / 15.0 * std::sqrt(drop_radius) * std::pow(share * drop_radius, 2.5)) * (1.0 - 0.3 * 0.3);
    const std::string text = drop_scene(drop, modulus);
    INFO(text);
    const TimeStep step = expected_step(text);
    INFO(step.reason);
    const auto at = step.reason.find("impacts at ");
    REQUIRE(at != std::string::npos);
    std::size_t read = 0;
    const double expected = std::stod(step.reason.substr(at + 11), &read);
    CHECK(expected == Approx(speed).epsilon(6e-3));  // three digits
    const auto deep = step.reason.find("overlap by ");
    const double predicted = std::stod(step.reason.substr(deep + 11));
    CHECK(predicted == Approx(share).epsilon(0.09));  // two digits
    const Warned run = run_warned(text);
    REQUIRE_FALSE(run.warnings.empty());
    CHECK_THAT(run.warnings[0], Catch::Contains("bodies overlap by"));
    // a hundred times stiffer bodies overlap by a sixth of that: nothing is said
    CHECK(expected_step(drop_scene(drop, 100.0 * modulus)).reason.find("impacts at") == std::string::npos);
  }
}

TEST_CASE("an adaptive step is divided as bodies become fast, whatever drives them", "[scenes][time_step][adaptive]") {
  Random random(55, 0);
  for (int draw = 0; draw < 8; ++draw) {
    Drop drop = random_drop(random);
    drop.by_force = true;
    if (draw % 2 == 0) drop.down = -drop.down;  // away from a plane or plate: nothing is expected
    const std::string text = drop_scene(drop, std::pow(10.0, random.uniform(4, 6)), "adaptive");
    SceneRun run = start_text(text);
    Simulation& sim = run.simulation();
    bool divided = false;
    for (int k = 0; k < 3000 && sim.world.velocity[1].norm() * sim.time_step < 5.0 * drop_radius; ++k) {
      const double speed = sim.world.velocity[1].norm();
      const auto before = sim.parts_made();
      REQUIRE_FALSE(sim.advance());
      const double parts = static_cast<double>(sim.parts_made() - before);
      divided = divided || parts > 1.0;
      CHECK(speed * sim.time_step / parts <= 0.1 * drop_radius * (1.0 + 1e-9));
      if (sim.work.report.touching == 0)  // a contact may change the speed within the step
        CHECK(sim.world.velocity[1].norm() * sim.time_step / parts <= 0.1 * drop_radius * (1.0 + 1e-9));
    }
    CHECK(divided);
  }
}

TEST_CASE("a body that moves by more than its radius in a step is told, others are not", "[scenes][warnings]") {
  Random random(56, 0);
  for (int draw = 0; draw < 12; ++draw) {
    const double share = draw % 2 == 0 ? random.uniform(0.3, 0.97) : random.uniform(1.03, 4.0);
    const double radius = std::pow(10.0, random.uniform(-3, 0)), dt = std::pow(10.0, random.uniform(-5, -3));
    const double speed = share * radius / dt;
    const Warned run = run_warned(fmt::format(
        "run = {{ duration = {:.17g}, time_step = {:.17g}, allow_unstable = true }}\nworld.gravity = [0, 0, 0]\n"
        "material.m = {{ density = 1000, youngs_modulus = 1e6, poissons_ratio = 0.3 }}\n"
        "contact = {{ method = \"smooth\", restitution = 1, friction = 0, smooth = {{ law = \"hertz\" }} }}\n"
        "[[body]]\nname = \"wall\"\nshape = {{ half_space = {{ normal = [0, 0, 1] }} }}\nmaterial = \"m\"\nfixed = "
        "true\n"
        "[[body]]\nname = \"slow\"\nshape = {{ sphere = {{ radius = {:.17g} }} }}\nmaterial = \"m\"\n"
        "position = [0, 0, {:.17g}]\n"
        "[[body]]\nname = \"fast\"\nshape = {{ sphere = {{ radius = {:.17g} }} }}\nmaterial = \"m\"\n"
        "position = [{:.17g}, 0, {:.17g}]\nvelocity = [{:.17g}, 0, 0]\n",
        20.0 * dt, dt, 0.5 * radius, 2.0 * radius, radius, 5.0 * radius, 2.0 * radius, speed));
    INFO(share << run.err);
    CHECK(run.code == exit_done);
    REQUIRE(run.warnings.size() == (share > 1.0 ? 1u : 0u));
    if (share > 1.0)
      CHECK_THAT(run.warnings[0], Catch::Contains(fmt::format("moves by {:.3g} of its radius", share)) &&
                                      Catch::Contains("'fast'") && Catch::Contains("step 1"));
  }
}

TEST_CASE("the automatic step of a body on springs keeps its energy without a warning", "[scenes][warnings][spring]") {
  Random random(52, 0);
  for (int draw = 0; draw < 16; ++draw) {
    const double radius = std::pow(10.0, random.uniform(-2, 0)), stiffness = std::pow(10.0, random.uniform(0, 6));
    const double mass = 1000.0 * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    const double period = 2.0 * std::numbers::pi * std::sqrt(mass / stiffness);
    const std::string text =
        fmt::format(
            "run = {{ duration = {:.17g} }}\nmaterial.m = {{ density = 1000, youngs_modulus = 1e9, poissons_ratio = "
            "0.3 "
            "}}\n"
            "contact = {{ method = \"{}\", restitution = 0.5, friction = 0.3 }}\n"
            "[[body]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = {:.17g} }} }}\nmaterial = \"m\"\n"
            "velocity = [{:.17g}, 0, 0]\n[[spring]]\nbody = \"ball\"\nstiffness = [{:.17g}, 0, 0]\n",
            random.uniform(3.0, 12.0) * period, draw % 2 == 0 ? "smooth" : "nonsmooth", radius,
            random.uniform(0.1, 2.0) * radius / period, stiffness) +
        // one that it may touch: then it is contact, and not the spring alone, that sets the step
        (draw % 4 < 2 ? ""
                      : fmt::format("[[body]]\nname = \"other\"\nshape = {{ sphere = {{ radius = {:.17g} }} }}\n"
                                    "material = \"m\"\nposition = [0, {:.17g}, 0]\n",
                                    radius, 100.0 * radius));
    const Warned run = run_warned(text, true);
    INFO(text << run.err);
    CHECK(run.code == exit_done);
    CHECK(run.warnings.empty());
    // (omega dt)^2 / 4 at 40 steps a period
    CHECK(std::abs(run.energy_error) < 6.5e-3);
  }
}

TEST_CASE("a measure of contacts between held bodies is told to stay 0", "[scenes][warnings]") {
  Random random(57, 0);
  const std::vector<std::pair<std::string, bool>> kinds{
      {"fixed = true", true}, {"motion = { velocity = [1, 0, 0] }", true}, {"velocity = [1, 0, 0]", false}};
  for (int draw = 0; draw < 12; ++draw) {
    const auto& [a, a_held] = kinds[static_cast<std::size_t>(random.uniform(0, 3))];
    const auto& [b, b_held] = kinds[static_cast<std::size_t>(random.uniform(0, 3))];
    std::string text =
        "run = { duration = 0.01 }\nmaterial.m = { density = 1000 }\n"
        "contact = { method = \"nonsmooth\", restitution = 0, friction = 0 }\n";
    for (const auto& [name, how] : {std::pair(std::string("a"), a), {std::string("b"), b}})
      text += fmt::format(
          "[[body]]\nname = \"{}\"\nshape = {{ sphere = {{ radius = 0.1 }} }}\nmaterial = \"m\"\n"
          "position = [{}, 0, 0]\n{}\n",
          name, name == "a" ? 0 : 1, how);
    text += contact_measure("c", "a", "b");
    const ReadResult read = read_scene_text(text, "scene.toml", {}, full_registry());
    INFO(text);
    REQUIRE(read.scene);
    REQUIRE(read.problems.size() == (a_held && b_held ? 1u : 0u));
    if (a_held && b_held) CHECK_THAT(read.problems[0].to_string(), Catch::Contains("no contacts with each other"));
  }
}

TEST_CASE("a measure between a body and itself is an error, between a group and itself is not", "[scenes][warnings]") {
  const std::string scene =
      "run = { duration = 0.01 }\nmaterial.m = { density = 1000 }\n"
      "contact = { method = \"nonsmooth\", restitution = 0, friction = 0 }\n"
      "[[body]]\nname = \"ball\"\nrepeat = 3\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\n"
      "position = [\"= i\", 0, 0]\n";
  for (const char* kind : {"contact", "hysteresis"})
    for (const auto& [a, b, fine] : {std::tuple("ball[1]", "ball[1]", false), std::tuple("ball[0]", "ball[2]", true),
                                     std::tuple("ball", "ball", true)}) {
      if (kind == std::string("hysteresis") && a == std::string("ball")) continue;  // of one contact
      const std::string text =
          scene + fmt::format("[[measure]]\nkind = \"{}\"\nbetween = [\"{}\", \"{}\"]\n", kind, a, b);
      const ReadResult read = read_scene_text(text, "scene.toml", {}, full_registry());
      INFO(text);
      for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
      CHECK(read.problems.empty() == fine);
      if (!fine) {
        REQUIRE(read.problems.size() == 1);
        CHECK_THAT(read.problems[0].to_string(),
                   Catch::StartsWith("scene.toml:12:") && Catch::Contains("'ball[1]' is one body and is named twice"));
      }
    }
}
