#include "engine/lanes/targets.h"
#include "engine/threads/parallel.h"
#include "laws/nonsmooth/lane_sweep.h"
#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/nsgs.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "laws/nonsmooth/sweep.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"
#include "tests/support/keep_threads.h"

using namespace epafi;
using namespace epafi::test;

namespace {
std::unique_ptr<ContactSolver> solver(const std::string& name, double iterations, double tolerance) {
  Parameters p;
  p.set("iterations", iterations);
  p.set("tolerance", tolerance);
  for (const SolverEntry& s : all_solvers())
    if (s.entry.name == name) return s.make(p);
  return nullptr;
}
/// The solvers that sweep.
std::vector<SolverEntry> sweepers() { return {pgs_entry(), nsgs_entry()}; }
Impulses zeros(const ContactProblem& p) { return Impulses(p.size(), Vec3::Zero()); }

/// Fixed bodies at rest and open offsets: v = 0 satisfies every contact, so that a solution exists (Cadoux 2009).
ContactProblem solvable(ContactProblem p) {
  for (Slot s = 0; s < p.inverse_mass.size(); ++s) {
    if (p.is_free(s)) continue;
    p.free.linear[s].setZero();
    if (p.rotates) p.free.angular[s].setZero();
  }
  for (double& w : p.offset) w = std::abs(w);
  return p;
}

}  // namespace

TEST_CASE("every solver says truly whether it reached its tolerance, and the exact ones reach it",
          "[laws][pgs][long]") {
  // newton, augmented-lagrangian and admm keep the slip of the last outer step, lagrange the last set: on random
  // sliding contacts they may circle; penalty is soft; staggered solvers circle where friction wedges; avbd stops at
  // its bound
  const std::vector<std::string> exact{"pgs", "nsgs", "proximal", "auto", "apgd", "projected-gradient"};
  for (const SolverEntry& entry : all_solvers()) {
    for (const bool rotates : {true, false}) {
      const ContactProblem p = solvable(random_problem(40, 11, rotates, 0.4));
      Impulses r = zeros(p);
      const bool is_exact = std::find(exact.begin(), exact.end(), entry.entry.name) != exact.end();
      const SolverReport report = solver(entry.entry.name, is_exact ? 20000 : 60, 1e-9)->solve(p, r);
      INFO(entry.entry.name << " rotates " << rotates << " iterations " << report.iterations);
      CHECK(report.converged == (residual_of(p, r) <= 1e-9));
      CHECK(report.residual == Approx(residual_of(p, r)).epsilon(1e-6).margin(1e-12));
      if (is_exact) CHECK(report.converged);
    }
  }
}

TEST_CASE("sweeps that are cut off say so", "[laws][pgs]") {
  const ContactProblem p = stack_problem(20, 0.5);
  for (const SolverEntry& entry : sweepers()) {
    Impulses r = zeros(p);
    const SolverReport report = solver(entry.entry.name, 10, 1e-9)->solve(p, r);
    CHECK_FALSE(report.converged);
    CHECK(report.iterations == 10);
    CHECK(residual_of(p, r) > 1e-9);
  }
}

TEST_CASE("an exact warm start is confirmed, a good one halves the sweeps", "[laws][pgs]") {
  const ContactProblem p = stack_problem(5, 0.5);
  Impulses r = zeros(p);
  const int cold = solver("pgs", 100000, 1e-6)->solve(p, r).iterations;
  Impulses again = r;
  CHECK(solver("pgs", 100000, 1e-6)->solve(p, again).iterations <= 2);
  for (Vec3& x : r) x *= 1.001;  // the load of the next step differs by 0.1 %
  const int warm = solver("pgs", 100000, 1e-6)->solve(p, r).iterations;
  INFO("cold " << cold << " warm " << warm);
  CHECK(2 * warm <= cold);
}

