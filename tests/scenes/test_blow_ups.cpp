// Time steps beyond what a scene bears, whatever the scene: never done in silence, with nothing of the scene's own that
// watches.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "engine/units/random.h"
#include "tests/support/captured_run.h"
#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "viz_export/files/json_reader.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

constexpr double radius = 0.005, mass = 2500 * 4.19 * radius * radius * radius;

std::string plane(const std::string& name, const std::string& normal, const std::string& at, const std::string& state) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nshape = {{ half_space = {{ normal = {} }} }}\nposition = {}\nmaterial = \"m\"\n{}\n",
      name, normal, at, state);
}

std::string floor_plane() { return plane("floor", "[0, 0, 1]", "[0, 0, 0]", "fixed = true"); }

std::string fill(int count, double half, double top) {
  return fmt::format(
      "[[fill]]\nshape = \"s\"\nmaterial = \"m\"\ncount = {0}\nregion = {{ box = {{ min = [-{1}, -{1}, 0], max = [{1}, "
      "{1}, {2}] }} }}\n",
      count, half, top);
}

std::string press(Random& random) {
  const int n = 1 + static_cast<int>(random.uniform(0.0, 4.0));
  const double force = 9.81 * mass * std::pow(10.0, random.uniform(1.0, 3.0));
  const std::string servo =
      fmt::format("motion = {{ servo = {{ force = {}, direction = [0, 0, -1], mass = {}, max_speed = 0.2 }} }}", force,
                  mass * random.uniform(0.5, 5.0));
  return floor_plane() +
         fmt::format(
             "[[body]]\nname = \"b\"\nrepeat = {}\nshape = \"s\"\nmaterial = \"m\"\nvelocity = [0.002, 0.001, 0]\n"
             "position = [0, 0, \"= (1 + 2*i)*{}\"]\n",
             n, radius) +
         plane("plate", "[0, 0, -1]", fmt::format("[0, 0, {}]", (2 * n + 0.02) * radius), servo);
}

std::string stack(Random& random) {
  return floor_plane() +
         fmt::format(
             "[[body]]\nname = \"b\"\nrepeat = {0}\nshape = {{ box = {{ size = [{1}, {2}, {3}] }} }}\nmaterial = "
             "\"m\"\nvelocity = [0.002, 0.001, 0]\nposition = [0, 0, \"= (0.5 + i)*{3}\"]\n",
             1 + static_cast<int>(random.uniform(0.0, 4.0)), 2 * radius * random.uniform(1.0, 2.0),
             2 * radius * random.uniform(1.0, 2.0), radius);
}

std::string bed(Random&) {
  std::string walls;
  const char* const normals[] = {"[1, 0, 0]", "[-1, 0, 0]", "[0, 1, 0]", "[0, -1, 0]"};
  const char* const places[] = {"[-0.015, 0, 0]", "[0.015, 0, 0]", "[0, -0.015, 0]", "[0, 0.015, 0]"};
  for (int k = 0; k < 4; ++k) walls += plane(fmt::format("w{}", k), normals[k], places[k], "fixed = true");
  return floor_plane() + walls + fill(30, 0.015, 0.1);
}

std::string drum(Random& random) {
  return fmt::format(
             "[[body]]\nname = \"drum\"\nshape = {{ tube = {{ radius = 0.05, length = 0.03, ends = \"closed\" }} }}\n"
             "euler_deg = [90, 0, 0]\nmaterial = \"m\"\nmotion = {{ rotation = {{ axis = [0, 1, 0], rate = {}, about = "
             "[0, 0, 0] }} }}\n",
             random.uniform(2.0, 8.0)) +
         "[[fill]]\nshape = \"s\"\nmaterial = \"m\"\ncount = 30\n"
         "region = { box = { min = [-0.03, -0.015, -0.03], max = [0.03, 0.015, 0.03] } }\n";
}

/// Boxes that fall onto each other at an angle, and balls on springs to the ground.
std::string boxes(Random& random) {
  return floor_plane() +
         fmt::format(
             "[[body]]\nname = \"b\"\nrepeat = {0}\nshape = {{ box = {{ size = [{1}, {2}, {1}] }} }}\nmaterial = "
             "\"m\"\nposition = [\"= {3}*sin(2.1*i)\", 0, \"= (1 + 1.6*i)*{2}\"]\neuler_deg = [{4}, {5}, 20]\n",
             2 + static_cast<int>(random.uniform(0.0, 6.0)), 2 * radius, 2.6 * radius, 0.6 * radius,
             random.uniform(0.0, 90.0), random.uniform(0.0, 90.0));
}

std::string springs(Random& random) {
  std::string out = floor_plane();
  for (int k = 0; k < 3; ++k)
    out += fmt::format(
        "[[body]]\nname = \"b{0}\"\nshape = \"s\"\nmaterial = \"m\"\nvelocity = [0.01, 0, 0]\nposition = [0, 0, {1}]\n"
        "[[spring]]\nname = \"k{0}\"\nbody = \"b{0}\"\nattachment = [{2}, 0, 0]\nstiffness = [{3}, {3}, {4}]\n",
        k, (1 + 2.2 * k) * radius, 0.3 * radius, std::pow(10.0, random.uniform(2.0, 4.0)),
        std::pow(10.0, random.uniform(2.0, 4.0)));
  return out;
}

