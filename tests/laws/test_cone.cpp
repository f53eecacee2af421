#include "engine/units/random.h"
#include "laws/nonsmooth/cone.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {
Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}
}  // namespace

TEST_CASE("the projection on the Coulomb cone is the nearest of many sampled points", "[laws][cone]") {
  Random random(1, 0);
  for (const double mu : {0.0, 0.1, 0.5, 1.0, 3.0}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3 x = random_vector(random, 1.0), p = project_cone(x, mu);
      REQUIRE(p.x() >= 0.0);
      REQUIRE(tangential_norm(p) <= mu * p.x() * (1 + 1e-15) + 1e-300);
      double best = x.norm();  // the apex
      for (int k = 0; k < 20000; ++k) {
        const double n = random.uniform(0.0, 2.0), t = mu * n * random.uniform();
        const double angle = random.uniform(0.0, 6.2831853);
        best = std::min(best, (x - Vec3(n, t * std::cos(angle), t * std::sin(angle))).norm());
      }
      CHECK((x - p).norm() <= best + 1e-12);
    }
  }
}

TEST_CASE("a vector is the sum of orthogonal projections on the cone and on its polar", "[laws][cone]") {
  // Moreau's decomposition; the polar of K_mu is -K*_mu = -K_{1/mu}
  Random random(2, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    const double mu = random.uniform(0.05, 4.0);
    const Vec3 x = random_vector(random, 10.0);
    const Vec3 p = project_cone(x, mu), polar = -project_cone(-x, 1.0 / mu);
    CHECK((p + polar - x).norm() < 1e-13 * x.norm());
    CHECK(std::abs(p.dot(polar)) < 1e-13 * x.squaredNorm());
  }
}

TEST_CASE("the cone's projection is the identity inside, zero in the polar, and bears mu = 0", "[laws][cone]") {
  CHECK(project_cone({1, 0.3, 0.4}, 0.5) == Vec3(1, 0.3, 0.4));
  CHECK(project_cone({-1, 0.1, 0}, 0.5) == Vec3::Zero());
  CHECK(project_cone({2, 3, 4}, 0.0) == Vec3(2, 0, 0));
  CHECK(project_cone({-2, 0, 0}, 0.0) == Vec3::Zero());
  CHECK(project_cone({0, 0, 0}, 0.0) == Vec3::Zero());
}

TEST_CASE("the disk keeps direction and normal part", "[laws][cone]") {
  const Vec3 p = project_disk({7, 3, 4}, 2.5);
  CHECK(p.isApprox(Vec3(7, 1.5, 2.0), 1e-15));
  CHECK(project_disk({7, 0.3, 0.4}, 2.5) == Vec3(7, 0.3, 0.4));
  CHECK(project_disk({7, 3, 4}, 0.0) == Vec3(7, 0, 0));
}

TEST_CASE("the natural map is zero for take-off, stick and slip, and for nothing near them", "[laws][cone]") {
  const double mu = 0.5;
  struct State {
    Vec3 r, u;
  };
  const State exact[] = {{Vec3::Zero(), Vec3(1, 2, 3)},          // take-off
                         {Vec3(2, 0.6, 0.3), Vec3::Zero()},      // stick
                         {Vec3(2, -0.6, -0.8), Vec3(0, 3, 4)}};  // slip against the motion
  for (const State& s : exact)
    for (const double rho : {1e-3, 1.0, 1e3}) CHECK(natural_map(s.r, s.u, mu, rho).norm() < 1e-13 * (1 + rho));
  CHECK(natural_map(Vec3(2, 0.6, 0.8), Vec3(0, 3, 4), mu, 1.0).norm() > 0.1);      // slips the wrong way
  CHECK(natural_map(Vec3(2, 0, 0), Vec3(0, 3, 4), mu, 1.0).norm() > 0.1);          // slips without friction
  CHECK(natural_map(Vec3::Zero(), Vec3(-1, 0, 0), mu, 1.0).norm() > 0.1);          // penetrates
  CHECK(natural_map(Vec3(1, 0, 0), Vec3(1, 0, 0), mu, 1.0).norm() > 0.1);          // force at a distance
  CHECK(natural_map(Vec3(2, -0.6, -0.8), Vec3(1.5, 3, 4), mu, 1.0).norm() > 0.1);  // convex relaxation's gap
}
