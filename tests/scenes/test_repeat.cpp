// `repeat` of springs and measures: copies as they would be written one by one. CommonMotion seen from a body that
// moves.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;

namespace {

const std::string chain_head =
    "[run]\nduration = 0.02\ntime_step = 1e-4\noutput_interval = 0.01\n[material.a]\ndensity = 1000\n"
    "youngs_modulus = 1e6\npoissons_ratio = 0.3\n[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0\n"
    "[[body]]\nname = \"ball\"\nrepeat = 5\nmaterial = \"a\"\nshape = { sphere = { radius = 0.01 } }\n"
    "position = [\"= 0.03*i + 0.002*(i - 2)^2\", 0, 0]\n";

ReadResult read_chain(const std::string& tail) {
  return read_scene_text(chain_head + tail, "chain.toml", {}, full_registry());
}

std::string told_of_chain(const ReadResult& result) {
  std::string text;
  for (const auto& problem : result.problems) text += problem.to_string() + "\n";
  return text;
}

Scene chain(const std::string& tail) {
  ReadResult result = read_chain(tail);
  INFO(told_of_chain(result));
  REQUIRE(result.scene);
  REQUIRE(result.problems.empty());
  return std::move(*result.scene);
}

std::string hash_of_chain(Scene scene) {
  const TemporaryFolder folder;
  Session session(assemble(std::move(scene)), {}, folder / "out");
  REQUIRE(session.run({}, true) == Ending::completed);
  return session.summary().state_hash;
}

}  // namespace

TEST_CASE("a chain of repeated springs is that of springs written one by one", "[scenes][reader][repeat]") {
  const std::string repeated =
      "[[spring]]\nname = \"link\"\nrepeat = 4\nbody = \"ball[i]\"\nto = \"ball[i + 1]\"\n"
      "stiffness = [\"= 100 + 10*i\", 0, 0]\n";
  std::string written;
  for (int k = 0; k < 4; ++k)
    written += "[[spring]]\nname = \"link[" + std::to_string(k) + "]\"\nbody = \"ball[" + std::to_string(k) +
               "]\"\nto = \"ball[" + std::to_string(k + 1) + "]\"\nstiffness = [" + std::to_string(100 + 10 * k) +
               ", 0, 0]\n";
  const Scene scene = chain(repeated);
  REQUIRE(scene.springs.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(scene.springs[k].name == "link[" + std::to_string(k) + "]");
    CHECK(scene.springs[k].body == k);
    CHECK(scene.springs[k].to == k + 1);
    CHECK(scene.springs[k].stiffness == Vec3(100.0 + 10.0 * static_cast<double>(k), 0, 0));
  }
  CHECK(hash_of_chain(chain(repeated)) == hash_of_chain(chain(written)));
}

TEST_CASE("repeated measures look each at its own body, and bounds find them by name", "[scenes][reader][repeat]") {
  const Scene scene = chain(
      "[[measure]]\nname = \"place\"\nrepeat = 3\nkind = \"position\"\nbody = \"ball[2*i]\"\ninterval = \"= 0.01*(1 + "
      "i)\"\n"
      "[[measure]]\nkind = \"contact\"\nrepeat = [2, 2]\nbetween = [\"ball[i]\", \"ball[3 + min(j, 1)]\"]\n"
      "[[bounds.measure]]\nmeasure = \"place[2]\"\ncomponent = \"x\"\nbelow = 1\nthen = \"stop\"\n");
  REQUIRE(scene.measures.size() == 7);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(scene.measures[k].name == "place[" + std::to_string(k) + "]");
    CHECK(scene.measures[k].interval == Approx(0.01 * (1.0 + static_cast<double>(k))));
    REQUIRE(scene.measures[k].bodies.size() == 1);
    CHECK(scene.measures[k].bodies[0].bodies.at(0).first == 2 * k);
  }
  CHECK(scene.measures[5].name == "contact[1,0]");
  CHECK(scene.measures[5].bodies.at(0).bodies.at(0).first == 1);
  CHECK(scene.measures[6].bodies.at(1).bodies.at(0).first == 4);
}

TEST_CASE("bodies that are repeated along three axes are named with three indices", "[scenes][reader][repeat]") {
  const std::string grid =
      "[[body]]\nname = \"grid\"\nrepeat = [2, 3, 4]\nmaterial = \"a\"\nshape = { sphere = { radius = 0.01 } }\n"
      "position = [\"= 0.1*i\", \"= 1 + 0.1*j\", \"= 0.1*k\"]\n";
  const Scene scene =
      chain(grid + "[[measure]]\nrepeat = [2, 3, 4]\nkind = \"position\"\nbody = \"grid[1 - i, j, max(k, 0)]\"\n");
  REQUIRE(scene.measures.size() == 24);
  for (std::size_t k = 0; k < 24; ++k)
    CHECK(scene.measures[k].bodies.at(0).bodies.at(0).first == 5 + (k < 12 ? k + 12 : k - 12));
}

