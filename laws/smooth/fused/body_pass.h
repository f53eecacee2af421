/// @file body_pass.h  The two passes over bodies of a kick-drift-kick step, with what the loop over contacts reads and
/// writes. Bodies that are not plain (held, or with unequal moments) are left to the scheme. The same operations in the
/// same order as engine/schemes/velocity_verlet.h and engine/world.h: the same bits.
#pragma once
#include "engine/domain.h"
#include "engine/pipeline.h"
#include "laws/smooth/fused/sphere_blocks.h"
#include "laws/smooth/fused/sphere_lanes.h"

namespace epafi {

/// Velocities `lag` later than those of slots [begin, end), which the loop over contacts reads; late_spins: null where
/// nobody reads them.
void predict_bodies(World& world, double lag, Lanes* late_spins, std::size_t begin, std::size_t end);
/// Writes force and torque of slots [begin, end), added where `touched` says so; the sums and moments (or null), of
/// slots from `begin` on, are 0 again then.
void unpack_bodies(World& world, SphereSum* sums, Lanes* moments, const std::uint8_t* touched, std::size_t begin,
                   std::size_t end);
/// The columns of the world allow the passes over rows.
bool has_plain_bodies(const World& world);
/// The four bodies from slot `begin` on are all free and of equal moments.
bool are_plain(const World& world, std::size_t begin);

/// x y z of a sum; the fourth is 0.
template <int n>
EPAFI_LANES RowOf<n> force_of(const SphereSum& sum) {
  if constexpr (n == 2)
    return RowOf<n>{row<n>(sum.first).xy, LanesOf<2>::Real{sum.first[2], 0.0}};
  else
    return without_fourth(sum.first);
}
template <int n>
EPAFI_LANES RowOf<n> pull_of(const SphereSum& sum) {
  const double* pull = reinterpret_cast<const double*>(&sum) + 3;
  RowOf<n> out;
  if constexpr (n == 2)  // as one, GCC 12 copies it through memory
    std::memcpy(&out.xy, pull, sizeof out.xy), std::memcpy(&out.zw, pull + 2, sizeof out.zw);
  else
    std::memcpy(&out, pull, sizeof out);
  return out;
}

/// What a pass works on.
struct BodyPass {
  World& world;
  BodyState* states;            ///< of the world
  Lanes* late_spins;            ///< by slot; null without rolling, as the moments
  SphereSum* sums;              ///< of slots from `begin` on
  Lanes* moments;               ///< the same
  const std::uint8_t* plain;    ///< by four bodies: all free and of equal moments
  const std::uint8_t* touched;  ///< by slot: forces of the world come on top; null: nowhere
  const float* hurry;           ///< by slot: 1/half the margin of the list [1/m]; null: nobody asks for ways
  bool tells_forces;            ///< others ask for the forces of every step
  Scheme& scheme;               ///< for the others
  double dt, lag;               ///< lag: of the predicted velocity [s]
  std::size_t begin, end;       ///< slots, begin a multiple of four
  bool bounded;                 ///< somebody asks where the bodies of the next step are
  Extent& extent;               ///< of the bodies seen

  /// f(s) for all plain bodies, others(from, to) for the rest.
  template <class F, class G>
  EPAFI_LANES void each(const F& f, const G& others) const {
    std::size_t s = begin;
    for (; s + 4 <= end; s += 4)
      if (plain[s / 4])
        for (std::size_t k = s; k < s + 4; ++k) f(k);
      else
        others(s, s + 4);
    if (s < end) others(s, end);
  }
  /// Of bodies that are not plain; most_hurry: as that of Onward.
  void begin_others(std::size_t from, std::size_t to, Extent& seen, Vec3& most_hurry) const;
  void finish_others(std::size_t from, std::size_t to) const;
};

/// What a pass sees of plain bodies on its way, one body a register.
template <int n>
struct Passing {
  RowOf<n> low = splat<n>(Extent::none), high = splat<n>(-Extent::none), finite = splat<n>(0.0), hurry = splat<n>(0.0);

