/// @file lane_sweep.h  The sweeps of sweep.h for rules that serve four contacts at a time: four pairs of a colour go
/// side by side (lane_groups.h), both bodies of each in registers over the points of its manifold. Rates:
/// perf/solvers.cpp.
#pragma once
#include <array>
#include <functional>
#include <span>
#include <type_traits>

#include "engine/lanes/lanes.h"
#include "engine/threads/order_free_sum.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// A local rule for lanes: how many rows of a contact it has (1: normal; 3: and both tangents), what of W_ii it keeps
/// and r from u. All 0 must leave r = 0: that is an empty lane.
template <class R>
concept LaneRule = requires(const R& rule, typename R::LaneData& data, const ContactProblem& problem, Lanes mu,
                            Lanes (&r)[R::rows], const Lanes (&u)[R::rows]) {
  R::pack(problem, 0, data, 0);
  rule.update(data, mu, r, u);  ///< changes r
};

/// Loops over groups of contacts, the same for all rules.
class LaneLoops {
 protected:
  /// The groups from begin to end, of a stage that ends with `last`.
  using Body = std::function<void(const LaneGroup* begin, const LaneGroup* end, const LaneGroup* last)>;

  explicit LaneLoops(double row_time) : row_time_(row_time) {}
  /// Stage after stage; returns the sum of change_ where it is measured.
  double run_stages(const Body& body, bool measured);
  /// Groups `first` to `last`, which share no body that moves.
  void run_groups(std::size_t first, std::size_t last, const Body& body) const;
  bool pays() const;

  const LaneGroups* groups_ = nullptr;  ///< of the problem
  UnwrittenStream<double> change_;      ///< of each pair in the last sweep, squared; 0 of empty lanes

 private:
  double row_time_;                 ///< of a row in a sweep [s]
  std::vector<OrderFreeSum> sums_;  ///< of change_, by blocks
};

template <bool Rotates, LaneRule Rule>
class LaneSweep : LaneLoops {
 public:
  LaneSweep() : LaneLoops((Rule::rows + 2) * (Rotates ? 10e-9 : 6e-9)) {}  // Zen 5: 30, 50 and 15, 30 ns, 1 or 3 rows
  /// Packs the problem; velocities start as v (those of r).
  void load(const ContactProblem& problem, const Impulses& r, const BodyVelocities& v) {
    load(problem, problem.offset, problem.lag, r, v);
  }
  /// With another w than that of the problem.
  void load(const ContactProblem& problem, std::span<const double> offset, std::span<const Vec3> lag, const Impulses& r,
            const BodyVelocities& v) {
    load(problem, problem.lane_groups(), offset, lag, r, v);
  }
  /// In these groups.
  void load(const ContactProblem& problem, const LaneGroups& groups, std::span<const double> offset,
            std::span<const Vec3> lag, const Impulses& r, const BodyVelocities& v);
  /// One update of every contact; returns the sum of |change of r|^2, 0 where it is not measured.
  double run(const Rule& rule, bool measured = true);
  /// Updates the groups of one colour alone, for callers that act between colours; measured.
  void run_color(const Rule& rule, std::size_t color);
  /// |change of r|^2 of each pair in the last sweep that was measured.
  std::span<const double> changes() const { return {change_.data(), change_.size()}; }
  void store(Impulses& r) const;
  /// Adds to the velocities of the bodies.
  void add(const BodyVelocities& v);
  /// || r - P_K(r - rho u~) || over all contacts, u from the velocities as the updates have left them (residual.h).
  double natural_map(double rho) const requires(Rule::rows == 3);
  /// Its square, pair by pair, until the next call.
  std::span<const double> natural_squares(double rho) const requires(Rule::rows == 3);

  /// Present velocity of body s [m/s].
  Vec3 linear(Slot s) const { return {bodies_[s].velocity[0], bodies_[s].velocity[1], bodies_[s].velocity[2]}; }
  /// `if constexpr` too: an explicit instantiation makes Clang 14 compile members whose `requires` fails.
  Vec3 angular(Slot s) const requires Rotates {
    Vec3 w = Vec3::Zero();
    if constexpr (Rotates)
      for (int k = 0; k < 3; ++k) w[k] = bodies_[s].angular_velocity[k];
    return w;
  }

  struct Body;
  Body& body(Slot s) { return bodies_[s]; }

  struct Nothing {};
  struct Rotation {
    Lanes angular_velocity, inertia_diagonal, inertia_rest;  ///< inverse: xx yy zz, xy xz yz
  };
  struct alignas(32) Body : std::conditional_t<Rotates, Rotation, Nothing> {
    Lanes velocity;  ///< and the inverse mass
  };
  struct Arms {
    Lanes3 arm_a, arm_b;
  };
  struct alignas(32) Row : std::conditional_t<Rotates, Arms, Nothing> {
    Lanes3 axis[Rule::rows];
    Lanes offset[Rule::rows], r[Rule::rows], friction;
    typename Rule::LaneData data;
  };

 private:
  void load_bodies(const ContactProblem& problem, const BodyVelocities& v);
  LaneLoops::Body task(const Rule& rule);

  UnwrittenColumn<Body> bodies_;  ///< the last one is that of empty lanes
  UnwrittenStream<Row> rows_;
  mutable UnwrittenStream<double> squares_;
};

}  // namespace epafi
