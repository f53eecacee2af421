// Scenes at the edge of what makes sense have defined results; a state that breaks is reported at its step, by its
// body.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string ground = R"(
material.bead = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.5, friction = 0.5 }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "bead"
fixed = true
)";
const std::string run_table = "run = { duration = 0.02, time_step = 1e-5, output_interval = 0.01 }\n";
const std::string gravity = "world = { gravity = [0, 0, -9.81] }\n";
const std::string bead = R"([[body]]
name = "bead"
shape = { sphere = { radius = 0.005 } }
material = "bead"
)";

std::string method(const char* name) { return std::string("contact.method=\"") + name + "\""; }

void check_finite(SceneRun& run) {
  const World& w = run.simulation().world;
  for (Slot s = 0; s < w.size(); ++s) {
    CHECK(w.position[s].allFinite());
    CHECK(w.velocity[s].allFinite());
  }
}

}  // namespace

TEST_CASE("a state that becomes non-finite stops the run at that step, with body and values", "[physics][failure]") {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    SceneRun run = start_text(run_table + gravity + ground + bead + "repeat = 2\nposition = [\"= 0.1*i\", 0, 0.1]\n");
    run.advance_to(7);
    REQUIRE(run.failure.empty());
    World& w = run.simulation().world;
    const Slot s = w.slot_of(static_cast<BodyId>(2));
    w.velocity[s].x() = bad;
    const auto failure = run.simulation().advance();
    REQUIRE(failure);
    CHECK(failure->kind == "non-finite state");
    CHECK(failure->step == 8);
    CHECK(failure->body == static_cast<BodyId>(2));
    CHECK_THAT(failure->text, Catch::Contains("body 2 became non-finite in step 8"));
    CHECK_THAT(failure->text, Catch::Contains("; no contact"));  // it fell free: nothing else is to blame
  }
}

TEST_CASE("a body that becomes non-finite in a contact names the contact", "[physics][failure]") {
  SceneRun run = start_text(run_table + gravity + ground + bead + "position = [0, 0, 0.00499]\n");
  run.advance_to(7);
  REQUIRE(run.failure.empty());
  World& w = run.simulation().world;
  w.angular_velocity[w.slot_of(static_cast<BodyId>(1))].x() = std::numeric_limits<double>::quiet_NaN();
  const auto failure = run.simulation().advance();
  REQUIRE(failure);
  CHECK(failure->body == static_cast<BodyId>(1));
  CHECK_THAT(failure->text, Catch::Contains("1 contacts, the worst with body 0: gap -"));
}

TEST_CASE("a body that leaves the domain is reported with id, step and place, or taken out and counted",
          "[physics][failure]") {
  const auto world = [](const char* outside) {
    return std::string("world = { domain = { min = [-1, -1, -1], max = [1, 1, 0.101], outside = \"") + outside +
           "\" } }\n";
  };
  const std::string rest = ground + bead + "position = [0, 0, 0.1]\nvelocity = [0, 0, 1]\n";
  SceneRun lost = start_text(run_table + world("error") + rest);
  lost.advance_to(0);
  CHECK_THAT(lost.failure,
             Catch::Contains("body 1 left the domain in step 101 ") ||
                 Catch::Contains("body 1 left the domain in step 100 "));  // 1 mm at 10 um a step, to rounding
  CHECK_THAT(lost.failure, Catch::Contains("at (0, 0, 0.101"));
  SceneRun taken = start_text(run_table + world("delete") + rest);
  taken.advance_to(200);  // the look is at every 100th step
  CHECK(taken.simulation().bodies_removed() == 0);
  taken.advance_to(201);
  CHECK(taken.simulation().bodies_removed() == 1);
  taken.advance_to(0);
  CHECK(taken.failure.empty());
  CHECK(taken.simulation().bodies_removed() == 1);
}