TEST_CASE("Gauss-Seidel gives the same bits for every thread count", "[laws][pgs]") {
  const support::KeepThreads keep;
  const ContactProblem p = lattice_problem(14, 0.5, 4);  // colours of over 1024 pairs, so that they do run in parallel
  for (const SolverEntry& entry : sweepers()) {
    set_thread_count(1);
    Impulses reference = zeros(p);
    solver(entry.entry.name, 10, 1e-12)->solve(p, reference);
    for (const int threads : {2, 3, 4, 7, 8, 16}) {
      set_thread_count(threads);
      Impulses r = zeros(p);
      solver(entry.entry.name, 10, 1e-12)->solve(p, r);
      CHECK(r == reference);
    }
  }
}

TEST_CASE("the exact local solution obeys Signorini and Coulomb, PGS agrees after many updates", "[laws][nsgs]") {
  Random random(21, 0);
  int take_off = 0, stick = 0, slide = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Mat3 root;
    for (int k = 0; k < 9; ++k) root(k / 3, k % 3) = random.uniform(-1, 1);
    const Mat3 w = root * root.transpose() + 0.2 * Mat3::Identity();
    const Vec3 q(random.uniform(-1, 0.3), random.uniform(-1, 1), random.uniform(-1, 1));
    const double mu = random.uniform(0.0, 1.5);
    const Vec3 r = NsgsRule::solve(NsgsRule::pack(w), mu, q), u = w * r + q;
    CHECK(natural_map(r, u, mu, 1.0).norm() < 1e-12 * (1.0 + r.norm()));
    (r.x() <= 0.0 ? take_off : u.norm() < 1e-12 ? stick : slide)++;
    // update() finds the same from any r
    const Vec3 other(random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    CHECK((NsgsRule{}.update(NsgsRule::pack(w), mu, other, w * other + q) - r).norm() < 1e-11 * (1.0 + r.norm()));
  }
  CHECK((take_off > 100 && stick > 100 && slide > 100));
}

