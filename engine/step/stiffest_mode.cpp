#include "engine/step/stiffest_mode.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/threads/order_free_sum.h"
#include "engine/units/random.h"

namespace epafi {

namespace {

/// Motion of a body, or the load on it, in units that make every mass 1.
struct Twist {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double dot(const Twist& o) const { return linear.dot(o.linear) + angular.dot(o.angular); }
};

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// sqrt(1/m) and sqrt(1/I) of a body in world axes.
struct Mobility {
  double linear = 0.0;
  Vec3 line = Vec3::Zero();  ///< of a body that moves along one line only: of length m^(-1/4)
  Mat3 angular = Mat3::Zero();
};

Mobility mobility_of(const World& world, Slot s) {
  Mobility m;
  if (!world.is_movable(s)) return m;
  m.linear = std::sqrt(world.inverse_mass[s]);
  if (!world.rotates()) return m;
  const Vec3 root = world.inverse_inertia_of(s).cwiseSqrt();
  if (world.is_isotropic(s) || !world.has_orientation()) {
    m.angular = root.x() * Mat3::Identity();
    return m;
  }
  const Mat3 turn = world.orientation[s].toRotationMatrix();
  m.angular = turn * root.asDiagonal() * turn.transpose();
  return m;
}

class LinkedBodies {
 public:
  LinkedBodies(const World& world, const std::vector<StiffLink>& links, const std::vector<PressedBody>& pressed)
      : links_(links), place_(world.size(), none) {
    for (const PressedBody& p : pressed) {
      const Slot s = world.slot_of(p.body);
      if (s == no_slot || world.is_movable(s)) continue;
      place_[s] = static_cast<std::uint32_t>(bodies_.size());
      bodies_.push_back(s);
      mobility_.emplace_back().line = p.line / std::sqrt(std::sqrt(p.mass));
    }
    ends_.reserve(links.size());
    for (const StiffLink& l : links) ends_.push_back({number(world, l.a), number(world, l.b)});
  }

  std::size_t size() const { return bodies_.size(); }
  Slot slot(std::size_t body) const { return bodies_[body]; }
  const std::vector<StiffLink>& links() const { return links_; }

  /// to = L^T (dt^2/4 K + dt C) L from, with M^-1 = L L^T.
  void apply(const std::vector<Twist>& from, std::vector<Twist>& to) const {
    std::fill(to.begin(), to.end(), Twist{});
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const StiffLink& l = links_[k];
      const auto [a, b] = ends_[k];
      Vec3 slip = Vec3::Zero(), turn = Vec3::Zero();
      if (b != none) add(from[b], mobility_[b], l.arm_b, 1.0, slip, turn);
      if (a != none) add(from[a], mobility_[a], l.arm_a, -1.0, slip, turn);
      const Vec3 load = l.across * slip + ((l.along - l.across) * l.normal.dot(slip)) * l.normal;
      const Vec3 moment = l.turn * (turn - l.normal.dot(turn) * l.normal);
      if (b != none) push(load, moment, mobility_[b], l.arm_b, to[b]);
      if (a != none) push(-load, -moment, mobility_[a], l.arm_a, to[a]);
    }
  }

