#include "laws/nonsmooth/residual.h"

#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"

using namespace epafi;
using namespace epafi::test;

namespace {
/// Every interface of the stack carries the weight above it, shared by its four corners.
Impulses exact_stack_impulses(int n, double dt) {
  Impulses r;
  for (int level = 0; level < n; ++level)
    for (int k = 0; k < 4; ++k) r.emplace_back((n - level) * 1000.0 * 9.81 * dt / 4.0, 0.0, 0.0);
  return r;
}

/// contacts[k] of the problem, without what only sweeps and sums by body read.
ContactProblem rearranged(const ContactProblem& p, const std::vector<std::size_t>& contacts) {
  ContactProblem out = p;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const std::size_t i = contacts[k];
    out.a[k] = p.a[i];
    out.b[k] = p.b[i];
    out.frame[k] = p.frame[i];
    out.arm_a[k] = p.arm_a[i];
    out.arm_b[k] = p.arm_b[i];
    out.friction[k] = p.friction[i];
    out.offset[k] = p.offset[i];
    out.mobility[k] = p.mobility[i];
  }
  return out;
}
}  // namespace

TEST_CASE("the residual of the exact solution of a stack is zero to rounding", "[laws][residual]") {
  const double dt = 1.0 / 240;
  const ContactProblem p = stack_problem(10, 0.5, dt);
  BodyVelocities v;
  std::vector<Vec3> u;
  const Residual residual = measure_residual(p, exact_stack_impulses(10, dt), p.mean_effective_mass(), v, u);
  CHECK(residual.value < 1e-13);
  CHECK(residual.penetration_rate < 1e-13);
}

TEST_CASE("the residual follows its definition, term by term", "[laws][residual]") {
  // one box on the plane, r = 0: u = q, u_N = -g dt at four contacts, P_K(-rho u~) = rho g dt n: residual 1
  const ContactProblem p = stack_problem(1, 0.5, 0.01);
  BodyVelocities v;
  std::vector<Vec3> u;
  for (const double rho : {1.0, 250.0}) {
    const Residual zero = measure_residual(p, Impulses(4, Vec3::Zero()), rho, v, u);
    CHECK(zero.value == Approx(1.0).epsilon(1e-12));
    CHECK(zero.penetration_rate == Approx(1.0).epsilon(1e-12));
  }
  // half the weight: u_N = -g dt / 2, r - P(r - rho u) = rho u: residual 1/2 for every rho
  const Residual half = measure_residual(p, Impulses(4, Vec3(0.5 * 9.81 * 0.01 * 250.0, 0, 0)), 250.0, v, u);
  CHECK(half.value == Approx(0.5).epsilon(1e-12));
}

TEST_CASE("rho = 1/mean(W_NN) makes the residual independent of the unit of mass", "[laws][residual]") {
  ContactProblem light = stack_problem(5, 0.5), heavy = light;
  for (double& m : heavy.inverse_mass) m *= 1e-3;
  for (Mat3& j : heavy.inverse_inertia) j *= 1e-3;
  for (double& w : heavy.mobility) w *= 1e-3;
  Random random(3, 3);
  Impulses r(light.size());
  for (Vec3& x : r) x = Vec3(random.uniform(0, 30), random.uniform(-5, 5), random.uniform(-5, 5));
  Impulses r_heavy = r;
  for (Vec3& x : r_heavy) x *= 1e3;
  BodyVelocities v;
  std::vector<Vec3> u;
  const double a = measure_residual(light, r, light.mean_effective_mass(), v, u).value;
  const double b = measure_residual(heavy, r_heavy, heavy.mean_effective_mass(), v, u).value;
  CHECK(a > 1e-3);
  CHECK(a == Approx(b).epsilon(1e-12));
}

TEST_CASE("residual and effective mass are the same bits in every order of the contacts", "[laws][residual]") {
  const ContactProblem p = random_problem(400, 5, true, 0.4);
  std::vector<std::size_t> order(p.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(3, 3);
  Impulses r(p.size());
  for (Vec3& x : r) x = Vec3(random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  std::vector<Vec3> u;
  BodyVelocities v;
  const double mass = p.mean_effective_mass(), first = measure_residual(p, r, mass, v, u).value;
  const FreeMotion q = measure_free_motion(p);
  for (int k = 0; k < 10; ++k) {
    for (std::size_t n = order.size(); n > 1; --n)
      std::swap(order[n - 1], order[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(n)))]);
    const ContactProblem other = rearranged(p, order);
    Impulses other_r(r.size());
    std::vector<Vec3> other_u(u.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      other_r[i] = r[order[i]];
      other_u[i] = u[order[i]];
    }
    CHECK(other.mean_effective_mass() == mass);
    CHECK(measure_free_motion(other).norm == q.norm);
    CHECK(measure_residual(other, other_r, other_u, mass, q).value == first);
  }
}