TEST_CASE("what is wrong with a repeated table is reported once, with what was found", "[scenes][reader][repeat]") {
  const auto one = [](const std::string& tail) {
    const ReadResult result = read_chain(tail);
    INFO(told_of_chain(result));
    REQUIRE(result.problems.size() == 1);
    return result.problems[0].text;
  };
  const std::string spring = "[[spring]]\nname = \"s\"\nstiffness = [1, 0, 0]\n";
  CHECK(one(spring + "repeat = 5\nbody = \"ball[i]\"\nto = \"ball[i + 1]\"\n").find("unknown body 'ball[5]'") == 0);
  CHECK(one(spring + "repeat = 2\nbody = \"ball[i/2]\"\n") ==
        "[[spring]] 's' 'ball[i/2]': expected a whole number from 0 in the brackets, found 0.5");
  CHECK(one(spring + "repeat = 2\nbody = \"ball[n*i]\"\n").find("unknown name 'n'") != std::string::npos);
  CHECK(one(spring + "repeat = 0\nbody = \"ball[i]\"\n").find("repeat") != std::string::npos);
  CHECK(one("[[spring]]\nrepeat = 3\nbody = \"ball[i]\"\n").find("neither stiffness nor damping") != std::string::npos);
}

TEST_CASE("drift is seen from a table that moves and turns as from the ground where it stands",
          "[scenes][measures][repeat]") {
  // both are points of one rigid velocity field v + w x (x - c): from the table the rider stands still, the walker goes
  // 0.2 t sideways and 0.05 t down. Midpoints of a turn by w dt err by (w dt)^3/24 of the radius each: 2e-10 m in all.
  const std::string moves =
      "{ velocity = [0.3, 0, 0.1] }, { rotation = { axis = [0, 0, 1], rate = 2, about = [0.5, 0, 0] } }";
  const auto body = [](const std::string& name, const std::string& place, const std::string& motion) {
    return "[[body]]\nname = \"" + name +
           "\"\nmaterial = \"a\"\nshape = { box = { size = [0.02, 0.02, 0.02] } }\nposition = " + place +
           "\nmotion = [" + motion + "]\n";
  };
  const auto drift = [](const std::string& name, const std::string& from) {
    return "[[measure]]\nname = \"" + name + "\"\nkind = \"drift\"\nbody = \"" + name + "\"\ninterval = 0.01\n" +
           (from.empty() ? "" : "relative_to = \"" + from + "\"\n");
  };
  const std::string tail = body("table", "[0, 1, 0]", moves) + body("rider", "[0.4, 1.3, 0.2]", moves) +
                           body("sled", "[0, 2, 0]", "{ velocity = [0.3, 0, 0.1] }") +
                           body("walker", "[0, 2.5, 0]", "{ velocity = [0.3, 0.2, 0.05] }") +
                           body("seen", "[0, 4, 0]", "{ velocity = [0.3, 0, 0.1] }") + drift("rider", "table") +
                           drift("walker", "sled") + drift("seen", "");
  const TemporaryFolder folder;
  Session session(assemble(chain(tail)), {}, folder / "out");
  REQUIRE(session.run({}, true) == Ending::completed);
  const RunSummary summary = session.summary();
  const double t = 0.02;
  CHECK(std::abs(summary.measures.at("rider").at("distance").last) < 1e-9);
  CHECK(std::abs(summary.measures.at("rider").at("sag").last) < 1e-12);
  CHECK(summary.measures.at("walker").at("distance").last == Approx(0.2 * t).epsilon(1e-9));
  CHECK(summary.measures.at("walker").at("sag").last == Approx(0.05 * t).epsilon(1e-9));
  CHECK(summary.measures.at("seen").at("distance").last == Approx(0.3 * t).epsilon(1e-9));
  CHECK(summary.measures.at("seen").at("sag").last == 0.0);  // it rises
}

TEST_CASE("NAME[n] is the n-th body of a table repeated by several counts", "[scenes][reader][repeat]") {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> count(1, 5);
  for (int trial = 0; trial < 12; ++trial) {
    const int l = count(random), m = count(random), n = count(random);
    const std::string grid = fmt::format(
        "[[body]]\nname = \"grid\"\nrepeat = [{}, {}, {}]\nmaterial = \"a\"\nshape = {{ sphere = {{ radius = 0.01 }} "
        "}}\n"
        "position = [\"= i\", \"= j + 1\", \"= k\"]\n",
        l, m, n);
    const auto measured = [&](const std::string& name) {
      return read_chain(grid + "[[measure]]\nname = \"x\"\nkind = \"position\"\nbody = \"" + name + "\"\n");
    };
    int number = 0;
    for (int i = 0; i < l; ++i)
      for (int j = 0; j < m; ++j)
        for (int k = 0; k < n; ++k, ++number) {
          const auto by_number = measured(fmt::format("grid[{}]", number));
          const auto by_indices = measured(fmt::format("grid[{},{},{}]", i, j, k));
          REQUIRE(by_number.scene);
          REQUIRE(by_indices.scene);
          const auto& body = by_number.scene->measures[0].bodies[0].bodies[0];
          CHECK(body.first == by_indices.scene->measures[0].bodies[0].bodies[0].first);
          CHECK(by_number.scene->bodies[body.first].position == Vec3(i, j + 1, k));
        }
    CHECK_THAT(told_of_chain(measured(fmt::format("grid[{}]", number))),
               Catch::Contains(fmt::format("its bodies are grid[0,0,0] to grid[{},{},{}]", l - 1, m - 1, n - 1)));
  }
}