TEST_CASE("four exact local solutions at a time are those of one, whatever their neighbours", "[laws][nsgs]") {
  Random random(418, 0);
  int slide = 0;
  for (int k = 0; k < 500; ++k) {
    ContactProblem p;
    NsgsRule::LaneData data{};
    Lanes mu{}, r[3] = {}, u[3] = {};
    std::array<Vec3, 4> expected;
    for (std::size_t l = 0; l < 4; ++l) {
      Mat3 root;
      for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = random.uniform(-1, 1);
      const bool empty = k % 5 == 0 && l == 2;
      p.diagonal.push_back(empty ? Mat3(Mat3::Zero()) : Mat3(root * root.transpose() + 0.2 * Mat3::Identity()));
      NsgsRule::pack(p, l, data, l);
      if (empty) {
        expected[l].setZero();
        continue;
      }
      mu[l] = k % 7 == 0 ? 0.0 : random.uniform(0.0, 1.5);
      const Vec3 q(random.uniform(-1, 0.3), random.uniform(-1, 1), random.uniform(-1, 1));
      const Vec3 from(random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const Vec3 velocity = p.diagonal[l] * from + q;
      for (int i = 0; i < 3; ++i) {
        r[i][l] = from[i];
        u[i][l] = velocity[i];
      }
      expected[l] = NsgsRule::solve(NsgsRule::pack(p.diagonal[l]), mu[l], q);
      slide += expected[l].x() > 0.0 && (p.diagonal[l] * expected[l] + q).norm() > 1e-12;
    }
    NsgsRule{}.update(data, mu, r, u);
    for (std::size_t l = 0; l < 4; ++l) {
      const Vec3 found(r[0][l], r[1][l], r[2][l]);
      CHECK((found - expected[l]).norm() < 1e-11 * (1.0 + expected[l].norm()));
      CHECK(tangential_norm(found) <= mu[l] * found.x() * (1.0 + 1e-15));
    }
  }
  CHECK(slide > 300);
}

TEST_CASE("PGS rows find the exact local solution of a contact with friction", "[laws][pgs]") {
  const Mat3 w = (Mat3() << 1.0, 0.2, -0.1, 0.2, 1.5, 0.3, -0.1, 0.3, 0.8).finished();
  for (const Vec3& q : {Vec3(-1, 2, 1), Vec3(-1, 0.1, 0.1), Vec3(0.5, 1, 1)}) {
    Vec3 r = Vec3::Zero();
    for (int k = 0; k < 500; ++k) r = PgsRule{}.update(PgsRule::pack(w), 0.4, r, w * r + q);
    CHECK((r - NsgsRule::solve(NsgsRule::pack(w), 0.4, q)).norm() < 1e-12);
  }
}

TEST_CASE("the sweeps of a stack grow as Gauss-Seidel must: about 0.93 n^2 per decade", "[laws][pgs][slow]") {
  // n^2: four times the sweeps for twice the height; a factor of two either way covers the order of the rows
  const auto sweeps = [](int n) {
    const ContactProblem p = stack_problem(n, 0.5);
    Impulses r = zeros(p);
    return solver("pgs", 1e6, 1e-4)->solve(p, r).iterations;
  };
  const int five = sweeps(5), ten = sweeps(10);
  INFO("5: " << five << " 10: " << ten);
  CHECK(ten > 2 * five);
  CHECK(ten < 10 * five);
}

namespace {
/// Takes the narrower loops, and gives the widest back.
struct Narrower {
  explicit Narrower(Target most) { limit_target(most); }
  ~Narrower() { limit_target(Target::avx512); }
};
}  // namespace

TEST_CASE("four contacts at a time give the bits of every instruction set", "[laws][pgs]") {
  for (const bool rotates : {true, false}) {
    const ContactProblem p = random_problem(60, 5, rotates, 0.4);
    Impulses wide = zeros(p);
    solver("pgs", 30, 0.0)->solve(p, wide);
    for (const Target target : {Target::baseline, Target::avx2}) {
      const Narrower narrower(target);
      Impulses r = zeros(p);
      solver("pgs", 30, 0.0)->solve(p, r);
      CHECK(r == wide);
    }
  }
}

TEST_CASE("contacts four at a time are those one at a time", "[laws][pgs]") {
  for (const bool rotates : {true, false}) {
    const ContactProblem p = random_problem(60, 7, rotates, 0.4);
    Impulses r = zeros(p), lanes_r = zeros(p);
    BodyVelocities v;
    p.velocities(r, v);
    const PgsRule rule;
    const auto compare = [&](auto one, auto four) {
      one.load(p, r, v);
      four.load(p, r, v);
      double change = 0.0, four_change = 0.0;
      for (int k = 0; k < 20; ++k) {
        change = one.run(rule);
        four_change = four.run(rule);
      }
      one.store(r);
      four.store(lanes_r);
      CHECK(four_change == Approx(change).epsilon(1e-9));
      double largest = 0.0;
      for (const Vec3& x : r) largest = std::max(largest, x.norm());
      REQUIRE(largest > 0.0);
      for (std::size_t i = 0; i < r.size(); ++i) CHECK((r[i] - lanes_r[i]).norm() < 1e-12 * largest);
      BodyVelocities after;
      std::vector<Vec3> u;
      const double rho = p.mean_effective_mass();
      const double residual = measure_residual(p, lanes_r, rho, after, u).value;
      double q2 = 0.0;
      for (std::size_t i = 0; i < p.size(); ++i) q2 += p.free_relative_velocity(i).squaredNorm();
      CHECK(four.natural_map(rho) / (rho * std::sqrt(q2)) == Approx(residual).epsilon(1e-9));
    };
    if (rotates)
      compare(Sweep<true, PgsRule>{}, LaneSweep<true, PgsRule>{});
    else
      compare(Sweep<false, PgsRule>{}, LaneSweep<false, PgsRule>{});
  }
}
