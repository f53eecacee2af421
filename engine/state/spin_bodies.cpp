#include "engine/state/spin_bodies.h"

#include <array>

#include "engine/lanes/lane_bits.h"

namespace epafi {

namespace {

/// One body a lane.
template <LaneVector V>
struct SpinLanes {
  using Vectors = VectorsOf<V>;
  struct Turn {
    V w, x, y, z;
  };

  Turn q;            ///< body to world
  Vectors momentum;  ///< world axes
  Vectors inverse;   ///< of the principal moments
  MaskOf<V> far{};   ///< lanes outside the range of the series below

  EPAFI_LANES static V all(double x) { return V{} + x; }
  EPAFI_LANES static V pick(MaskOf<V> first, MaskOf<V> second, const Vectors& of) {
    return select(first, of.x, select(second, of.y, of.z));
  }

  /// As Eigen adds them.
  EPAFI_LANES static Turn product(const Turn& a, const Turn& b) {
    return {(a.w * b.w - a.y * b.y) - (a.z * b.z + a.x * b.x), (a.w * b.x + a.y * b.z) - (a.z * b.y - a.x * b.w),
            (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z), (a.w * b.z - a.y * b.x) + (a.z * b.w + a.x * b.y)};
  }

  /// The series of sin_cos.
  EPAFI_LANES void sin_cos(V x, V& sin, V& cos) {
    far = far | ~((x < 0.75) & (x > -0.75));
    const V z = x * x;
    V s = all(-1.0 / 1307674368000.0), c = all(1.0 / 20922789888000.0);
    s = s * z + 1.0 / 6227020800.0;
    s = s * z + -1.0 / 39916800;
    s = s * z + 1.0 / 362880;
    s = s * z + -1.0 / 5040;
    s = s * z + 1.0 / 120;
    s = s * z + -1.0 / 6;
    s = s * z + 1.0;
    c = c * z + -1.0 / 87178291200.0;
    c = c * z + 1.0 / 479001600.0;
    c = c * z + -1.0 / 3628800;
    c = c * z + 1.0 / 40320;
    c = c * z + -1.0 / 720;
    c = c * z + 1.0 / 24;
    c = c * z + -1.0 / 2;
    c = c * z + 1.0;
    sin = s * x;
    cos = c;
  }

  /// About the body axis that the masks of x and y name, or about z; `body`: the momentum in body axes.
  EPAFI_LANES void turn_about(MaskOf<V> is_x, MaskOf<V> is_y, V angle, Vectors& body) {
    V sin, cos;
    sin_cos(0.5 * angle, sin, cos);
    const V none = all(0.0);
    const MaskOf<V> still = angle == none;  // of a body with two equal moments in two turns of three
    const Turn step{cos, select(is_x, sin, none), select(is_y, sin, none), select(is_x | is_y, none, sin)};
    const Turn turned = product(q, step);
    q = {select(still, q.w, turned.w), select(still, q.x, turned.x), select(still, q.y, turned.y),
         select(still, q.z, turned.z)};
    const V c = cos * cos - sin * sin, s = 2.0 * sin * cos;
    const V mi = select(is_x, body.y, select(is_y, body.z, body.x));
    const V mj = select(is_x, body.z, select(is_y, body.x, body.y));
    const V i = select(still, mi, c * mi + s * mj), j = select(still, mj, c * mj - s * mi);
    body = {select(is_x, body.x, select(is_y, j, i)), select(is_x, i, select(is_y, body.y, j)),
            select(is_x, j, select(is_y, i, body.z))};
  }

  /// As Quat turns a vector.
  EPAFI_LANES Vectors to_body() const {
    const Vectors axis{-q.x, -q.y, -q.z};
    const Vectors cross = axis.cross(momentum), twice = cross + cross;
    return (momentum + q.w * twice) + axis.cross(twice);
  }

  /// See rotate_freely.
  EPAFI_LANES void turn(double dt) {
    const Vectors& v = inverse;
    const MaskOf<V> y_low = v.y < v.x, z_low = v.z < select(y_low, v.y, v.x);
    const MaskOf<V> y_high = v.y >= v.x, z_high = v.z >= select(y_high, v.y, v.x);
    const MaskOf<V> low_x = ~(y_low | z_low), low_y = y_low & ~z_low;
    const MaskOf<V> high_x = ~(y_high | z_high), high_y = y_high & ~z_high;
    const V low = pick(low_x, low_y, v), high = pick(high_x, high_y, v);
    const V middle = pick(~(low_x | high_x), ~(low_y | high_y), v);
    Vectors body = to_body();
    turn_about(low_x, low_y, 0.5 * dt * (low - middle) * pick(low_x, low_y, body), body);
    turn_about(high_x, high_y, dt * (high - middle) * pick(high_x, high_y, body), body);
    turn_about(low_x, low_y, 0.5 * dt * (low - middle) * pick(low_x, low_y, body), body);
    turn_in_space((middle * dt) * momentum);
  }

