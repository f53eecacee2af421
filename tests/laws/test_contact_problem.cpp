#include <Eigen/Dense>

#include "laws/nonsmooth/assembled.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"

using namespace epafi;
using namespace epafi::test;

namespace {
Impulses random_impulses(std::size_t n, std::uint64_t seed) {
  Random random(seed, 7);
  Impulses r(n);
  for (Vec3& x : r) x = Vec3(random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return r;
}
Eigen::VectorXd flat(const std::vector<Vec3>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x[0].data(), 3 * static_cast<Eigen::Index>(x.size()));
}
}  // namespace

TEST_CASE("matrix-free velocities equal those of the assembled forms", "[laws][problem]") {
  for (const bool rotates : {true, false}) {
    const ContactProblem p = random_problem(30, 3, rotates, 0.4);
    const Impulses r = random_impulses(p.size(), 5);
    BodyVelocities v;
    std::vector<Vec3> u;
    p.velocities(r, v);
    p.relative_velocities(v, u);
    const GlobalForm global = assemble_global(p);
    const LocalForm local = assemble_local(p);
    REQUIRE(global.M.rows() == (rotates ? 6 : 3) * 24);  // every fifth of 30 bodies is fixed
    const Eigen::VectorXd by_global =
        global.H.transpose() * Eigen::MatrixXd(global.M).ldlt().solve(global.H * flat(r) + global.f) + global.w;
    const Eigen::VectorXd by_local = local.W * flat(r) + local.q;
    CHECK((flat(u) - by_global).norm() < 1e-12 * flat(u).norm());
    CHECK((flat(u) - by_local).norm() < 1e-12 * flat(u).norm());
  }
}

TEST_CASE("the diagonal blocks are those of the symmetric, not negative Delassus matrix", "[laws][problem]") {
  const ContactProblem p = random_problem(20, 4, true, 0.4);
  const Eigen::MatrixXd w = assemble_local(p).W;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto k = 3 * static_cast<Eigen::Index>(i);
    CHECK((w.block<3, 3>(k, k) - p.diagonal[i]).norm() <= 1e-13 * (1.0 + p.diagonal[i].norm()));
  }
  CHECK((w - w.transpose()).norm() < 1e-13 * w.norm());
  CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(w).eigenvalues().minCoeff() > -1e-12 * w.norm());
}

TEST_CASE("impulses between free bodies leave momentum and angular momentum alone", "[laws][problem]") {
  const ContactProblem p = lattice_problem(3, 0.5, 4);
  Impulses r = random_impulses(p.size(), 6);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!p.is_free(p.a[i])) r[i].setZero();
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  for (Slot s = 0; s < p.inverse_mass.size(); ++s) {
    if (!p.is_free(s)) continue;
    const auto sum = p.impulse_on(s, r);
    const Vec3 at(static_cast<int>(s - 1) % 3, static_cast<int>(s - 1) / 3 % 3, 0.5 + static_cast<int>(s - 1) / 9);
    linear += sum.linear;
    angular += sum.angular + at.cross(sum.linear);
  }
  CHECK(linear.norm() < 1e-13 * static_cast<double>(p.size()));
  CHECK(angular.norm() < 1e-12 * static_cast<double>(p.size()));
}

TEST_CASE("a contact that no impulse can change has no free velocity", "[laws][problem]") {
  ContactProblem p = random_problem(6, 8, true, 0.3);
  for (std::size_t i = 0; i < p.size(); ++i) {
    CHECK(p.free_relative_velocity(i).norm() > 0.0);
    p.leave_out(i);
    CHECK(p.free_relative_velocity(i) == Vec3::Zero());
  }
  // driven bodies that neither can be moved
  World world{Columns{.rotation = true, .force = false}};
  for (int k = 0; k < 2; ++k) world.add({.position = Vec3(k, 0, 0), .velocity = Vec3(1 - k, 2, 3)});
  ContactSet contacts;
  contacts.append(0, 1, {.gap = 0.0, .normal = Vec3::UnitX(), .arm = Vec3(0.5, 0, 0)});
  ContactProblem held;
  held.load_bodies(world, 0.01);
  held.load_contacts(world, contacts);
  CHECK(held.free_relative_velocity(0) == Vec3::Zero());
}
