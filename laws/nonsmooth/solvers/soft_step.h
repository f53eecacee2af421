/// @file soft_step.h  Soft constraints with substeps (Catto 2024, "Solver2D": soft step): the real-time end of the
/// list. The step is cut into n parts of h = dt/n. In each, gravity acts for h, the impulses of the last part are
/// applied, one sweep answers overlap g < 0 by a spring-damper of frequency f and damping ratio zeta,
///   u_N + a g >= 0 softened by  r' = -m (u + b g)/W_NN - i r,   a1 = 2 zeta + h w, b = w / a1, a2 = h w a1,
///   m = a2 / (1 + a2), i = 1 / (1 + a2), w = 2 pi f, f at most a quarter of 1/h,
/// bodies and gaps move on by h v, and one sweep without the spring takes out what it pushed. Cost: 4 sweeps a part,
/// known beforehand, no test of convergence. It solves no cone problem: overlaps of g_n / (2 pi f)^2 stay under load,
/// impulses lag behind; the residual tells it. Positions come from the parts, so the position correction is not asked.
/// Needs a scene: a problem file has no gaps.
#pragma once
#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/lane_sweep.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

/// Task of a pass over the rows; r of a row is the sum of impulses so far, base its value before this substep.
struct SoftRule {
  enum class Task { begin_step, begin_part, push, move, relax, rebound };
  Task task = Task::relax;
  double part = 0.0;                                         ///< h [s]
  double bias = 0.0, mass_scale = 1.0, impulse_scale = 0.0;  ///< b [1/s], m, i
  double fastest = 0.0;                                      ///< of a push [m/s]

  static constexpr int rows = 3;
  struct LaneData {
    Lanes step_n, step_t, coupling1, coupling2;
    Lanes first_gap, gap, rebound;  ///< rows arrive with the gap as their offset: it is taken off u
    Lanes base[3];
  };
  static void pack(const ContactProblem& problem, std::size_t i, LaneData& data, std::size_t lane);
  EPAFI_LANES void update(LaneData& d, Lanes mu, Lanes (&r)[3], const Lanes (&u)[3]) const;

 private:
  EPAFI_LANES void solve(const LaneData& d, Lanes mu, Lanes velocity, Lanes (&r)[3], const Lanes (&u)[3]) const;
};

class SoftStep final : public ContactSolver {
 public:
  /// parts >= 1; frequency [Hz] and damping ratio > 0.
  SoftStep(int parts, double frequency, double damping) : parts_(parts), frequency_(frequency), damping_(damping) {}
  using ContactSolver::solve;
  void see(const World& world, const BodyVelocities& before, const ContactSet& contacts, double dt) override;
  SolverReport solve(const ContactProblem& problem, Impulses& r) override;
  const BodyVelocities* displacement() const override { return &moved_; }

 private:
  template <class S>
  void take_parts(S& sweep, const ContactProblem& problem, Impulses& r);
  void finish(const ContactProblem& problem, const Impulses& r);

  int parts_;
  bool seen_ = false;  ///< the step that the next problem belongs to
  double frequency_, damping_, dt_ = 0.0, fastest_ = 0.0;
  UnwrittenStream<double> gap_;
  BodyVelocities before_, gained_, still_, moved_, after_;  ///< v_k; h a; 0; displacements beside dt v_{k+1}; v_{k+1}
  Impulses first_;
  std::vector<Vec3> u_;
  LaneSweep<true, SoftRule> with_rotation_;
  LaneSweep<false, SoftRule> without_rotation_;
};

EPAFI_LANES void SoftRule::update(LaneData& d, Lanes mu, Lanes (&r)[3], const Lanes (&u)[3]) const {
  const Lanes velocity = u[0] - d.first_gap;
  switch (task) {
    case Task::begin_step:
      d.first_gap = d.gap = u[0];
      return;
    case Task::begin_part:
      for (int k = 0; k < 3; ++k) {
        const Lanes before = r[k];
        r[k] = before + (before - d.base[k]);
        d.base[k] = before;
      }
      return;
    case Task::move:
      d.gap += part * velocity;
      return;
    default:
      solve(d, mu, velocity, r, u);
  }
}

EPAFI_LANES void SoftRule::solve(const LaneData& d, Lanes mu, Lanes velocity, Lanes (&r)[3],
                                 const Lanes (&u)[3]) const {
  const bool whole = task == Task::rebound;  // of the step, not of this part
  const LaneMask open = d.gap > Lanes{}, soft = task == Task::push ? ~open : open & ~open;
  const Lanes demand = whole ? d.rebound : select(open, d.gap / part, max(lanes(-fastest), bias * d.gap));
  const Lanes asked = task == Task::relax ? select(open, demand, Lanes{}) : demand;
  const Lanes m = select(soft, lanes(mass_scale), lanes(1.0)), i = select(soft, lanes(impulse_scale), Lanes{});
  Lanes from[3];
  for (int k = 0; k < 3; ++k) from[k] = whole ? Lanes{} : d.base[k];
  const Lanes last = r[0] - from[0];
  Lanes normal = max(Lanes{}, last - m * d.step_n * (velocity + asked) - i * last);
  const LaneMask rebounds = (d.rebound < Lanes{}) & (last > Lanes{});
  if (whole) normal = select(rebounds, max(last, normal), last);
  const Lanes change = normal - last;
  const Lanes t1 = r[1] - from[1] - d.step_t * (u[1] + d.coupling1 * change),
              t2 = r[2] - from[2] - d.step_t * (u[2] + d.coupling2 * change);
  const Lanes radius = mu * normal, length2 = t1 * t1 + t2 * t2;
  const Lanes scale = select(length2 > radius * radius, radius / sqrt(max(length2, lanes(1e-300))), lanes(1.0));
  const LaneMask all = whole ? rebounds : ~(open & ~open);
  r[0] = select(all, from[0] + normal, r[0]);
  r[1] = select(all, from[1] + scale * t1, r[1]);
  r[2] = select(all, from[2] + scale * t2, r[2]);
}

}  // namespace epafi