  /// Trace of a link's matrix for one of its bodies, with the other at rest: sum of the eigenvalues.
  double own(std::size_t k, bool second) const {
    const StiffLink& l = links_[k];
    const std::uint32_t body = second ? ends_[k].second : ends_[k].first;
    if (body == none) return 0.0;
    const Mobility& m = mobility_[body];
    const Vec3& arm = second ? l.arm_b : l.arm_a;
    double trace =
        m.linear * m.linear * (l.along + 2.0 * l.across) + m.line.squaredNorm() * m.line.squaredNorm() * l.along;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 slip = Vec3(m.angular.col(axis)).cross(arm);
      const double straight = l.normal.dot(slip);
      trace += l.across * slip.squaredNorm() + (l.along - l.across) * straight * straight;
    }
    return trace;
  }
  /// A link's matrix for one of its bodies, with the other at rest.
  void add_own(std::size_t k, bool second, Mat6& sum) const {
    const StiffLink& l = links_[k];
    const Mobility& m = mobility_[end(k, second)];
    const Vec3& arm = second ? l.arm_b : l.arm_a;
    Eigen::Matrix<double, 3, 6> slip;
    slip.leftCols<3>() = m.linear * Mat3::Identity();
    for (int axis = 0; axis < 3; ++axis) slip.col(3 + axis) = Vec3(m.angular.col(axis)).cross(arm);
    const Eigen::Matrix<double, 1, 6> straight = l.normal.transpose() * slip;
    sum += l.across * (slip.transpose() * slip) + (l.along - l.across) * (straight.transpose() * straight);
    if (l.turn == 0.0) return;
    const Vec3 round = m.angular.transpose() * l.normal;
    sum.bottomRightCorner<3, 3>() += l.turn * (m.angular.transpose() * m.angular - round * round.transpose());
  }
  std::uint32_t end(std::size_t k, bool second) const { return second ? ends_[k].second : ends_[k].first; }

  static constexpr std::uint32_t none = 0xffffffffu;

 private:
  std::uint32_t number(const World& world, Slot s) {
    if (s == no_slot) return none;
    if (place_[s] == none && world.is_movable(s)) {
      place_[s] = static_cast<std::uint32_t>(bodies_.size());
      bodies_.push_back(s);
      mobility_.push_back(mobility_of(world, s));
    }
    return place_[s];
  }
  static void add(const Twist& x, const Mobility& m, const Vec3& arm, double sign, Vec3& slip, Vec3& turn) {
    const Vec3 spin = m.angular * x.angular;
    slip += sign * (m.linear * x.linear + m.line.dot(x.linear) * m.line + spin.cross(arm));
    turn += sign * spin;
  }
  static void push(const Vec3& load, const Vec3& moment, const Mobility& m, const Vec3& arm, Twist& to) {
    to.linear += m.linear * load + m.line.dot(load) * m.line;
    to.angular += m.angular * (arm.cross(load) + moment);
  }

  const std::vector<StiffLink>& links_;
  std::vector<std::uint32_t> place_;  ///< by slot
  std::vector<Slot> bodies_;
  std::vector<Mobility> mobility_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_;
};

double dot(const std::vector<Twist>& x, const std::vector<Twist>& y) {
  return order_free_sum(x.size(), [&](std::size_t i) { return x[i].dot(y[i]); });
}

void scale(std::vector<Twist>& x, double by) {
  for (Twist& t : x) {
    t.linear *= by;
    t.angular *= by;
  }
}

void subtract(std::vector<Twist>& x, double by, const std::vector<Twist>& y) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i].linear -= by * y[i].linear;
    x[i].angular -= by * y[i].angular;
  }
}

/// Largest eigenvalue of a symmetric tridiagonal matrix: bisection by the count of negative pivots.
double largest_of(const std::vector<double>& diagonal, const std::vector<double>& beside) {
  double low = 0.0, high = 0.0;
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    const double left = i > 0 ? beside[i - 1] : 0.0, right = i + 1 < diagonal.size() ? beside[i] : 0.0;
    high = std::max(high, diagonal[i] + left + right);
  }
  for (int k = 0; k < 50 && high - low > 1e-12 * high; ++k) {
    const double middle = 0.5 * (low + high);
    double pivot = diagonal[0] - middle;
    bool above = pivot > 0.0;
    for (std::size_t i = 1; i < diagonal.size() && !above; ++i) {
      if (pivot == 0.0) pivot = -1e-300;
      pivot = diagonal[i] - middle - beside[i - 1] * beside[i - 1] / pivot;
      above = pivot > 0.0;
    }
    (above ? low : high) = middle;
  }
  return high;
}

