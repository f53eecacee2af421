#include "laws/nonsmooth/solvers/soft_step.h"

#include <algorithm>
#include <numbers>

#include "engine/threads/parallel.h"
#include "engine/threads/parallel_order.h"
#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/pgs.h"

namespace epafi {

namespace {
constexpr double stiffest = 0.25;  // of 1/h: a faster spring would be resolved by less than four parts
constexpr double farthest_push =
    0.05;  // of the shortest lever arm, pushed in a step at most: deep overlaps leave gently
}  // namespace

void SoftRule::pack(const ContactProblem& problem, std::size_t i, LaneData& data, std::size_t lane) {
  const PgsRule::Data d = PgsRule::pack(problem.diagonal[i]);
  data.step_n[lane] = d.step_n;
  data.step_t[lane] = d.step_t;
  data.coupling1[lane] = d.coupling1;
  data.coupling2[lane] = d.coupling2;
  data.first_gap[lane] = data.gap[lane] = 0.0;
  data.rebound[lane] = std::min(0.0, problem.offset[i]);
  for (Lanes& b : data.base) b[lane] = 0.0;
}

void SoftStep::see(const World& world, const BodyVelocities& before, const ContactSet& contacts, double dt) {
  seen_ = true;
  dt_ = dt;
  parallel_copy(contacts.gap, gap_);
  const double shortest = -block_max<double>(contacts.size(), -infinity, [&](std::size_t i) {
    const double a = world.is_movable(contacts.a[i]) ? contacts.arm[i].squaredNorm() : infinity;
    return -std::min(a, world.is_movable(contacts.b[i]) ? contacts.arm_b(i, world).squaredNorm() : infinity);
  });
  fastest_ = farthest_push * std::sqrt(shortest) / dt;
  parallel_copy(before.linear, before_.linear);
  parallel_copy(before.angular, before_.angular);
}

SolverReport SoftStep::solve(const ContactProblem& problem, Impulses& r) {
  if (!seen_) {  // a problem alone: gaps that close in 1 s as it asks, gravity has acted already
    gap_ = problem.offset;
    before_ = problem.free;
    dt_ = 1.0;
    fastest_ = infinity;
  }
  seen_ = false;
  if (problem.rotates)
    take_parts(with_rotation_, problem, r);
  else
    take_parts(without_rotation_, problem, r);
  const double residual = measure_residual(problem, r, problem.mean_effective_mass(), after_, u_).value;
  finish(problem, r);
  return {false, parts_, residual};
}

template <class S>
void SoftStep::take_parts(S& sweep, const ContactProblem& problem, Impulses& r) {
  const double h = dt_ / parts_, w = 2.0 * std::numbers::pi * std::min(frequency_, stiffest / h);
  const double a1 = 2.0 * damping_ + h * w, a2 = h * w * a1;
  const std::size_t n = problem.inverse_mass.size(), turning = problem.free.angular.size();
  const Vec3 zero = Vec3::Zero();
  for (BodyVelocities* v : {&still_, &moved_, &gained_}) {
    parallel_fill(v->linear, n, zero);
    parallel_fill(v->angular, turning, zero);
  }
  renew(first_, problem.size());
  parallel_for(n, [&](std::size_t s) { gained_.linear[s] = (problem.free.linear[s] - before_.linear[s]) / parts_; });
  for (const Guide& g : problem.guides)
    gained_.angular[g.slot] = (problem.free.angular[g.slot] - before_.angular[g.slot]) / parts_;
  parallel_for(first_.size(), [&](std::size_t i) { first_[i] = r[i] / parts_; });
  SoftRule rule{SoftRule::Task::begin_step, h, w / a1, a2 / (1.0 + a2), 1.0 / (1.0 + a2), fastest_};
  const auto run = [&](SoftRule::Task task) {
    rule.task = task;
    sweep.run(rule, false);
  };
  sweep.load(problem, gap_, {}, first_, still_);
  run(SoftRule::Task::begin_step);
  sweep.add(before_);
  for (int k = 0; k < parts_; ++k) {
    sweep.add(gained_);
    run(SoftRule::Task::begin_part);
    run(SoftRule::Task::push);
    run(SoftRule::Task::move);
    parallel_for(n, [&](std::size_t s) {
      moved_.linear[s] += h * sweep.linear(static_cast<Slot>(s));
      if constexpr (requires { sweep.angular(0); }) moved_.angular[s] += h * sweep.angular(static_cast<Slot>(s));
    });
    run(SoftRule::Task::relax);
  }
  const auto rebounds = [](double offset) { return offset < 0.0; };
  if (std::any_of(problem.offset.begin(), problem.offset.end(), rebounds)) run(SoftRule::Task::rebound);
  sweep.store(r);
  parallel_for(r.size(), [&](std::size_t i) { r[i] = project_cone(r[i] - first_[i], problem.friction[i]); });
}

/// moved_ becomes what the step is to add to dt v_{k+1}; bodies that nothing pushed move as they would alone.
void SoftStep::finish(const ContactProblem& problem, const Impulses& r) {
  parallel_for(moved_.linear.size(), [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    bool pushed = false;
    problem.incidence.for_each(s, [&](std::uint32_t i, double) { pushed = pushed || r[i].x() > 0.0; });
    pushed = pushed && problem.is_free(s);
    moved_.linear[k] = pushed ? Vec3(moved_.linear[k] - dt_ * after_.linear[k]) : Vec3::Zero();
    if (!moved_.angular.empty())
      moved_.angular[k] = pushed ? Vec3(moved_.angular[k] - dt_ * after_.angular[k]) : Vec3::Zero();
  });
}

SolverEntry soft_step_entry() {
  Entry entry{"soft-step",
              "soft constraints with substeps: a fixed, small cost per step; impulses and overlaps are approximate",
              solver_fields({{"frequency", "f", "Hz", Kind::number, 30.0, positive,
                              "natural frequency of a contact, at most a quarter of the substeps per second"},
                             {"damping_ratio", "zeta", "", Kind::number, 10.0, positive, "damping ratio of a contact"}},
                            4.0),
              solver_needs, "Catto 2024"};
  return {std::move(entry), [](const Parameters& p) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<SoftStep>(static_cast<int>(p.number_or("iterations", 4)),
                                              p.number_or("frequency", 30.0), p.number_or("damping_ratio", 10.0));
          }};
}

}  // namespace epafi