  /// x*0 is 0 for every finite number and NaN for all others: their sum says of all at once.
  EPAFI_LANES void see_finite(const RowOf<n>& x) { finite = finite + splat<n>(0.0) * x; }
  EPAFI_LANES void see_place(const RowOf<n>& x) { low = least(low, x), high = most(high, x); }
  EPAFI_LANES void see_way(double hurry_of_body, const RowOf<n>& v) {
    const RowOf<n> way = splat<n>(hurry_of_body) * v;
    hurry = most(hurry, way * way);
  }
  /// bounded: places were seen; else the bodies may be anywhere.
  EPAFI_LANES void tell(bool bounded, Extent& extent, Vec3& most_hurry) const {
    Lanes lows, highs, squares;
    store<n>(lows, low), store<n>(highs, high), store<n>(squares, hurry);
    extent.finite = extent.finite && is_zero(finite);
    for (int k = 0; k < 3; ++k) {
      extent.low[k] = std::min(extent.low[k], bounded ? lows[k] : -Extent::none);
      extent.high[k] = std::max(extent.high[k], bounded ? highs[k] : Extent::none);
      most_hurry[k] = std::max(most_hurry[k], squares[k]);
    }
  }
};

/// Half a kick and the drift, by the forces of the world, and what the loop over contacts reads of the bodies.
struct FirstHalf : BodyPass {
  Vec3& most_hurry;  ///< largest squares of velocity times hurry, by axis [1/s^2]

  template <int n>
  EPAFI_LANES void run() const {
    Passing<n> p;
    const RowOf<n> gravity = load<n>(world.gravity.data());
    each([&](std::size_t s) EPAFI_INLINED { one<n>(s, gravity, p); },
         [&](std::size_t from, std::size_t to) { begin_others(from, to, extent, most_hurry); });
    p.tell(true, extent, most_hurry);
  }

 private:
  template <int n>
  EPAFI_LANES void one(std::size_t s, const RowOf<n>& gravity, Passing<n>& p) const {
    BodyState& state = states[s];
    const RowOf<n> half_dt = splat<n>(0.5 * dt);
    const RowOf<n> a = gravity + splat<n>(state.velocity[3]) * load<n>(world.force[s].data());
    const RowOf<n> v = row<n>(state.velocity) + half_dt * a;
    const RowOf<n> x = row<n>(state.position) + without_fourth(splat<n>(dt)) * v;
    if (world.rotates()) {
      const RowOf<n> torque = load<n>(world.torque[s].data());
      const RowOf<n> inverse_inertia = splat<n>(state.predicted[3]);
      const RowOf<n> w = row<n>(state.spin) + inverse_inertia * (half_dt * torque);
      store<n>(state.spin, w);
      if (late_spins != nullptr) store<n>(late_spins[s], w + inverse_inertia * (splat<n>(lag) * torque));
    }
    store<n>(state.position, x), store<n>(state.velocity, v);
    const RowOf<n> later = lag == 0.0 ? v : v + splat<n>(lag) * a;
    store<n>(state.predicted, with_fourth(later, row<n>(state.predicted)));
    p.see_place(x), p.see_finite(x);
    if (hurry != nullptr) p.see_way(hurry[s], v);
  }
};

/// What the first half of the next step leaves of the bodies.
struct Onward {
  Extent& extent;
  Vec3& most_hurry;  ///< largest squares of velocity times hurry, by axis [1/s^2]
};

/// What the loop over contacts has found, its sums at zero then, and half a kick; with `onward` the first half of the
/// next step follows at once, and the forces go to the world only where others ask.
template <bool onward>
struct SecondHalf : BodyPass {
  Onward next;
  const BodyState* soon;  ///< bodies whose turn is next, the thread's own: a line asked for to be written leaves the
                          ///< core that has it (filling hopper, two threads, contacts 8.8 for 7.6 ns)

  template <int n>
  EPAFI_LANES void run() const {
    if constexpr (onward)
      if (world.rotates() && moments == nullptr && touched == nullptr && !tells_forces && !bounded && hurry != nullptr)
        return pass<n, true>();
    pass<n, false>();
  }

