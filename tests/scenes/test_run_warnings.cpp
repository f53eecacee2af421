// What a run says of itself where its energy balance opens, of overlaps between the looks, of slow sources; what
// `check` predicts of measures.
#include <cmath>
#include <fstream>
#include <random>

#include "tests/support/captured_run.h"
#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/support/scene_text.h"
#include "viz_export/files/json_reader.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

/// A ball on a spring floor whose step is beyond what it bears: every contact throws it higher.
fs::path thrown_ball(const TemporaryFolder& folder, double dt, const std::string& more = {}) {
  const fs::path file = folder / "ball.toml";
  std::ofstream(file) << "run = { duration = 0.2, time_step = " << dt
                      << R"(, output_interval = 0.1, allow_unstable = true }
world = { gravity = [0, 0, -9.81] }
material.m = { density = 2500.0 }
contact = { method = "smooth", restitution = 1.0, friction = 0.0, smooth = { law = "linear", stiffness = 1e4 } }
)" << experiments::half_space_floor("m")
                      << R"([[body]]
name = "ball"
shape = { sphere = { radius = 0.01 } }
material = "m"
position = [0, 0, 0.0099]
)" << more;
  return file;
}

RunOptions into(const TemporaryFolder& folder) { return quiet_into(folder / "out"); }

}  // namespace

TEST_CASE("a run whose balance opens beyond a half ends as a violated bound", "[scenes][warnings]") {
  const TemporaryFolder folder;
  // omega = sqrt(k/m) = 977 /s: a step of 2.5 ms is beyond 2/omega
  const Captured run = run_of(thrown_ball(folder, 2.5e-3), into(folder));
  CHECK(run.code == exit_bound);
  CHECK_THAT(run.err,
             Catch::Contains("[bounds] energy_error") && Catch::Contains("warning: the energy balance is open"));
  const FlatJson summary = read_json(folder / "out" / "summary.json");
  CHECK(summary.text("status") == "bound_violated");
  CHECK_THAT(summary.text("warnings.0"), Catch::Contains("energy balance"));
  CHECK(summary.number("checks.energy_error.ok") == 0.0);
  CHECK(fs::exists(folder / "out" / "checkpoint.h5"));
}

TEST_CASE("a run that is cut off tells a balance that has opened since the last look", "[scenes][warnings]") {
  const TemporaryFolder folder;
  RunOptions cut = into(folder);
  cut.steps = 7;
  CHECK(run_of(thrown_ball(folder, 2.5e-3), cut).code == exit_done);
  const FlatJson summary = read_json(folder / "out" / "summary.json");
  REQUIRE(std::abs(summary.number("energy.relative_error").value()) > 1e-2);
  CHECK_THAT(summary.text("warnings.0"), Catch::Contains("energy balance"));
}

TEST_CASE("a bound of the scene's own takes the place of the watch over the balance", "[scenes][warnings]") {
  const TemporaryFolder folder;
  CHECK(run_of(thrown_ball(folder, 2.5e-3, "[bounds]\nenergy_error = 1e9\n"), into(folder)).code == exit_done);
  CHECK_THAT(read_json(folder / "out" / "summary.json").text("warnings.0"), Catch::Contains("energy balance"));
}

TEST_CASE("where nothing is wrong there is no warning; strict runs end with 1 where there is one",
          "[scenes][warnings]") {
  const TemporaryFolder folder;
  RunOptions strict = into(folder);
  strict.strict = true;
  strict.force = true;
  CHECK(run_of(thrown_ball(folder, 5e-5), strict).code == exit_done);
  CHECK(read_json(folder / "out" / "summary.json").text("warnings.0").empty());
  CHECK(run_of(thrown_ball(folder, 2.5e-3, "[bounds]\nenergy_error = 1e9\n"), strict).code == exit_bound);
}

TEST_CASE("the largest overlap is that of all steps, and a bound on it holds in each", "[scenes][warnings]") {
  const TemporaryFolder folder;
  // 1 m/s: pi/omega = 3.2 ms in the floor, between two looks of 100 steps each 0.05 ms; v/omega = 1.02 mm deep
  const std::string fast = "velocity = [0, 0, -1]\n";
  CHECK(run_of(thrown_ball(folder, 5e-5, fast), into(folder)).code == exit_done);
  const double overlap = read_json(folder / "out" / "summary.json").number("overlap.max").value();
  CHECK(overlap == Approx(1.04e-3).epsilon(0.03));
  CHECK(read_json(folder / "out" / "summary.json").number("overlap.max_relative").value() == Approx(overlap / 0.01));
  RunOptions again = into(folder);
  again.force = true;
  CHECK(run_of(thrown_ball(folder, 5e-5, fast + "[bounds]\noverlap_relative = 0.09\n"), again).code == exit_bound);
}

