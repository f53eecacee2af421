#include "laws/nonsmooth/energetic_impact.h"

#include <algorithm>
#include <cmath>

#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {

constexpr double share_of_change = 0.05;  // of u_T or of the approach, that one Runge-Kutta step changes
constexpr double slip_stopped = 1e-10;    // of the approach: slower slips have stopped
constexpr int most_steps = 4000;          // 300 take a slip to `slip_stopped`
constexpr double uncoupled = 1e-9;        // of W_NN

/// Velocity at the contact, impulse so far and work of its normal part, over the normal impulse p.
struct ImpactMoment {
  Vec3 u = Vec3::Zero();  ///< [m/s]
  Vec3 r = Vec3::Zero();  ///< [N s]
  double work = 0.0;      ///< [J], < 0 in compression
};

/// End of a phase of the impact: of compression, or a given work of the normal impulse.
struct ImpactGoal {
  bool compression = true;
  double work = 0.0;
  /// Negative before the goal, not negative at it or beyond.
  double excess(const ImpactMoment& m) const { return compression ? m.u.x() : m.work - work; }
};

class ImpactPath {
 public:
  ImpactPath(const Mat3& w, double mu, const Vec3& u) : w_(w), mu_(mu), speed_(-u.x()) { now_.u = u; }

  /// Integrates to the goal.
  void run(const ImpactGoal& goal) {
    for (int k = 0; k < most_steps && goal.excess(now_) < 0.0; ++k) {
      const double slip = tangential_norm(now_.u);
      if (straight_ || slip <= slip_stopped * speed_) return finish_straight(goal);
      step_bent(goal, slip);
    }
  }
  const ImpactMoment& now() const { return now_; }

 private:
  Vec3 impulse_rate(const Vec3& u) const {
    const double slip = tangential_norm(u);
    return {1.0, -mu_ * u.y() / slip, -mu_ * u.z() / slip};
  }

  /// One step of the classical Runge-Kutta method over dp, from now_.
  ImpactMoment advanced(double dp) const {
    const Vec3 f1 = impulse_rate(now_.u), u1 = now_.u + 0.5 * dp * (w_ * f1);
    const Vec3 f2 = impulse_rate(u1), u2 = now_.u + 0.5 * dp * (w_ * f2);
    const Vec3 f3 = impulse_rate(u2), u3 = now_.u + dp * (w_ * f3);
    const Vec3 f4 = impulse_rate(u3);
    ImpactMoment out = now_;
    const Vec3 change = dp / 6.0 * (f1 + 2.0 * f2 + 2.0 * f3 + f4);
    out.r += change;
    out.u += w_ * change;
    out.work += dp / 6.0 * (now_.u.x() + 2.0 * u1.x() + 2.0 * u2.x() + u3.x());
    return out;
  }

  void step_bent(const ImpactGoal& goal, double slip) {
    const Vec3 rate = w_ * impulse_rate(now_.u);
    const double turn = std::max(tangential_norm(rate), 1e-3 * w_(0, 0));
    const double normal = std::max(std::abs(rate.x()), 1e-3 * w_(0, 0));
    const double dp = share_of_change * std::min(slip / turn, speed_ / normal);
    ImpactMoment next = advanced(dp);
    if (goal.excess(next) < 0.0) {
      now_ = next;
      return;
    }
    double low = 0.0, high = dp;
    for (int k = 0; k < 60 && high - low > 1e-15 * dp; ++k) {
      const double middle = 0.5 * (low + high);
      next = advanced(middle);
      (goal.excess(next) < 0.0 ? low : high) = middle;
    }
    now_ = advanced(high);
  }

  /// Friction over p after slip has stopped: that of sticking, or of slip that starts along a straight line.
  Vec3 resting_rate() const {
    const double w11 = w_(1, 1), w22 = w_(2, 2), w12 = w_(1, 2), n1 = w_(1, 0), n2 = w_(2, 0);
    // f of (W_TT + lambda) f = -W_TN: lambda = 0 sticks; sliding, f = -mu t with du_T/dp = (lambda mu) t
    const auto at = [&](double lambda) {
      const double a = w11 + lambda, b = w22 + lambda, inverse = 1.0 / (a * b - w12 * w12);
      return Vec3(1.0, -(b * n1 - w12 * n2) * inverse, -(a * n2 - w12 * n1) * inverse);
    };
    const auto size = [](const Vec3& f) { return tangential_norm(f); };
    if (size(at(0.0)) <= mu_) return at(0.0);
    double low = 0.0, high = w11 + w22;
    while (size(at(high)) > mu_) high *= 2.0;
    for (int k = 0; k < 100 && high - low > 1e-15 * high; ++k) {
      const double middle = 0.5 * (low + high);
      (size(at(middle)) > mu_ ? low : high) = middle;
    }
    return at(high);
  }

  /// Stuck, or sliding along a straight line from rest: u changes at one rate from here on.
  void finish_straight(const ImpactGoal& goal) {
    if (!straight_) rate_ = resting_rate();
    straight_ = true;
    const Vec3 change = w_ * rate_;  // its normal part is positive: W is positive definite
    double dp = -now_.u.x() / change.x();
    if (!goal.compression) {
      // work + u_N p + change_N p^2 / 2 = goal
      const double lack = goal.work - now_.work, u = now_.u.x();
      dp = 2.0 * lack / (u + std::sqrt(u * u + 2.0 * change.x() * lack));
    }
    now_.work += dp * (now_.u.x() + 0.5 * dp * change.x());
    now_.u += dp * change;
    now_.r += dp * rate_;
  }

  const Mat3& w_;
  double mu_, speed_;
  ImpactMoment now_;
  bool straight_ = false;
  Vec3 rate_ = Vec3::Zero();
};

}  // namespace

bool is_eccentric(const Mat3& w, double mu) { return mu > 0.0 && tangential_norm(w.col(0)) > uncoupled * w(0, 0); }

Vec3 energetic_impulse(const Mat3& w, double mu, double restitution, const Vec3& u) {
  ImpactPath impact(w, mu, u);
  impact.run({});
  const double compression = impact.now().work;
  if (restitution > 0.0) impact.run({.compression = false, .work = (1.0 - restitution * restitution) * compression});
  return impact.now().r;
}

}  // namespace epafi
