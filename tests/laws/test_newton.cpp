#include "engine/threads/parallel.h"
#include "laws/nonsmooth/cone_sweep.h"
#include "laws/nonsmooth/islands.h"
#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"
#include "tests/support/keep_threads.h"

using namespace epafi;
using namespace epafi::test;

namespace {

SolverReport solve(const SolverEntry& entry, const ContactProblem& p, Impulses& r, double tolerance,
                   double limit = 500) {
  Parameters parameters;
  parameters.set("iterations", limit);
  parameters.set("tolerance", tolerance);
  r.assign(p.size(), Vec3::Zero());
  return entry.make(parameters)->solve(p, r);
}

/// Two stacks side by side on the same plane: their bodies share nothing that can move.
ContactProblem two_stacks(int low, int high) {
  World world{Columns{.rotation = true, .force = false}};
  world.gravity = Vec3(0, 0, -9.81);
  world.add({});
  ContactSet contacts;
  Slot next = 1;
  for (const int n : {low, high})
    for (int i = 0; i < n; ++i, ++next) {
      world.add(
          {.position = Vec3(3.0 * (n == high), 0, 0.5 + i), .mass = 1000.0, .inertia = Vec3::Constant(1000.0 / 6)});
      for (std::uint32_t k = 0; k < 4; ++k) {
        const Vec3 corner(k & 1 ? 0.5 : -0.5, k & 2 ? 0.5 : -0.5, i == 0 ? 0.0 : 0.5);
        const Vec3 arm = i == 0 ? Vec3(corner + Vec3(3.0 * (n == high), 0, 0)) : corner;
        contacts.append(i == 0 ? 0 : next - 1, next, {.gap = 0.0, .normal = Vec3::UnitZ(), .arm = arm, .feature = k});
      }
    }
  ContactProblem p;
  p.load_bodies(world, 1.0 / 240);
  p.load_contacts(world, contacts);
  p.load_diagonal();
  p.friction.assign(p.size(), 0.5);
  return p;
}

}  // namespace

TEST_CASE("blocks carry the problem: same velocities, same residual", "[laws][blocks]") {
  for (const bool rotates : {true, false}) {
    const ContactProblem p = random_problem(40, 5, rotates, 0.4);
    ConeProblem blocks;
    blocks.load(p);
    Random random(1, 1);
    Impulses r(p.size());
    for (Vec3& x : r) x = Vec3(random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    BodyVelocities v;
    std::vector<Vec6> block_v;
    std::vector<Vec3> u, block_u;
    const Residual expected = measure_residual(p, r, p.mean_effective_mass(), v, u);
    blocks.relative_velocities(r, block_v, block_u);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (blocks.moves(i)) CHECK((u[i] - block_u[i]).norm() < 1e-12);  // a few ulp of velocities of order 10
    CHECK(blocks.residual(r, block_u) == Approx(expected.value).epsilon(1e-11));
    // through the matrices: global form, local form and dense blocks are the same W and q
    const ConeProblem global = ConeProblem::from(assemble_global(p)), local = ConeProblem::from(assemble_local(p));
    CHECK((global.dense() - local.dense()).norm() < 1e-10 * local.dense().norm());
    CHECK((blocks.dense() - local.dense()).norm() < 1e-10 * local.dense().norm());
  }
}

TEST_CASE("newton solves stacks of every height to 1e-9 in at most 15 factorisations", "[laws][newton]") {
  for (const int n : {5, 10, 20, 50, 100}) {
    const ContactProblem p = stack_problem(n, 0.5);
    Impulses r;
    const SolverReport report = solve(newton_entry(), p, r, 1e-9);
    INFO(n << " boxes: " << report.iterations << " steps, residual " << report.residual);
    CHECK(report.iterations <= 15);
    CHECK(residual_of(p, r) <= 1e-9);
    // the whole weight reaches the plane
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) sum += r[i].x();
    CHECK(sum == Approx(1000.0 * 9.81 / 240 * n).epsilon(1e-8));
  }
}

TEST_CASE("mass ratios to 1e6 cost newton no more than a stack", "[laws][newton]") {
  for (const double ratio : {1e2, 1e4, 1e6}) {
    const ContactProblem p = stack_problem(2, 0.5, 1.0 / 240, ratio);
    Impulses r;
    const SolverReport report = solve(newton_entry(), p, r, 1e-8);
    INFO("ratio " << ratio << ": " << report.iterations << " steps, residual " << residual_of(p, r));
    CHECK(report.converged);
    CHECK(report.iterations <= 20);
    double top = 0.0;  // force between the two: the heavy weight
    for (std::size_t i = 4; i < 8; ++i) top += r[i].x();
    CHECK(top == Approx(1000.0 * ratio * 9.81 / 240).epsilon(1e-6));
  }
}

TEST_CASE("B01: mass ratios are solved to 1e-8 in few factorisations", "[laws][newton][B01]") {
  // alternating 1:1000 and heavy on light; what they take in sweeps: perf_solvers mass
  std::vector<ContactProblem> problems{stack_of(20, 0.5, 1.0 / 240, [](int i) { return i % 2 ? 1e6 : 1e3; })};
  for (double ratio = 1.0; ratio <= 1e6; ratio *= 10.0) problems.push_back(stack_problem(2, 0.5, 1.0 / 240, ratio));
  for (const ContactProblem& p : problems) {
    Impulses r;
    const SolverReport report = solve(newton_entry(), p, r, 1e-8);
    INFO(p.size() << " contacts, " << report.iterations << " factorisations, residual " << residual_of(p, r));
    CHECK(residual_of(p, r) <= 1e-8);
    CHECK(report.iterations <= 15);
  }
}

TEST_CASE("islands are what no movable body joins, in the order of their first contact", "[laws][islands]") {
  ConeProblem blocks;
  blocks.load(two_stacks(3, 5));
  Islands islands;
  islands.find(blocks);
  REQUIRE(islands.size() == 2);
  CHECK(islands.contacts(0).size() == 12);
  CHECK(islands.contacts(1).size() == 20);
  CHECK(islands.contacts(1)[0] == 12);
  ConeProblem part;
  islands.extract(blocks, 1, part);
  CHECK(part.bodies() == 5);
  const Eigen::MatrixXd whole = blocks.dense();
  CHECK((whole.bottomRightCorner(60, 60) - part.dense()).norm() == 0.0);
  CHECK(whole.topRightCorner(36, 60).norm() == 0.0);
}

TEST_CASE("auto leaves each island to what it needs and meets the tolerance of the whole", "[laws][auto]") {
  const ContactProblem p = two_stacks(1, 40);
  Impulses r;
  const SolverReport report = solve(auto_entry(), p, r, 1e-8, 2000);
  CHECK(report.converged);
  CHECK(residual_of(p, r) <= 1e-8);
  CHECK(report.iterations < 200);  // sweeps alone would need some 0.93 * 40^2 per decade
}

TEST_CASE("the accurate solvers give the same bits for every thread count", "[laws][auto]") {
  const support::KeepThreads keep;
  const ContactProblem p = two_stacks(12, 30);
  for (const SolverEntry& entry : {newton_entry(), proximal_entry(), auto_entry()}) {
    set_thread_count(1);
    Impulses reference;
    solve(entry, p, reference, 1e-10, 300);
    for (const int threads : {2, 3, 8, 16}) {
      set_thread_count(threads);
      Impulses r;
      solve(entry, p, r, 1e-10, 300);
      CHECK(r == reference);
    }
  }
}
