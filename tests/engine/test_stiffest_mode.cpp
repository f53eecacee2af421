#include "engine/step/stiffest_mode.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

Body body_of(double mass, const Vec3& inertia, const Quat& turn = Quat(1, 0, 0, 0)) {
  Body b;
  b.mass = mass;
  b.inertia = inertia;
  b.orientation = turn;
  return b;
}

World world_of(const std::vector<Body>& bodies) {
  World world(Columns{.rotation = true, .anisotropy = true, .force = false});
  for (const Body& b : bodies) world.add(b);
  return world;
}

/// Largest eigenvalue of one free body on links to the ground, by its 6 x 6 matrix.
double by_matrix(double mass, const Vec3& inertia, const Mat3& turn, const std::vector<StiffLink>& links) {
  Eigen::Matrix<double, 6, 6> K = Eigen::Matrix<double, 6, 6>::Zero(), M = K;
  for (const StiffLink& l : links) {
    Eigen::Matrix<double, 3, 6> G;
    Mat3 cross;
    cross << 0, l.arm_b.z(), -l.arm_b.y(), -l.arm_b.z(), 0, l.arm_b.x(), l.arm_b.y(), -l.arm_b.x(), 0;
    G << Mat3::Identity(), cross;
    const Mat3 along = l.normal * l.normal.transpose();
    K += G.transpose() * (l.along * along + l.across * (Mat3::Identity() - along)) * G;
  }
  M.topLeftCorner<3, 3>() = mass * Mat3::Identity();
  M.bottomRightCorner<3, 3>() = turn * inertia.asDiagonal() * turn.transpose();
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(K, M).eigenvalues().maxCoeff();
}

}  // namespace

TEST_CASE("the stiffest mode of a column of n equal bodies is 4 cos^2(pi/(2n+1)) of one on the ground",
          "[engine][stability]") {
  const double m = 0.3, k = 2.0;
  for (const int n : {1, 2, 3, 5, 10, 40}) {
    INFO(n);
    const World world = world_of(std::vector<Body>(n, body_of(m, Vec3::Constant(1e-4))));
    std::vector<StiffLink> links(n);
    for (int i = 0; i < n; ++i) {
      links[i].a = i > 0 ? static_cast<Slot>(i - 1) : no_slot;
      links[i].b = static_cast<Slot>(i);
      links[i].along = k;
    }
    const double c = std::cos(std::numbers::pi / (2 * n + 1));
    CHECK(stiffest_mode(world, links).value == Approx(4 * c * c * k / m).epsilon(0.01));
  }
}

TEST_CASE("a solid sphere gives way sideways with 7/2 of its mobility", "[engine][stability]") {
  const double m = 2e-3, r = 0.01, s = 5.0;
  const World world = world_of({body_of(m, Vec3::Constant(0.4 * m * r * r))});
  StiffLink link;
  link.b = 0;
  link.arm_b = Vec3(0, 0, -r);
  link.across = s;
  const StiffestMode mode = stiffest_mode(world, {link});
  CHECK(mode.value == Approx(3.5 * s / m).epsilon(1e-9));
  CHECK(mode.body == 0);
  CHECK(mode.links == 1);
}

TEST_CASE("bodies on many points: as their matrices of six by six have it", "[engine][stability]") {
  Random random(11, 0);
  const auto vector = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (int k = 0; k < 50; ++k) {
    const double mass = std::pow(10.0, random.uniform(-3, 3));
    const Vec3 half(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)),
        square = half.cwiseProduct(half);
    const Vec3 inertia = mass / 3.0 * Vec3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
    const Quat turn =
        Quat(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    const World world = world_of({body_of(mass, inertia, turn)});
    std::vector<StiffLink> links(1 + k % 9);
    for (StiffLink& l : links) {
      l.b = 0;
      l.arm_b = vector();
      l.normal = vector().normalized();
      l.along = random.uniform(0, 10);
      l.across = random.uniform(0, 10);
    }
    const double expected = by_matrix(mass, inertia, turn.toRotationMatrix(), links);
    CHECK(stiffest_mode(world, links).value == Approx(expected).epsilon(2e-3));
  }
}

TEST_CASE("a servo wall gives way along its line alone", "[engine][stability]") {
  const World world = world_of({body_of(0, Vec3::Zero()), body_of(0.5, Vec3::Constant(1.0))});
  StiffLink link;
  link.a = 0;
  link.b = 1;
  link.normal = Vec3(0.6, 0, 0.8);
  link.along = 3.0;
  const double alone = stiffest_mode(world, {link}).value;
  CHECK(alone == Approx(3.0 / 0.5));
  // n.d = 0.8: 0.64 of 1/m comes on top
  CHECK(stiffest_mode(world, {link}, 0.0, {{BodyId{0}, Vec3::UnitZ(), 0.1}}).value ==
        Approx(3.0 * (2.0 + 0.64 / 0.1)).epsilon(1e-6));
}

TEST_CASE("the bound of the stiffest mode holds and is at most 2.6 times too large, for 40 random networks",
          "[engine][stability]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    INFO(seed);
    Random random(11, seed);
    const auto vector = [&](double size) {
      return Vec3(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
    };
    const std::size_t n = 2 + seed % 20;
    std::vector<Body> bodies;
    for (std::size_t i = 0; i < n; ++i) {
      const double mass = std::pow(10.0, random.uniform(-3, 1)), size = random.uniform(0.1, 1.0);
      const Vec3 shares(random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0.5, 1));
      bodies.push_back(body_of(mass, mass * size * size * shares,
                               Quat(Eigen::AngleAxisd(random.uniform(0, 3), vector(1).normalized()))));
    }
    const World world = world_of(bodies);
    std::vector<StiffLink> links(3 * n);
    for (StiffLink& l : links) {
      l.a = static_cast<Slot>(random.uniform(0, 1) * static_cast<double>(n));
      l.b = random.uniform(0, 1) < 0.2 ? no_slot : static_cast<Slot>(random.uniform(0, 1) * static_cast<double>(n));
      if (l.a == l.b) l.b = no_slot;
      l.arm_a = vector(0.5);
      l.arm_b = vector(0.5);
      l.normal = vector(1).normalized();
      l.along = random.uniform(0.1, 5);
      l.across = random.uniform(0, 1) * l.along;
      l.turn = seed % 2 == 0 ? random.uniform(0, 0.1) : 0.0;
    }
    const double value = stiffest_mode(world, links).value, bound = stiffness_bound(world, links);
    CHECK(bound > value);  // the value comes from below
    CHECK(bound < 2.0 * std::pow(6.0, 0.125) * 1.02 * value);
  }
}
