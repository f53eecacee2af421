#include "scenes/watched_balance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace epafi {

namespace {
constexpr double warning_share = 1e-2;  // of the energy exchanged: a warning
// of the reference energy: ends the run where the scene sets no bound of its own
constexpr double ending_share = 0.5;
constexpr double booked_share =
    0.05;  // of the energy exchanged: a smaller error is one of bookkeeping, however long the run
constexpr double widest_band =
    7.5e-3;  // of the reference energy: the oscillation at 40 steps per period of a spring, plus a fifth
// steps: at the first contact of a scene at rest the energy is so small that the relative error is large
constexpr double passing = 40;
constexpr double noise_per_residual =
    1e3;  // velocity errors of a stack of 30 are 30 times those that the residual suggests
}  // namespace

void WatchedBalance::Swings::follow(double value, double band) {
  if (direction == 0.0) {
    far = value;
    if (std::abs(value - turn) > band) direction = value > turn ? 1.0 : -1.0;
    return;
  }
  if (direction * (value - far) >= 0.0) {
    far = value;
    return;
  }
  if (!(std::abs(value - far) > band)) return;
  (direction > 0 ? rises : falls) += std::abs(far - turn);
  turn = far;
  far = value;
  direction = -direction;
}

void WatchedBalance::allow_swing(double share) { band_ = std::clamp(1.2 * share, band_, widest_band); }

void WatchedBalance::note(const StepReport& report) {
  if (!report.has_solver) return;
  const double share = std::clamp(noise_per_residual * report.solver.residual, 1e-6, 1.0);
  state_.noisy_steps += share;
  state_.noise += share * report.servo_energy;
}

/// Noise of smooth contact: the kinetic energy of one rounding of positions per step, which dashpots dissipate [J].
double WatchedBalance::rounding_energy(const StepView& view) const {
  const BodyTotals all = view.totals();
  const double speed = std::numeric_limits<double>::epsilon() * all.farthest / view.dt;
  return 0.5 * static_cast<double>(view.step) * all.mass.value() * speed * speed;
}

/// Reference energy [J]. Jumps of the potential energy by added or removed bodies do not widen its spread.
double WatchedBalance::reference(const StepView& view) {
  const Energy& now = view.ledger.last();
  const double bodies = static_cast<double>(view.world.size());
  const bool same = state_.started > 0 && bodies == state_.bodies;
  const double jump = same ? 0.0 : now.potential - state_.potential;
  state_.lowest = std::min(state_.lowest + jump, now.potential);
  state_.highest = std::max(state_.highest + jump, now.potential);
  state_.inner = std::max(state_.inner, now.kinetic + now.elastic);
  state_.potential = now.potential;
  state_.bodies = bodies;
  const double steps = static_cast<double>(view.step), epsilon = std::numeric_limits<double>::epsilon();
  return state_.inner + (state_.highest - state_.lowest) + 100.0 * steps * epsilon * std::abs(now.potential);
}

void WatchedBalance::look(const StepView& view) {
  const Energy& now = view.ledger.last();
  if (view.report.has_solver) {
    const double fall = view.world.gravity.norm() * view.dt;
    state_.noise += state_.noisy_steps * 0.5 * view.totals().mass.value() * fall * fall;
    state_.noisy_steps = 0;
  }
  const double unexplained = now.stored() + now.taken - now.work, put_in = -now.taken;
  const double known = reference(view);
  if (state_.started == 0) {
    state_.started = 1;
    state_.unexplained.turn = unexplained;
    state_.put_in.turn = put_in;
  }
  const double band = band_ * (known + state_.noise);
  state_.unexplained.follow(unexplained, band);
  state_.put_in.follow(put_in, band);
  judge(view, known);
}

void WatchedBalance::begin_stage() {
  state_.unexplained.settle();
  state_.put_in.settle();
  state_.started = 0;
}

void WatchedBalance::judge(const StepView& view, double known) {
  Finding& f = finding_ = {};
  f.put_in = state_.put_in.risen();
  f.gained = state_.unexplained.risen() + f.put_in;
  f.lost = state_.unexplained.fallen();
  const double net = view.ledger.relative_error(), unexplained = view.ledger.unexplained_error();
  const double given = known + view.ledger.beside_stored();  // what the ledger's errors are relative to
  double exchanged = 0.0;
  const auto measure = [&](double noise) {
    const double least = std::numeric_limits<double>::min(), all = std::max(given + noise, least);
    const double stored = std::max(known + noise, least);
    exchanged = stored + state_.put_in.fallen();
    f.net = net * given / all;
    // in long runs a bookkeeping error of one percent of the dissipation can exceed the stored energy
    const double open = std::abs(unexplained) * given, of_all = open / exchanged;
    f.wide = std::max(of_all > booked_share ? open / stored : of_all, f.put_in / exchanged);
    f.share = std::max({std::abs(f.net), f.gained / exchanged, f.lost / exchanged});
    if (!std::isfinite(net)) f.share = f.wide = std::abs(net);
  };
  measure(state_.noise);
  if (f.share > warning_share && !view.report.has_solver) measure(rounding_energy(view));
  const double step = static_cast<double>(view.step);
  const auto lasts = [&](bool open, double& since) {
    if (!open || view.step == 0)
      since = 0;
    else if (since == 0)
      since = step;
    return since > 0 && (view.last || step - since >= passing);
  };
  f.warns = lasts(!(f.share <= warning_share), state_.since_warns);
  f.ends = lasts(!(f.wide <= ending_share), state_.since_wide) && f.warns;
}

void WatchedBalance::visit(StateVisitor& visitor) { visitor.value("monitor/balance", state_); }

}  // namespace epafi