  /// See turned.
  EPAFI_LANES void turn_in_space(const Vectors& angle) {
    const V square = angle.x * angle.x + angle.y * angle.y + angle.z * angle.z;
    far = far | ~(square < 4e-4);
    const V h = 0.25 * square;
    const V half_sinc = 0.5 - h * (1.0 / 12 - h * (1.0 / 240 - h * (1.0 / 10080)));
    const V c = 1.0 - h * (0.5 - h * (1.0 / 24 - h * (1.0 / 720)));
    const V x = half_sinc * angle.x, y = half_sinc * angle.y, z = half_sinc * angle.z;
    const V w = c * q.w - x * q.x - y * q.y - z * q.z, i = c * q.x + x * q.w + y * q.z - z * q.y;
    const V j = c * q.y + y * q.w + z * q.x - x * q.z, k = c * q.z + z * q.w + x * q.y - y * q.x;
    const V unit = 1.5 - 0.5 * (w * w + i * i + j * j + k * k);
    q = {unit * w, unit * i, unit * j, unit * k};
  }

  /// See World::apply_inverse_inertia.
  EPAFI_LANES Vectors velocity() const {
    const V tx = 2.0 * q.x, ty = 2.0 * q.y, tz = 2.0 * q.z;
    const V wx = tx * q.w, wy = ty * q.w, wz = tz * q.w, xx = tx * q.x, xy = ty * q.x, xz = tz * q.x;
    const V yy = ty * q.y, yz = tz * q.y, zz = tz * q.z;
    const Vectors first{1.0 - (yy + zz), xy + wz, xz - wy}, second{xy - wz, 1.0 - (xx + zz), yz + wx},
        third{xz + wy, yz - wx, 1.0 - (xx + yy)};
    const V x = inverse.x * first.dot(momentum), y = inverse.y * second.dot(momentum),
            z = inverse.z * third.dot(momentum);
    // Eigen adds the first two of three by packets, from the left, and the last one from the right
    return {first.x * x + second.x * y + third.x * z, first.y * x + second.y * y + third.y * z,
            first.z * x + (second.z * y + third.z * z)};
  }
};

struct Spin {
  World& world;
  double kick;
  int kicks;
  double turn;
  std::size_t begin, end;

  template <int n>
  EPAFI_LANES void run() const {
    std::array<Slot, n> slots;
    int count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto s = static_cast<Slot>(i);
      if (world.is_isotropic(s)) continue;
      slots[static_cast<std::size_t>(count++)] = s;
      if (count == n) several<n>(slots.data());
      count %= n;
    }
    for (int l = 0; l < count; ++l) one(slots[static_cast<std::size_t>(l)]);
  }

 private:
  [[gnu::noinline]] void one(Slot s) const {
    for (int k = 0; k < kicks; ++k) world.apply_angular_impulse(s, kick * world.torque[s]);
    if (turn != 0.0) world.rotate(s, turn);
  }

  template <int n>
  EPAFI_LANES void several(const Slot* slots) const {
    using V = typename LanesOf<n>::Real;
    SpinLanes<V> lanes{};
    VectorsOf<V> torque{};
    for (int l = 0; l < n; ++l) {
      const double* q = world.orientation[slots[l]].coeffs().data();
      lanes.q.x[l] = q[0];
      lanes.q.y[l] = q[1];
      lanes.q.z[l] = q[2];
      lanes.q.w[l] = q[3];
      put(world.angular_momentum[slots[l]].data(), l, lanes.momentum);
      put(world.inverse_inertia[slots[l]].data(), l, lanes.inverse);
      put(world.torque[slots[l]].data(), l, torque);
    }
    for (int k = 0; k < kicks; ++k) lanes.momentum = lanes.momentum + kick * torque;
    if (turn != 0.0) lanes.turn(turn);
    const VectorsOf<V> w = lanes.velocity();
    for (int l = 0; l < n; ++l) {
      if (lanes.far[l] != 0) {
        one(slots[l]);
        continue;
      }
      double* q = world.orientation[slots[l]].coeffs().data();
      q[0] = lanes.q.x[l];
      q[1] = lanes.q.y[l];
      q[2] = lanes.q.z[l];
      q[3] = lanes.q.w[l];
      take(lanes.momentum, l, world.angular_momentum[slots[l]].data());
      take(w, l, world.angular_velocity[slots[l]].data());
    }
  }

  template <LaneVector V>
  EPAFI_LANES static void put(const double* from, int lane, VectorsOf<V>& to) {
    to.x[lane] = from[0];
    to.y[lane] = from[1];
    to.z[lane] = from[2];
  }
  template <LaneVector V>
  EPAFI_LANES static void take(const VectorsOf<V>& from, int lane, double* to) {
    to[0] = from.x[lane];
    to[1] = from.y[lane];
    to[2] = from.z[lane];
  }
};

}  // namespace

void spin_bodies(World& world, double kick, int kicks, double turn, std::size_t begin, std::size_t end) {
  best_loop<Spin>()({world, kick, kicks, turn, begin, end});
}

}  // namespace epafi
