// Law `energetic`: single impacts. A central impact on a fixed or driven body (always so for spheres) happens at its
// own time along the detected normal: u_N- contains gravity until then, and the body is displaced by -t dv. It is then
// on the exact parabola after the impact at any dt, so no energy is gained. Overlapping contacts have closed in the
// past; the displacement then leads out of the overlap. At the end of the step a body with a later impact is up to dt/2
// e |u_N-| below the surface, and outside again at the next detection. Rotations are not corrected, since with unequal
// moments of inertia this would change the energy. The normal of two free bodies rotates until they meet, and a
// displacement along the detected one would change the angular momentum; so they collide in the middle of the step.
#include <algorithm>
#include <cmath>

#include "laws/nonsmooth/energetic_impact.h"
#include "laws/nonsmooth/impact.h"
#include "laws/nonsmooth/solvers/nsgs.h"

namespace epafi {

namespace {

constexpr double central_rounding = 1e-9;  // of W_NN: arms of 3e-5 of the radius of gyration

/// True if contact i joins a free body to a fixed or driven one, and a normal impulse does not rotate it.
bool is_central(const ContactProblem& problem, std::size_t i, const Mat3& w) {
  if (problem.is_free(problem.a[i]) && problem.is_free(problem.b[i])) return false;
  const double translation = problem.inverse_mass[problem.a[i]] + problem.inverse_mass[problem.b[i]];
  return w(0, 0) - translation <= central_rounding * translation;
}

/// Time at which the contact closes, from the middle of the step [s], in [-dt, dt]. Positions in the middle are those
/// of v_k alone.
double closing_time(double found_gap, const Bounce& bounce, double dt) {
  const double gap = found_gap - 0.25 * dt * bounce.half, gravity = 2.0 * bounce.half / dt;
  const double square = bounce.middle * bounce.middle + 2.0 * gravity * gap;
  if (square < 0.0) return 0.0;  // gravity alone does not close it
  return std::clamp(2.0 * gap / (bounce.middle + std::sqrt(square)), -dt, dt);
}

}  // namespace

/// True if no other contact of the free bodies of contact i closes in this step.
bool Impacts::is_single(const ContactProblem& problem, std::size_t i, const Step& step) const {
  bool single = true;
  for (const Slot s : {problem.a[i], problem.b[i]}) {
    if (!problem.is_free(s)) continue;
    problem.incidence.for_each(s, [&](std::uint32_t k, double) {
      if (k == i || problem.mobility[k] <= 0.0) return;
      const double approach = -problem.relative_velocity(k, problem.free).x();
      if (step.gap[k] <= 0.0 || step.gap[k] < step.dt * approach) single = false;
    });
  }
  return single;
}

/// Moves contact i to the time of impact: both arms end at the common point.
Impacts::Strike Impacts::strike_central(ContactProblem& problem, std::size_t i, const Step& step,
                                        const Bounce& bounce) const {
  if (problem.rotates) {
    const Vec3 half_gap = 0.5 * step.gap[i] * problem.frame[i].normal;
    problem.arm_a[i] -= half_gap;
    problem.arm_b[i] += half_gap;
  }
  const double time = closing_time(step.gap[i], bounce, step.dt);
  const Vec3 first = problem.relative_velocity(i, step.before), last = problem.relative_velocity(i, problem.free);
  Vec3 u = 0.5 * (first + last) + time / step.dt * (last - first);
  if (u.x() >= 0.0) return {i, Vec3::Zero(), 0.0};
  u.x() *= 1.0 + bounce.restitution;
  return {i, NsgsRule::solve(NsgsRule::pack(problem.diagonal_of(i)), problem.friction[i], u), time};
}

/// The impulse at contact i; none if this law does not apply.
std::optional<Impacts::Strike> Impacts::strike(ContactProblem& problem, std::size_t i, const Step& step,
                                               const Bounce& bounce) const {
  const Mat3 w = problem.diagonal_of(i);
  const bool central = is_central(problem, i, w);
  if (central && !step.locates) return std::nullopt;
  const bool slow = -problem.relative_velocity(i, step.before).x() <= step.threshold;
  if (!central && (slow || !is_eccentric(w, problem.friction[i]))) return std::nullopt;
  if (!is_single(problem, i, step)) return std::nullopt;
  if (central) return strike_central(problem, i, step, bounce);
  const Vec3 middle = 0.5 * (problem.relative_velocity(i, step.before) + problem.relative_velocity(i, problem.free));
  return Strike{i, energetic_impulse(w, problem.friction[i], bounce.restitution, middle), 0.0};
}

bool Impacts::strike_single(ContactProblem& problem, const Step& step, ImpactBalance& balance) {
  std::vector<Strike> strikes;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Bounce& bounce = balance.bounce(i);
    if (bounce.middle <= 0.0) continue;
    if (const auto found = strike(problem, i, step, bounce))
      strikes.push_back(*found);
    else if (-problem.relative_velocity(i, step.before).x() <= step.threshold)
      balance.drop(i);  // too slow for all others
  }
  if (strikes.empty()) return false;
  r_.assign(problem.size(), Vec3::Zero());
  for (BodyVelocities* v : {&shift_, &struck_}) {
    v->linear.assign(problem.free.linear.size(), Vec3::Zero());
    v->angular.assign(problem.free.angular.size(), Vec3::Zero());
  }
  for (const Strike& strike : strikes) {
    const std::size_t i = strike.contact;
    problem.push(problem.free, i, strike.impulse);
    problem.push(struck_, i, strike.impulse);
    problem.push(shift_, i, -strike.time * strike.impulse);
    problem.offset[i] = std::max(0.0, step.gap[i] / step.dt);
    balance.drop(i);
    r_[i] = strike.impulse;
  }
  shift_.angular.assign(problem.free.angular.size(), Vec3::Zero());
  events_ += strikes.size();
  return true;
}

}  // namespace epafi
