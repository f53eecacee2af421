// Hollow tubes and cones as walls of whole runs: periods, energies, drums, hoppers, bits.
#include <cmath>
#include <numbers>
#include <random>

#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// smooth: the rest of [contact].
std::string tube_head(const std::string& run, const std::string& contact) {
  return "run = { output_interval = 1.0, " + run + " }\nworld = { gravity = [0, 0, -9.81] }\n" +
         "material.m = { density = 2500.0, youngs_modulus = \"5 MPa\", poissons_ratio = 0.3 }\ncontact = { " + contact +
         " }\n";
}

std::string wall(const std::string& shape, const std::string& rest) {
  return "[[body]]\nname = \"wall\"\nmaterial = \"m\"\nshape = { " + shape + " }\n" + rest + "\n";
}

/// Seconds from one rise of x through 0 to the one after the next.
double period_of(SceneRun& run, double step) {
  std::vector<double> crossings;
  const auto x = [&] { return run.simulation().world.position[run.simulation().world.slot_of(BodyId{1})].x(); };
  double before = x();
  for (std::uint64_t n = 1; crossings.size() < 3 && n < 60000; ++n) {
    run.advance_to(n);
    if (before < 0.0 && x() >= 0.0) crossings.push_back(step * (static_cast<double>(n) - x() / (x() - before)));
    before = x();
  }
  REQUIRE(crossings.size() == 3);
  return 0.5 * (crossings[2] - crossings[0]);
}

double rolled_period(double friction) {
  const double step = 4e-5;
  SceneRun run = start_text(tube_head("duration = 3.0, time_step = 4e-5",
                                      "method = \"smooth\", restitution = 0.3, friction = " + std::to_string(friction) +
                                          ", smooth = { law = \"hertz-mindlin\" }") +
                            wall("tube = { radius = 0.1, length = 0.2 }", "fixed = true\neuler_deg = [90, 0, 0]") +
                            "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = { radius = 0.01 } }\n"
                            "position = [\"= -0.09*sin(0.1)\", 0, \"= -0.09*cos(0.1)\"]\n");
  return period_of(run, step);
}

}  // namespace

TEST_CASE("a ball swings in a tube with the period of a pendulum of R - r, one that rolls sqrt(7/5) times slower",
          "[physics][hollow]") {
  // 2 pi sqrt(l/g) (1 + a^2/16) with l = R - r and an amplitude a of 0.1; the ball sinks by 1e-4 of l
  const double pendulum = 2.0 * std::numbers::pi * std::sqrt(0.09 / 9.81) * (1.0 + 0.01 / 16.0);
  CHECK(rolled_period(0.0) == Approx(pendulum).epsilon(5e-4));
  CHECK(rolled_period(0.6) == Approx(std::sqrt(1.4) * pendulum).epsilon(1e-3));
}

TEST_CASE("balls that bounce in a tilted closed tube or cone without loss keep their energy", "[physics][hollow]") {
  for (const char* shape : {"tube = { radius = 0.1, length = 0.3, ends = \"closed\" }",
                            "cone = { radii = [0.03, 0.2], length = 0.2, ends = \"closed\" }"}) {
    SceneRun run = start_text(
        tube_head(
            "duration = 1.0, time_step = 2e-5",
            "method = \"smooth\", restitution = 1.0, friction = 0.0, smooth = { law = \"linear\", stiffness = 2e4 }") +
        wall(shape, "fixed = true\neuler_deg = [50, 20, 0]") +
        "[[body]]\nname = \"ball\"\nrepeat = 3\nmaterial = \"m\"\nshape = { sphere = { radius = 0.01 } }\n"
        "position = [\"= 0.03*i - 0.02\", 0.01, 0]\nvelocity = [0.3, \"= 0.5*i\", 1.0]\n");
    run.advance_to(50000);
    CHECK(run.failure.empty());
    // second order: (omega dt)^2 = (1400 2e-5)^2 = 8e-4 of the energy of a contact while it lasts
    CHECK(std::abs(run.energy_error()) < 1e-3);
    for (Slot s = 0; s < 4; ++s) CHECK(run.simulation().world.position[s].norm() < 0.2);
  }
}

namespace {

std::string drum(const std::string& grain) {
  return tube_head("duration = 1.0, time_step = 1e-4",
                   "method = \"smooth\", restitution = 0.5, friction = 0.5, smooth = { law = \"hertz-mindlin\" }") +
         wall("tube = { radius = 0.05, length = 0.05, ends = \"closed\" }",
              "euler_deg = [90, 0, 0]\nmotion = { rotation = { axis = [0, 1, 0], rate = 6.0, about = [0, 0, 0] } }") +
         "[[body]]\nname = \"grain\"\nrepeat = [6, 4, 4]\nmaterial = \"m\"\nshape = { " + grain +
         " }\nposition = [\"= 0.009*(i - 2.5)\", \"= 0.009*(j - 1.5)\", \"= 0.009*(k - 1.5)\"]\n";
}

}  // namespace

