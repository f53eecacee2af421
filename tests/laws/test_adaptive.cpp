// The default solver: it holds what sweeps cannot, and leaves large piles to them.
#include "laws/nonsmooth/solvers/auto.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"
#include "tests/support/rigid_experiment.h"

using namespace epafi;
using namespace epafi::test;

namespace {

/// Cubes of 1 m on each other; the last one of another density.
RigidExperiment tower(int count, double last_density, const std::string& solver) {
  RigidExperiment x({.friction = 0.5, .dt = 1.0 / 240, .solver = solver});
  x.plane(Vec3::Zero(), Vec3::UnitZ());
  for (int i = 0; i < count; ++i)
    x.box(Vec3::Constant(0.5), i + 1 < count ? 1000.0 : last_density, Vec3(0, 0, 0.5 + i));
  return x;
}

/// A cubic lattice of n^3 spheres, somewhat open and out of line, that falls on a floor.
RigidExperiment pile(int n, const std::string& solver) {
  RigidExperiment x({.friction = 0.5, .dt = 2e-3, .reach = 2e-3, .solver = solver});
  x.plane(Vec3::Zero(), Vec3::UnitZ());
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 cell(i % n, i / n % n, i / (n * n));
    const Vec3 off(1e-3 * (i % 7), 1e-3 * (i % 5), 0);
    x.sphere(0.05, 1000, 0.1005 * cell + off + Vec3(0, 0, 0.05), Vec3(0, 0, -0.5));
  }
  return x;
}

}  // namespace

TEST_CASE("the default is `adaptive`; it holds 1:1000 and 50 boxes within its tolerance",
          "[laws][nonsmooth][adaptive]") {
  CHECK(NonsmoothSetup{}.solver == "adaptive");
  for (const auto& [count, density] : {std::pair(2, 1e6), {50, 1000.0}, {20, 1e5}}) {
    INFO(count << " boxes, " << density);
    RigidExperiment x = tower(count, density, "adaptive");
    x.run(60);
    CHECK(x.worst_residual <= 1e-6);
    double moved = 0.0;
    for (int i = 0; i < count; ++i)
      moved = std::max(moved, (x.world.position[static_cast<Slot>(i + 1)] - Vec3(0, 0, 0.5 + i)).norm());
    CHECK(moved < 1e-6);
    const int before = x.most_iterations;
    x.most_iterations = 0;
    x.run(20);
    CHECK(x.most_iterations < before);  // at rest: the start is the solution
    CHECK(x.most_iterations <= 1);
  }
}

TEST_CASE("a large pile gets the sweeps of pgs and nothing else: the same bits", "[laws][nonsmooth][adaptive]") {
  RigidExperiment swept = pile(7, "pgs"), chosen = pile(7, "adaptive");
  swept.run(8);
  chosen.run(8);
  CHECK(swept.worst_residual > 1e-6);
  for (Slot s = 0; s < swept.world.size(); ++s) REQUIRE(swept.world.position[s] == chosen.world.position[s]);
}

TEST_CASE("direct steps end with the credit they were given", "[laws][nonsmooth][adaptive]") {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    INFO("seed " << seed);
    // 27 spheres that touch their neighbours: no chain, and a factorisation is not too dear
    ContactProblem problem = lattice_problem(3, 0.4);
    Random random(seed, 0);
    for (double& w : problem.offset) w = random.uniform(-0.1, 0.1);
    Impulses r(problem.size(), Vec3::Zero());
    // a tolerance below rounding: no method ever ends by itself
    Auto whole(300, 1e-30), limited(300, 1e-30);
    whole.solve(problem, r);
    for (const double share : {0.5, 0.25}) {
      const double credit = share * whole.work();
      limited.limit_work(credit);
      r.assign(problem.size(), Vec3::Zero());
      limited.solve(problem, r);
      CHECK_FALSE(limited.left_some());
      CHECK(limited.work() > 0.5 * credit);
      CHECK(limited.work() <= credit);
    }
  }
}