/// Different directions for every body, by its number.
std::vector<Twist> start_of(const World& world, const LinkedBodies& bodies) {
  std::vector<Twist> x(bodies.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    Random random(7, static_cast<std::uint64_t>(world.id[bodies.slot(i)]));
    for (int k = 0; k < 3; ++k) x[i].linear[k] = random.uniform(-1.0, 1.0);
    for (int k = 0; k < 3; ++k) x[i].angular[k] = random.uniform(-1.0, 1.0);
  }
  scale(x, 1.0 / std::sqrt(std::max(dot(x, x), 1e-300)));
  return x;
}

double lanczos(const World& world, const LinkedBodies& bodies, double enough) {
  constexpr std::size_t most = 60, least = 6;
  constexpr double sure = 1.5;      // six steps find two thirds of the largest and more
  constexpr double settled = 1e-3;  // change of the last three steps
  std::vector<Twist> now = start_of(world, bodies), before(now.size()), next(now.size());
  std::vector<double> diagonal, beside, found;
  for (std::size_t step = 0; step < most; ++step) {
    bodies.apply(now, next);
    diagonal.push_back(dot(now, next));
    found.push_back(largest_of(diagonal, beside));
    const double value = found.back();
    if (step + 1 >= least && sure * value < enough) break;
    if (step >= least && value - found[step - 3] <= settled * value) break;
    subtract(next, diagonal.back(), now);
    if (step > 0) subtract(next, beside.back(), before);
    const double length = std::sqrt(dot(next, next));
    if (!(length > 1e-12 * value)) break;
    beside.push_back(length);
    scale(next, 1.0 / length);
    before.swap(now);
    now.swap(next);
  }
  return found.back();
}

}  // namespace

StiffestMode stiffest_mode(const World& world, const std::vector<StiffLink>& links, double enough,
                           const std::vector<PressedBody>& pressed) {
  StiffestMode out;
  const LinkedBodies bodies(world, links, pressed);
  if (bodies.size() == 0) return out;
  out.value = lanczos(world, bodies, enough);
  std::vector<double> held(bodies.size(), 0.0), stiffest(bodies.size(), 0.0);
  std::vector<std::size_t> link(bodies.size(), 0), count(bodies.size(), 0);
  for (std::size_t k = 0; k < links.size(); ++k)
    for (const bool second : {false, true}) {
      const std::uint32_t body = bodies.end(k, second);
      if (body == LinkedBodies::none) continue;
      const double own = bodies.own(k, second);
      held[body] += own;
      ++count[body];
      if (own <= stiffest[body]) continue;
      stiffest[body] = own;
      link[body] = k;
    }
  const auto most = static_cast<std::size_t>(std::max_element(held.begin(), held.end()) - held.begin());
  out.body = bodies.slot(most);
  out.link = link[most];
  out.links = count[most];
  return out;
}

namespace {
/// At least the largest eigenvalue of a matrix that has none below 0, at most 6^(1/8) times it: the eighth root of the
/// sum of their eighth powers.
double most_of(const Mat6& m) {
  const double trace = m.trace();
  if (!(trace > 0.0) || !std::isfinite(trace)) return trace == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  const Mat6 part = m / trace, square = part * part;
  return trace * std::sqrt(std::sqrt((square * square).norm()));
}
}  // namespace

double stiffness_bound(const World& world, const std::vector<StiffLink>& links) {
  const LinkedBodies bodies(world, links, {});
  std::vector<Mat6> held(bodies.size(), Mat6::Zero());
  for (std::size_t k = 0; k < links.size(); ++k)
    for (const bool second : {false, true})
      if (const std::uint32_t body = bodies.end(k, second); body != LinkedBodies::none)
        bodies.add_own(k, second, held[body]);
  double largest = 0.0;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (world.owner.empty() || world.owner[bodies.slot(i)] == World::here)
      largest = std::max(largest, most_of(held[i]));
  return 2.0 * (1.0 + 1e-9) * largest;
}

}  // namespace epafi