TEST_CASE("a turning tube carries its grains up on one side; the bits are those of every number of threads",
          "[physics][hollow]") {
  const support::KeepThreads keep;
  for (const char* grain : {"sphere = { radius = 0.004 }", "capsule = { radius = 0.002, length = 0.003 }"}) {
    std::string first;
    for (const int threads : {1, 2, 3}) {
      set_thread_count(threads);
      SceneRun run = start_text(drum(grain), {"material.m.youngs_modulus=2e5"});
      run.advance_to(2000);
      REQUIRE(run.failure.empty());
      CHECK(std::abs(run.energy_error()) < 1e-2);
      const World& world = run.simulation().world;
      double x = 0.0;
      for (Slot s = 0; s < world.size(); ++s) {
        if (!world.is_movable(s)) continue;
        const Vec3 p = world.position[s];
        CHECK(std::hypot(p.x(), p.z()) < 0.05);
        CHECK(std::abs(p.y()) < 0.025);
        x += p.x();
      }
      // turning from z to x: the lowest wall moves towards -x
      CHECK(x < -0.001 * 96);
      if (threads == 1) first = run.hash();
      CHECK(run.hash() == first);
    }
  }
}

TEST_CASE("a hopper of a tube on a cone loses no ball", "[physics][hollow]") {
  const auto hopper = [](const std::string& bodies, const std::string& friction, const std::string& method) {
    return tube_head("duration = 1.0, time_step = " + std::string(method == "smooth" ? "1e-4" : "1e-3"),
                     "method = \"" + method + "\", restitution = 0.3, friction = " + friction) +
           wall("tube = { radius = 0.04, length = 0.1 }", "fixed = true\nposition = [0, 0, 0.05]") +
           "[[body]]\nname = \"funnel\"\nmaterial = \"m\"\nshape = { cone = { radii = [0.002, 0.04], length = 0.06 } "
           "}\nfixed = true\nposition = [0, 0, -0.03]\n" +
           bodies;
  };
  for (const std::string method : {"smooth", "nonsmooth"}) {
    SceneRun run = start_text(hopper(
        "[[body]]\nname = \"ball\"\nrepeat = [5, 5, 6]\nmaterial = \"m\"\nshape = { sphere = { radius = 0.004 } }\n"
        "position = [\"= 0.01*(i - 2)\", \"= 0.01*(j - 2)\", \"= 0.02 + 0.01*k + 0.0003*i\"]\n",
        "0.3", method));
    run.advance_to(method == "smooth" ? 3000 : 300);
    REQUIRE(run.failure.empty());
    const World& world = run.simulation().world;
    for (Slot s = 0; s < world.size(); ++s) {
      if (!world.is_movable(s)) continue;
      const Vec3 p = world.position[s];
      CHECK(p.z() > -0.06);
      CHECK(std::hypot(p.x(), p.y()) < 0.04);
    }
  }
}

TEST_CASE("a ball that falls on the tip of a cone meets it once, whatever the cone and where it points",
          "[physics][hollow]") {
  std::mt19937 engine(11);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution(low, high)(engine); };
  for (int k = 0; k < 8; ++k) {
    const double e = draw(0.3, 0.9), width = draw(0.02, 0.1), length = draw(0.02, 0.2), turn = 180.0 * (k % 2);
    const std::string ends = k % 4 < 2 ? "open" : "closed", radii = std::to_string(width);
    const std::string cone = k % 2 == 0 ? "[" + radii + ", 0]" : "[0, " + radii + "]";  // both point up
    SceneRun run = start_text(
        tube_head("duration = 0.01, time_step = 1e-6", "method = \"smooth\", restitution = " + std::to_string(e) +
                                                           ", friction = 0, smooth = { law = \"hertz\" }") +
            wall("cone = { radii = " + cone + ", length = " + std::to_string(length) + ", ends = \"" + ends + "\" }",
                 "fixed = true\nposition = [0, 0, " + std::to_string(-0.5 * length) + "]\neuler_deg = [" +
                     std::to_string(turn) + ", 0, 0]") +
            "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = { radius = 0.005 } }\nposition = [0, 0, "
            "0.0052]\nvelocity = [0, 0, -0.5]\n",
        {"world.gravity=[0,0,0]"});
    INFO(cone << ' ' << ends << ' ' << turn << " e " << e);
    std::size_t most = 0;
    for (std::uint64_t n = 10; n <= 10000 && run.failure.empty(); n += 10) {
      run.advance_to(n);
      most = std::max(most, run.simulation().work.report.touching);
    }
    CHECK(most == 1);
    const World& world = run.simulation().world;
    CHECK(world.velocity[world.slot_of(BodyId{1})].z() == Approx(0.5 * e).epsilon(2e-3));
  }
}