struct Seen {
  int code = 0;
  double kinetic = 0.0, open = 0.0;  ///< the largest; the balance at the end
  bool warned = false;
};

Seen seen(const TemporaryFolder& folder, const std::string& text, const std::string& step) {
  const fs::path file = folder / "scene.toml";
  std::ofstream(file) << "run = { duration = 0.2, output_interval = 0.2, time_step = " << step << " }\n" << text;
  RunOptions options = quiet_into(folder / "out");
  options.force = true;
  Seen out;
  out.code = run_of(file, options).code;
  if (out.code != exit_done) return out;
  const FlatJson summary = read_json(folder / "out" / "summary.json");
  out.kinetic = summary.number("measures.e.kinetic.max").value();
  out.open = summary.number("energy.relative_error").value();
  out.warned = !summary.text("warnings.0").empty();
  return out;
}

double limit_of(const TemporaryFolder& folder, const std::string& text) {
  const fs::path file = folder / "scene.toml";
  std::ofstream(file) << "run = { duration = 0.2, output_interval = 0.2 }\n" << text;
  const std::string check = captured([&] { return command_check({file.string(), {}}); }).out;
  const std::size_t at = check.find("its limit");
  REQUIRE(at != std::string::npos);
  return std::stod(check.substr(at + 9));
}

}  // namespace

TEST_CASE("what a step beyond the limit throws off is never done in silence", "[scenes][warnings][long]") {
  using Kind = std::string (*)(Random&);
  int ended = 0;
  for (const Kind kind : {Kind{press}, Kind{stack}, Kind{bed}, Kind{drum}, Kind{boxes}, Kind{springs}})
    for (std::uint32_t draw = 0; draw < 6; ++draw) {
      Random random(41, draw);
      const TemporaryFolder folder;
      const char* const law = draw % 3 == 0   ? "law = \"linear\", stiffness = 5e3"
                              : draw % 3 == 1 ? "law = \"hertz\""
                                              : "law = \"hertz-mindlin\"";
      const std::string text =
          fmt::format(
              "world = {{ gravity = [0, 0, -9.81] }}\nmaterial.m = {{ density = 2500, youngs_modulus = {}, "
              "poissons_ratio = 0.25 }}\nshape.s = {{ sphere = {{ radius = {} }} }}\n"
              "contact = {{ method = \"smooth\", restitution = {}, friction = {}, smooth = {{ {} }} }}\n"
              "[[measure]]\nname = \"e\"\nkind = \"energy\"\ninterval = 0\n",
              std::pow(10.0, random.uniform(5.7, 7.0)), radius, random.uniform(0.0, 0.9), random.uniform(0.0, 0.6),
              law) +
          kind(random);
      const double beyond = random.uniform(1.2, 4.0), step = beyond * limit_of(folder, text);
      INFO(text);
      const Seen right = seen(folder, text, "\"auto\"");
      REQUIRE(right.code == exit_done);
      const Seen wrong = seen(folder, text, fmt::format("{}, allow_unstable = true", step));
      INFO("draw " << draw << ", " << beyond << " times the limit, " << step << " s: kinetic " << wrong.kinetic
                   << " J for " << right.kinetic << ", open by " << wrong.open);
      ended += wrong.code != exit_done;
      if (wrong.code != exit_done) {
        CHECK((wrong.code == exit_bound || wrong.code == exit_failed));
        continue;
      }
      CHECK(wrong.kinetic < 100.0 * right.kinetic);
      if (std::abs(wrong.open) > 0.02) CHECK(wrong.warned);
      CHECK(std::abs(wrong.open) <= 0.5);
    }
  CHECK(ended >= 12);
}

TEST_CASE("intervals longer than any count of steps never come", "[scenes]") {
  // 1e17 steps and more had no whole number of 64 bits: a division by zero
  const TemporaryFolder folder;
  Random random(17, 0);
  for (const char* key : {"run.output_interval", "run.checkpoint_interval", "measure.0.interval"}) {
    const double interval = std::pow(10.0, random.uniform(13.0, 300.0));
    const fs::path file = folder / "falling.toml";
    std::ofstream(file) << R"(run = { duration = 0.01, time_step = 1e-3 }
world = { gravity = [0, 0, -9.81] }
material.m = { density = 2500.0 }
contact = { method = "smooth", restitution = 0.5, friction = 0.0, smooth = { law = "linear", stiffness = 1e5 } }
body = [{ name = "ball", shape = { sphere = { radius = 0.1 } }, material = "m" }]
measure = [{ name = "energy", kind = "energy", interval = 1e-3 }]
)";
    RunOptions options = quiet_into(folder / "out");
    options.force = true;
    const Captured run = run_of(file, options, {fmt::format("{}={}", key, interval)});
    INFO(key << " = " << interval << "\n" << run.err);
    CHECK(run.code == exit_done);
    CHECK(read_json(folder / "out" / "summary.json").number("steps") == 10.0);
  }
}