 private:
  /// alone: the bodies turn, nobody else pushes them or asks for forces, and nobody asks where they are.
  template <int n, bool alone>
  EPAFI_LANES void pass() const {
    Passing<n> p;
    const Kept<n> kept{states,
                       sums,
                       moments,
                       touched,
                       hurry,
                       begin,
                       soon,
                       load<n>(world.gravity.data()),
                       splat<n>(dt),
                       splat<n>(0.5 * dt),
                       splat<n>(lag),
                       splat<n>(0.0),
                       world.rotates(),
                       !onward || tells_forces};
    each([&](std::size_t s) EPAFI_INLINED { one<n, alone>(s, kept, p); },
         [&](std::size_t from, std::size_t to) {
           finish_others(from, to);
           if constexpr (onward) begin_others(from, to, next.extent, next.most_hurry);
         });
    extent.finite = extent.finite && is_zero(p.finite);
    if constexpr (onward) p.tell(!alone, next.extent, next.most_hurry);  // a position says it of its velocity too
  }

  /// What all bodies share, in registers: as members, which a store to a body might change, they would be read again
  /// for each (AVX2: 43.2 for 43.9 ns a sphere and step).
  template <int n>
  struct Kept {
    BodyState* states;
    SphereSum* sums;
    Lanes* moments;
    const std::uint8_t* touched;
    const float* hurry;
    std::size_t begin;
    const BodyState* soon;
    RowOf<n> gravity, dt, half_dt, lag, none;
    bool rotates, tells_forces;
  };

  template <int n, bool alone>
  EPAFI_LANES void one(std::size_t s, const Kept<n>& kept, Passing<n>& p) const {
    BodyState& state = kept.states[s];
    SphereSum& sum = kept.sums[s - kept.begin];
    const double radius = state.position[3], inverse_mass = state.velocity[3];
    RowOf<n> force = force_of<n>(sum), torque = splat<n>(radius) * pull_of<n>(sum);
    const bool more = !alone && kept.touched != nullptr && kept.touched[s] != 0;
    const bool rolls = !alone && kept.moments != nullptr, rotates = alone || kept.rotates;
    if (more) force = load<n>(world.force[s].data()) + force;
    const RowOf<n> a = kept.gravity + splat<n>(inverse_mass) * force, kick = kept.half_dt * a;
    RowOf<n> v = row<n>(state.velocity) + kick, w = row<n>(state.spin);
    if (rotates) {
      if (rolls) torque = torque + row<n>(kept.moments[s - kept.begin]);
      if (more) torque = load<n>(world.torque[s].data()) + torque;
      const RowOf<n> change = splat<n>(state.predicted[3]) * (kept.half_dt * torque);
      w = w + change;
      if constexpr (onward) w = w + change;
      store<n>(state.spin, w);
      if (rolls) {
        kept.moments[s - kept.begin] = Lanes{};
        if constexpr (onward) store<n>(late_spins[s], w + splat<n>(state.predicted[3]) * (kept.lag * torque));
      }
    }
    if constexpr (onward) {
      const BodyState& soon = kept.soon[s - kept.begin];  // into the second cache
      __builtin_prefetch(&soon, 1, 2), __builtin_prefetch(&soon.spin, 1, 2);
      v = v + kick;
      const RowOf<n> x = row<n>(state.position) + without_fourth(kept.dt) * v;
      store<n>(state.position, x);
      const RowOf<n> later = v + kept.lag * a;
      store<n>(state.predicted, with_fourth(later, row<n>(state.predicted)));
      if constexpr (!alone) p.see_place(x);
      p.see_finite(x + w);
      if (alone || kept.hurry != nullptr) p.see_way(kept.hurry[s], v);
    } else {
      p.see_finite(v + w);
    }
    store<n>(state.velocity, v);
    store<n>(sum.first, kept.none), std::memset(&sum.second, 0, 2 * sizeof(double));
    if (alone || !kept.tells_forces) return;
    write<n>(world.force[s].data(), force);
    if (rotates) write<n>(world.torque[s].data(), torque);
  }
};

}  // namespace epafi