TEST_CASE("no free body, one body and no gravity are scenes like any other", "[physics][failure]") {
  for (const char* name : {"smooth", "nonsmooth"}) {
    SceneRun none = start_text(run_table + gravity + ground, {method(name)});
    none.advance_to(0);
    CHECK(none.failure.empty());
    CHECK(none.energy_error() == 0.0);
    SceneRun alone =
        start_text(run_table + ground + bead + "position = [0, 0, 0.1]\nvelocity = [0.25, 0, 0]\n", {method(name)});
    alone.advance_to(0);
    const World& w = alone.simulation().world;
    const Slot s = w.slot_of(static_cast<BodyId>(1));
    CHECK(w.position[s].x() == Approx(0.25 * 0.02).epsilon(1e-12));
    CHECK(w.position[s].z() == 0.1);
  }
}

TEST_CASE("bodies in one place part along a defined line without non-finite numbers", "[physics][failure]") {
  const std::string shape =
      GENERATE(std::string("{ sphere = { radius = 0.005 } }"), std::string("{ box = { size = [0.01, 0.01, 0.01] } }"),
               std::string("{ capsule = { radius = 0.003, length = 0.01 } }"));
  for (const char* name : {"smooth", "nonsmooth"}) {
    INFO(shape << ", " << name);
    const std::string text =
        run_table + ground +
        "[[body]]\nname = \"twin\"\nrepeat = 2\nmaterial = \"bead\"\nposition = [0, 0, 0.1]\nshape = " + shape;
    const std::vector<std::string> overrides{method(name), "run.time_step=2e-6", "run.duration=0.002"};
    SceneRun run = start_text(text, overrides), again = start_text(text, overrides);
    run.advance_to(0);
    again.advance_to(0);
    CHECK(run.failure.empty());
    check_finite(run);
    const World& w = run.simulation().world;
    const Vec3 &one = w.position[w.slot_of(static_cast<BodyId>(1))],
               &other = w.position[w.slot_of(static_cast<BodyId>(2))];
    CHECK((one - other).norm() > 1e-3);                             // they do part
    CHECK((0.5 * (one + other) - Vec3(0, 0, 0.1)).norm() < 1e-12);  // no push from outside
    CHECK(again.hash() == run.hash());
  }
}

TEST_CASE("denormal speeds and tiny gaps neither stop a run nor grow", "[physics][failure]") {
  for (const char* name : {"smooth", "nonsmooth"}) {
    SceneRun run = start_text(run_table + ground + bead + "position = [0, 0, 0.005]\nvelocity = [1e-310, 0, -1e-312]\n",
                              {method(name)});
    run.advance_to(0);
    CHECK(run.failure.empty());
    check_finite(run);
    const World& w = run.simulation().world;
    CHECK(w.velocity[w.slot_of(static_cast<BodyId>(1))].norm() < 1e-309);
  }
}

TEST_CASE("lengths and masses beyond measure are refused before the first step", "[physics][failure]") {
  // boxes of 1e155 m ended in signal 11; a sphere of infinite mass stood in the air as a fixed one; rods of 1 : 1e9
  // lost their least moment to rounding and were not finite after a step
  const auto refused = [](const std::string& form) {
    const std::string body =
        "[[body]]\nname = \"b\"\nshape = { " + form + " }\nmaterial = \"bead\"\nposition = [0, 0, 1]\n";
    try {
      start_text(run_table + gravity + ground + body, {method("nonsmooth")});
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string mass = "expected positive numbers", reach = "from its centre; expected 1e-60 to 1e+60 m";
  CHECK_THAT(refused("sphere = { radius = 1e110 }"), Catch::Contains(reach));
  CHECK_THAT(refused("sphere = { radius = 1e-110 }"), Catch::Contains(reach));
  Random random(7, 0);
  for (int k = 0; k < 20; ++k) {
    const double huge = std::pow(10.0, random.uniform(61.0, 300.0)), long_ = std::pow(10.0, random.uniform(9.0, 20.0));
    CHECK_THAT(refused(fmt::format("box = {{ size = [1, {}, 1] }}", huge)), Catch::Contains(reach));
    CHECK_THAT(refused(fmt::format("capsule = {{ radius = 1, length = {} }}", huge)), Catch::Contains(reach));
    CHECK_THAT(refused(fmt::format("box = {{ size = [{}, 0.1, 0.1] }}", long_)), Catch::Contains(mass));
  }
  CHECK(refused("box = { size = [1e5, 0.1, 0.1] }").empty());
}