TEST_CASE("the largest overlap counts the parts of divided steps, and the start", "[scenes][warnings][adaptive]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 6; ++k) {
    const TemporaryFolder folder;
    const bool starts_deep = k % 2 == 0;
    const double radius = std::pow(10.0, -3.0 + 2.0 * unit(random)), share = 0.35 + 0.6 * unit(random);
    const double speed = std::pow(10.0, 2.0 * unit(random)), depth = share * radius;
    // m v^2/2 = 8/15 E*/2 sqrt(R) d^(5/2), two like bodies of Poisson's ratio 0; far above the floor a fast ball makes
    // steps long against the impact
    const double energy = 2.0 / 3.0 * std::acos(-1.0) * 1000.0 * std::pow(radius, 3) * speed * speed;
    const double modulus = energy / (4.0 / 15.0 * std::sqrt(radius) * std::pow(depth, 2.5));
    const auto scene = [&](double bound) {
      std::ofstream out(folder / "scene.toml");
      out.precision(17);
      out << "run = { duration = " << 6.0 * radius / speed << ", time_step = \"" << (starts_deep ? "auto" : "adaptive")
          << "\" }\nworld.gravity = [0, 0, 0]\nmaterial.m = { density = 1000, youngs_modulus = " << modulus
          << ", poissons_ratio = 0 }\n"
          << "contact = { method = \"smooth\", restitution = 1, friction = 0, smooth = { law = \"hertz\" } }\n"
          << experiments::half_space_floor("m") << "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = " << radius
          << " } }\nmaterial = \"m\"\n"
          << "position = [0, 0, " << (starts_deep ? 1.0 - share : 2.0) * radius << "]\nvelocity = [0, 0, "
          << (starts_deep ? speed : -speed) << "]\n[bounds]\noverlap_relative = " << bound << "\n";
    };
    INFO("share " << share << ", radius " << radius << ", speed " << speed << ", modulus " << modulus);
    RunOptions again = into(folder);
    again.force = true;
    scene(1.1 * share);
    CHECK(run_of(folder / "scene.toml", again).code == exit_done);
    const FlatJson summary = read_json(folder / "out" / "summary.json");
    const double relative = summary.number("overlap.max_relative").value();
    CHECK(relative == Approx(share).epsilon(starts_deep ? 1e-9 : 0.05));  // ten steps and more an impact
    CHECK(relative == Approx(summary.number("overlap.max").value() / radius).epsilon(1e-12));
    scene(0.9 * share);
    CHECK(run_of(folder / "scene.toml", again).code == exit_bound);
  }
}

TEST_CASE("bodies that overlap by more than half a radius are reported", "[scenes][warnings]") {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 12; ++k) {
    const TemporaryFolder folder;
    // v/omega of an elastic impact, with what the weight adds: (g/omega^2)(1 + sqrt(1 + (v omega/g)^2))
    const double share = k % 2 == 0 ? 0.2 + 0.28 * unit(random) : 0.52 + 0.4 * unit(random), omega = 977.2;
    const double speed = omega * (share * 0.01 - 9.81 / (omega * omega));
    CHECK(run_of(thrown_ball(folder, 1e-5, "velocity = [0, 0, " + std::to_string(-speed) + "]\n"), into(folder)).code ==
          exit_done);
    const FlatJson summary = read_json(folder / "out" / "summary.json");
    INFO(share << ": " << summary.text("warnings.0"));
    CHECK(summary.number("overlap.max_relative").value() == Approx(share).epsilon(0.02));
    CHECK((summary.text("warnings.0").find("of the radius of the smaller one") != std::string::npos) == (share > 0.5));
  }
}

TEST_CASE("a source that cannot keep its rate is told, with how many have come", "[scenes][warnings]") {
  std::mt19937 random(5);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int k = 0; k < 6; ++k) {
    const TemporaryFolder folder;
    const fs::path file = folder / "source.toml";
    const double r = std::pow(10.0, draw(-3, 0)), side = r * draw(4, 8), fall = std::sqrt(r / 9.81);
    // the box of the source holds a dozen bodies, which need some `fall` each to leave it
    const bool too_fast = k % 2 == 0;
    const double rate = (too_fast ? draw(20, 60) : draw(0.1, 0.5)) / fall, duration = 20 * fall;
    std::ofstream(file) << "run = { duration = " << duration << ", time_step = " << 1e-3 * fall
                        << " }\nworld = { gravity = [0, 0, -9.81] }\nmaterial.m = { density = 2500 }\n"
                        << "contact = { method = \"smooth\", restitution = 0.5, friction = 0.3, smooth = { law = "
                        << "\"linear\", stiffness = " << 1e8 * r * r << " } }\n"
                        << "[shape.s]\nsphere = { radius = " << r << " }\n[[fill]]\nname = \"sand\"\nshape = \"s\"\n"
                        << "material = \"m\"\nmethod = \"pour\"\ncount = 5000\nrate = " << rate
                        << "\nregion = { box = { min = [0, 0, 0], max = [" << side << ", " << side << ", " << 4 * r
                        << "] } }\n";
    const Captured run = run_of(file, into(folder));
    INFO(run.err);
    const FlatJson summary = read_json(folder / "out" / "summary.json");
    const double came = summary.number("bodies").value(), due = std::floor(rate * duration) + 1;
    const std::string told = summary.text("warnings.0");
    if (!too_fast) {
      CHECK(std::abs(came - due) < 3);
      CHECK(told.empty());
      continue;
    }
    CHECK(came < 0.9 * due);
    CHECK_THAT(told, Catch::Contains("'sand' is slower than its rate: " + std::to_string(static_cast<int>(came)) +
                                     " bodies have come, "));
  }
}

