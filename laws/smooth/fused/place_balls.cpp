#include "laws/smooth/fused/place_balls.h"

#include <cstring>

#include "engine/lanes/lane_bits.h"
#include "engine/lanes/targets.h"

namespace epafi {
namespace {

EPAFI_LANES Lanes row_of(const Vec3& x) { return Lanes{x.x(), x.y(), x.z(), 0.0}; }
EPAFI_LANES Lanes with(Lanes x, double fourth) {
  x[3] = fourth;
  return x;
}
EPAFI_LANES void write_three(double* to, Lanes x) {
  for (int k = 0; k < 3; ++k) to[k] = x[k];
}
EPAFI_LANES Lanes cross(Lanes a, Lanes b) {
  const Lanes a_yzx = __builtin_shufflevector(a, a, 1, 2, 0, 3), a_zxy = __builtin_shufflevector(a, a, 2, 0, 1, 3);
  const Lanes b_yzx = __builtin_shufflevector(b, b, 1, 2, 0, 3), b_zxy = __builtin_shufflevector(b, b, 2, 0, 1, 3);
  return a_yzx * b_zxy - a_zxy * b_yzx;
}

/// Columns of a rotation.
struct Turn {
  Lanes x{1.0, 0.0, 0.0, 0.0}, y{0.0, 1.0, 0.0, 0.0}, z{0.0, 0.0, 1.0, 0.0};

  /// Quat::toRotationMatrix
  EPAFI_LANES void take(const Quat& q) {
    const double tx = 2.0 * q.x(), ty = 2.0 * q.y(), tz = 2.0 * q.z();
    const double wx = tx * q.w(), wy = ty * q.w(), wz = tz * q.w(), xx = tx * q.x(), xy = ty * q.x(), xz = tz * q.x();
    const double yy = ty * q.y(), yz = tz * q.y(), zz = tz * q.z();
    x = Lanes{1.0 - (yy + zz), xy + wz, xz - wy, 0.0};
    y = Lanes{xy - wz, 1.0 - (xx + zz), yz + wx, 0.0};
    z = Lanes{xz + wy, yz - wx, 1.0 - (xx + yy), 0.0};
  }
  /// Eigen adds the first two of three by packets, from the left, and the last one from the right.
  EPAFI_LANES Lanes of(double a, double b, double c) const {
    const Lanes p = a * x, q = b * y, r = c * z;
    return __builtin_shufflevector((p + q) + r, p + (q + r), 0, 1, 6, 7);
  }
};
EPAFI_LANES double dot(Lanes a, const Vec3& b) { return (a[0] * b.x() + a[1] * b.y()) + a[2] * b.z(); }

struct PlaceBalls {
  const BallsOfBody& in;

  template <int n>
  EPAFI_LANES void run() const {
    Turn turn;
    if (in.orientation != nullptr) turn.take(*in.orientation);
    const Lanes spin = row_of(in.spin), rate = row_of(in.strain_rate);
    Lanes late = spin;
    const Vec3 &i = in.inverse_inertia, &t = in.twist;
    if (in.is_late) late = spin + turn.of(i.x() * dot(turn.x, t), i.y() * dot(turn.y, t), i.z() * dot(turn.z, t));
    const double inverse_moment = ((i.x() + i.y()) + i.z()) / 3.0;  // the harmonic mean of the moments
    const Lanes position = in.body.position, velocity = in.body.velocity, predicted = in.body.predicted;
    for (const std::uint32_t k : in.used) {
      const BodyBall& ball = in.balls[k];
      const Lanes offset = turn.of(ball.centre.x(), ball.centre.y(), ball.centre.z());
      const Lanes flow = rate * offset;  // the flow of the cell is that at the body's centre
      write_three(in.offsets[k].data(), offset);
      BodyState& state = in.states[k];
      state.position = with(position + offset, ball.radius);
      state.velocity = with(velocity + (cross(spin, offset) - flow), velocity[3]);
      state.spin = with(spin, ball.radius);
      state.predicted = with(predicted + (cross(late, offset) - flow), inverse_moment);
      if (in.late_spins != nullptr) in.late_spins[k] = with(late, inverse_moment);
    }
  }
};

struct Collect {
  const FeltByBalls& in;

  template <int n>
  EPAFI_LANES void run() const {
    for (const std::uint32_t k : in.used) {
      SphereSum& sum = in.sums[k - in.begin];
      const Lanes force = with(sum.first, 0.0);
      Lanes torque = in.balls[k].radius * Lanes{sum.first[3], sum.second[0], sum.second[1], 0.0};
      sum = SphereSum{};
      if (in.moments != nullptr) {
        Lanes& moment = in.moments[k - in.begin];
        torque = torque + moment;
        moment = Lanes{};
      }
      if (in.offsets != nullptr) torque = torque + cross(row_of(in.offsets[k]), force);
      write_three(in.loads + 6 * k, force);
      write_three(in.loads + 6 * k + 3, torque);
    }
  }
};

}  // namespace

void place_balls(const BallsOfBody& balls) { best_loop<PlaceBalls, BallsOfBody>()(balls); }
void collect_balls(const FeltByBalls& felt) { best_loop<Collect, FeltByBalls>()(felt); }

}  // namespace epafi