TEST_CASE("measures that look at every step are predicted", "[scenes][predicted]") {
  const TemporaryFolder folder;
  const fs::path file = folder / "measured.toml";
  const auto steps = [&](const std::string& measures) {
    std::ofstream(file) << "run = { duration = 2.0, time_step = 1e-5 }\nworld = { gravity = [0, 0, -9.81] }\n"
                           "material.m = { density = 2500, youngs_modulus = \"1 MPa\", poissons_ratio = 0.3 }\n"
                           "contact = { method = \"smooth\", restitution = 0.5, friction = 0 }\n[[body]]\n"
                           "repeat = [8, 8, 8]\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\n"
                           "position = [\"= 0.01999*i\", \"= 0.01999*j\", \"= 0.01999*k\"]\n" +
                               measures;
    double least = std::numeric_limits<double>::infinity();  // what other programs do makes a step longer, not shorter
    for (int turn = 0; turn < 3; ++turn) {
      const std::string text = captured([&] { return command_check({file.string(), {}}); }).out;
      const std::size_t end = text.find(" s of steps"), begin = text.rfind(' ', end - 1);
      REQUIRE(end != std::string::npos);
      least = std::min(least, std::stod(text.substr(begin)));
    }
    return least;
  };
  const std::string region = "region = { box = { min = [-1, -1, -1], max = [1, 1, 1] } }\n";
  const std::string stress = "[[measure]]\nkind = \"stress\"\n" + region;
  const double none = steps(""), sparse = steps(stress + "interval = 0.01\n"), one = steps(stress);
  CHECK(sparse < 1.5 * none);
  CHECK(one > 2.0 * none);
}

TEST_CASE("bodies that are taken out or poured in are no error of momentum", "[scenes][warnings]") {
  std::mt19937 engine(5);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution(low, high)(engine); };
  // by a time, by an outlet, as they leave the domain, as a stage begins, by a source
  const std::string box = "box = { min = [-2, -2, 0.5], max = [2, 2, 2] }";
  const std::vector<std::string> ways{
      "remove", "[[outlet]]\nname = \"out\"\nregion = { " + box + " }\n", "outside",
      "[[stage]]\nname = \"one\"\nduration = 0.05\n[[stage]]\nname = \"two\"\nduration = 0.05\n"
      "body.b = { remove = true }\n",
      "[shape.g]\nsphere = { radius = 0.01 }\n[[fill]]\nname = \"rain\"\nshape = \"g\"\nmaterial = \"m\"\ncount = "
      "5\nmethod = \"pour\"\nrate = 60\nvelocity = [1, 2, 0]\nregion = { box = { min = [0.6, 0, 0], max = [0.9, 0.3, "
      "0.3] } }\n"};
  for (std::size_t k = 0; k < ways.size(); ++k) {
    INFO(ways[k]);
    const TemporaryFolder folder;
    const bool staged = k == 3, domain = k == 2;
    std::ofstream file(folder / "scene.toml");
    file << "run = { time_step = 1e-4, output_interval = 0.02" << (staged ? "" : ", duration = 0.1") << " }\n"
         << "world = { gravity = [" << draw(-1, 1) << ", 0, -3]"
         << (domain ? ", domain = { min = [-9, -9, -9], max = [9, 9, 0.6], outside = \"delete\" }" : "") << " }\n"
         << "material.m = { density = 2500.0, youngs_modulus = 1e7, poissons_ratio = 0.3 }\n"
         << "contact = { method = \"smooth\", restitution = 0.5, friction = 0.5 }\n";
    for (const char* name : {"a", "b", "c"})
      file << "[[body]]\nname = \"" << name << "\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\n"
           << "position = [" << draw(-0.5, 0.5) << ", " << draw(-0.5, 0.5) << ", " << (name[0] == 'b' ? 0.3 : 0.0)
           << "]\nvelocity = [" << draw(-1, 1) << ", " << draw(-1, 1) << ", " << (name[0] == 'b' ? 6.0 : 0.0) << "]\n"
           << (k == 0 && name[0] == 'b' ? "remove_at = 0.043\n" : "");
    file << (k == 0 || domain ? "" : ways[k]);
    file.close();
    const Captured run = run_of(folder / "scene.toml", into(folder));
    INFO(run.err);
    REQUIRE(run.code == exit_done);
    const FlatJson summary = read_json(folder / "out" / "summary.json");
    CHECK(summary.number("bodies") == (k == 4 ? 8.0 : 2.0));
    CHECK(summary.number("momentum_error").value() < 1e-12);
  }
}
