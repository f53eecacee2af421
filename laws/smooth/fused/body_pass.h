/// @file body_pass.h  The two passes over bodies of a kick-drift-kick step, with what the loop over contacts reads and
/// writes: four spheres at a time. Bodies that are not plain (held, or with unequal moments) are left to the caller.
/// The same operations in the same order as engine/schemes/velocity_verlet.h and engine/world.h: the same bits.
#pragma once
#include "engine/domain.h"
#include "engine/pipeline.h"
#include "laws/smooth/fused/sphere_blocks.h"
#include "laws/smooth/fused/sphere_lanes.h"

namespace epafi {

/// Twelve numbers: a vector of each of four bodies as they lie in a column, x y z x | y z x y | z x y z.
struct FourVectors {
  Lanes a, b, c;
  EPAFI_LANES static FourVectors load(const Vec3* column) {
    FourVectors v;
    const char* from = reinterpret_cast<const char*>(column);
    __builtin_memcpy(&v.a, from, 32), __builtin_memcpy(&v.b, from + 32, 32), __builtin_memcpy(&v.c, from + 64, 32);
    return v;
  }
  EPAFI_LANES void store(Vec3* column) const {
    char* to = reinterpret_cast<char*>(column);
    __builtin_memcpy(to, &a, 32), __builtin_memcpy(to + 32, &b, 32), __builtin_memcpy(to + 64, &c, 32);
  }
  /// One number of each of four bodies, for all of its components.
  EPAFI_LANES static FourVectors of_scalars(Lanes s) {
    return {__builtin_shufflevector(s, s, 0, 0, 0, 1), __builtin_shufflevector(s, s, 1, 1, 2, 2),
            __builtin_shufflevector(s, s, 2, 3, 3, 3)};
  }
  /// The same vector four times.
  EPAFI_LANES static FourVectors of_vector(const Vec3& v) {
    const double x = v.x(), y = v.y(), z = v.z();
    return {Lanes{x, y, z, x}, Lanes{y, z, x, y}, Lanes{z, x, y, z}};
  }
  /// Writes x y z of every body into rows `stride` lanes apart; the fourth numbers there stay.
  EPAFI_LANES void write_rows(Lanes* rows, std::size_t stride) const {
    const auto put = [](Lanes& to, Lanes x) EPAFI_INLINED { to = __builtin_shufflevector(x, to, 0, 1, 2, 7); };
    put(rows[0], a);
    put(rows[stride], __builtin_shufflevector(a, b, 3, 4, 5, 5));
    put(rows[2 * stride], __builtin_shufflevector(b, c, 2, 3, 4, 4));
    put(rows[3 * stride], __builtin_shufflevector(c, c, 1, 2, 3, 3));
  }
  EPAFI_LANES FourVectors operator+(const FourVectors& o) const { return {a + o.a, b + o.b, c + o.c}; }
  EPAFI_LANES FourVectors operator*(const FourVectors& o) const { return {a * o.a, b * o.b, c * o.c}; }
};
EPAFI_LANES FourVectors operator*(double s, const FourVectors& v) { return {s * v.a, s * v.b, s * v.c}; }

/// Writes what the loop over contacts reads of the bodies of slots [begin, end), with velocities `lag` later;
/// late_spins: null where nobody reads them.
void pack_bodies(const World& world, double lag, SphereState* states, Lanes* late_spins, std::size_t begin,
                 std::size_t end);
/// Writes force and torque of slots [begin, end), added where `touched` says so; the sums and moments (or null), of
/// slots from `begin` on, are 0 again then.
void unpack_bodies(World& world, const SphereState* states, SphereSum* sums, Lanes* moments,
                   const std::uint8_t* touched, std::size_t begin, std::size_t end);
/// Positions and velocities back into the world.
void show_motion(World& world, const SphereState* states, std::size_t begin, std::size_t end);
/// The columns of the world allow the passes over four bodies.
bool has_plain_bodies(const World& world);
/// The four bodies from slot `begin` on are all free and of equal moments.
bool are_plain(const World& world, std::size_t begin);

/// What a pass works on.
struct BodyPass {
  World& world;
  SphereState* states;
  Lanes* late_spins;            ///< by slot; null without rolling, as the moments
  SphereSum* sums;              ///< of slots from `begin` on
  Lanes* moments;               ///< the same
  const std::uint8_t* plain;    ///< by four bodies: all free and of equal moments
  const std::uint8_t* touched;  ///< by slot: forces of the world come on top; null: nowhere
  const double* hurry;          ///< by slot: 1/half the margin of the list [1/m]
  const std::uint8_t* watched;  ///< by slot: others look at the body in the world; null: nobody does
  Scheme& scheme;               ///< for the others
  double dt, lag;               ///< lag: of the predicted velocity [s]
  std::size_t begin, end;       ///< slots, begin a multiple of four
  bool bounded;                 ///< somebody asks where the bodies of the next step are
  Extent& extent;               ///< of the bodies seen

  /// f(s) for all plain fours, others(from, to) for the rest.
  template <class F, class G>
  EPAFI_LANES void each(const F& f, const G& others) const {
    std::size_t s = begin;
    for (; s + 4 <= end; s += 4)
      if (plain[s / 4])
        f(s);
      else
        others(s, s + 4);
    if (s < end) others(s, end);
  }
  /// Of bodies that are not plain.
  void begin_others(std::size_t from, std::size_t to, Extent& seen) const;
  void finish_others(std::size_t from, std::size_t to) const;
  void measure_others(std::size_t from, std::size_t to, Vec3& most) const;
};

/// x*0 is 0 for every finite number and NaN for all others: their sum says of all at once.
EPAFI_LANES void see_finite(Lanes& sum, const FourVectors& v) { sum += 0.0 * (v.a + v.b + v.c); }
EPAFI_LANES bool all_finite(Lanes sum) { return (sum[0] + sum[1]) + (sum[2] + sum[3]) == 0.0; }

EPAFI_LANES void kick(FourVectors& velocity, const FourVectors& acceleration, double dt) {
  velocity = velocity + dt * acceleration;
}
EPAFI_LANES void spin_up(const World& world, std::size_t s, double dt, FourVectors& spin, const FourVectors& torque) {
  spin = spin + FourVectors::load(world.inverse_inertia.data() + s) * (dt * torque);
}
EPAFI_LANES FourVectors acceleration(const BodyPass& p, std::size_t s, const FourVectors& gravity,
                                     const FourVectors& force) {
  Lanes inverse_mass;
  __builtin_memcpy(&inverse_mass, p.world.inverse_mass.data() + s, sizeof inverse_mass);
  return gravity + FourVectors::of_scalars(inverse_mass) * force;
}

/// Half a kick and the drift, and what the loop over contacts reads of the bodies.
struct FirstHalf : BodyPass {
  Vec3* most_hurry;  ///< as that of SecondHalf; null: nobody asks

  template <int n>
  EPAFI_LANES void run() const {
    const auto others = [&](std::size_t from, std::size_t to) {
      begin_others(from, to, extent);
      if (most_hurry != nullptr) measure_others(from, to, *most_hurry);
    };
    if constexpr (n == 2) {  // shuffles of four cost more than they save: two loops over what the first cache holds
      for (std::size_t s = begin; s < end; s += 64) others(s, std::min(end, s + 64));
      return;
    }
    const FourVectors gravity = FourVectors::of_vector(world.gravity);
    Passing p{{lanes(Extent::none), lanes(Extent::none), lanes(Extent::none)},
              {lanes(-Extent::none), lanes(-Extent::none), lanes(-Extent::none)},
              {},
              Lanes{}};
    each([&](std::size_t s) EPAFI_INLINED { four(s, gravity, p); }, others);
    const auto join = [](const FourVectors& v, double* most, const auto& choose) EPAFI_INLINED {
      const Lanes rows[] = {v.a, v.b, v.c};
      for (int k = 0; k < 12; ++k) most[k % 3] = choose(most[k % 3], rows[k / 4][k % 4]);
    };
    const auto larger = [](double a, double b) { return std::max(a, b); };
    join(p.low, extent.low.data(), [](double a, double b) { return std::min(a, b); });
    join(p.high, extent.high.data(), larger);
    if (most_hurry != nullptr) join(p.hurry, most_hurry->data(), larger);
    extent.finite = extent.finite && all_finite(p.finite);
  }

 private:
  struct Passing {
    FourVectors low, high, hurry;
    Lanes finite;
  };
  EPAFI_LANES static void raise(FourVectors& most, const FourVectors& v) {
    most = {max(most.a, v.a), max(most.b, v.b), max(most.c, v.c)};
  }

  EPAFI_LANES void four(std::size_t s, const FourVectors& gravity, Passing& p) const {
    Lanes* rows = &states[s].position;
    constexpr std::size_t stride = sizeof(SphereState) / sizeof(Lanes);
    const FourVectors a = acceleration(*this, s, gravity, FourVectors::load(world.force.data() + s));
    FourVectors v = FourVectors::load(world.velocity.data() + s), x = FourVectors::load(world.position.data() + s);
    kick(v, a, 0.5 * dt);
    x = x + dt * v;
    v.store(world.velocity.data() + s), x.store(world.position.data() + s);
    x.write_rows(rows, stride), v.write_rows(rows + 1, stride);
    (lag == 0.0 ? v : v + lag * a).write_rows(rows + 3, stride);
    p.low = {min(p.low.a, x.a), min(p.low.b, x.b), min(p.low.c, x.c)};
    raise(p.high, x);
    see_finite(p.finite, x);
    if (most_hurry != nullptr) {
      Lanes each_hurry;
      __builtin_memcpy(&each_hurry, hurry + s, sizeof each_hurry);
      const FourVectors way = FourVectors::of_scalars(each_hurry) * v;
      raise(p.hurry, way * way);
    }
    if (!world.rotates()) return;
    FourVectors w = FourVectors::load(world.angular_velocity.data() + s);
    const FourVectors torque = FourVectors::load(world.torque.data() + s);
    spin_up(world, s, 0.5 * dt, w, torque);
    w.store(world.angular_velocity.data() + s), w.write_rows(rows + 2, stride);
    if (late_spins == nullptr) return;
    spin_up(world, s, lag, w, torque);
    w.write_rows(late_spins + s, 1);
  }
};

/// What the loop over contacts has found, its sums at zero then, and half a kick. With `onward` the first half of the
/// next step follows at once, and bodies and forces go to the world only with `shown`; without it the ways are
/// measured, and the world is told of those that others watch, with all forces: who is watched changes with the list,
/// and the next step predicts from them. One body a register, as they lie in `states`, which count: those of the world
/// may be of long ago.
template <bool onward, bool shown>
struct SecondHalf : BodyPass {
  Extent& next;      ///< of the bodies as the first half of the next step leaves them
  Vec3& most_hurry;  ///< largest squares of velocity times hurry, by axis [1/s^2]

  template <int n>
  EPAFI_LANES void run() const {
    if constexpr (onward && !shown)
      if (world.rotates() && moments == nullptr && touched == nullptr && watched == nullptr && !bounded)
        return pass<n, true>();
    pass<n, false>();
  }

 private:
  /// alone: the bodies turn, nobody else pushes or watches them, and nobody asks where they are.
  template <int n, bool alone>
  EPAFI_LANES void pass() const {
    const RowOf<n> none = splat<n>(Extent::none), zero = splat<n>(0.0);
    Passing<n> p{none, splat<n>(-Extent::none), zero, zero};
    const Kept<n> kept{states,         sums,
                       moments,        touched,
                       hurry,          watched,
                       begin,          load<n>(world.gravity.data()),
                       splat<n>(dt),   splat<n>(0.5 * dt),
                       splat<n>(lag),  zero,
                       world.rotates()};
    each(
        [&](std::size_t s) EPAFI_INLINED {
          for (std::size_t k = s; k < s + 4; ++k) one<n, alone>(k, kept, p);
        },
        [&](std::size_t from, std::size_t to) {
          finish_others(from, to);
          if constexpr (onward) begin_others(from, to, next);
          if constexpr (onward && !shown) measure_others(from, to, most_hurry);
        });
    extent.finite = extent.finite && is_zero(p.finite);
    if constexpr (!onward) return;
    next.finite = next.finite && is_zero(p.finite);  // a position says it of its velocity too
    Lanes low, high;
    epafi::store<n>(low, alone ? -none : p.low), epafi::store<n>(high, alone ? none : p.high);  // or anywhere
    for (int k = 0; k < 3; ++k)
      next.low[k] = std::min(next.low[k], low[k]), next.high[k] = std::max(next.high[k], high[k]);
    if constexpr (shown) return;
    epafi::store<n>(low, p.hurry);
    for (int k = 0; k < 3; ++k) most_hurry[k] = std::max(most_hurry[k], low[k]);
  }

  /// What all bodies share, in registers: as members, which a store to a body might change, they would be read again
  /// for each (AVX2: 43.2 for 43.9 ns a sphere and step).
  template <int n>
  struct Kept {
    SphereState* states;
    SphereSum* sums;
    Lanes* moments;
    const std::uint8_t* touched;
    const double* hurry;
    const std::uint8_t* watched;
    std::size_t begin;
    RowOf<n> gravity, dt, half_dt, lag, none;
    bool rotates;
  };
  template <int n>
  struct Passing {
    RowOf<n> low, high, finite, hurry;
  };

  template <int n, bool alone>
  EPAFI_LANES void one(std::size_t s, const Kept<n>& kept, Passing<n>& p) const {
    SphereState& state = kept.states[s];
    SphereSum& sum = kept.sums[s - kept.begin];
    const double radius = state.position[3], inverse_mass = state.velocity[3];
    RowOf<n> force = row<n>(sum.force), torque = splat<n>(radius) * row<n>(sum.pull);
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
      if constexpr (onward) w = w + change, epafi::store<n>(state.spin, w);
      if (rolls) {
        kept.moments[s - kept.begin] = Lanes{};
        if constexpr (onward) epafi::store<n>(late_spins[s], w + splat<n>(state.predicted[3]) * (kept.lag * torque));
      }
    }
    if constexpr (onward) {
      const SphereState& soon = (&state)[SphereBlocks::block_size];  // its turn is next: into the second cache
      __builtin_prefetch(&soon, 1, 2), __builtin_prefetch(&soon.spin, 1, 2);
      v = v + kick;
      const RowOf<n> x = row<n>(state.position) + without_fourth(kept.dt) * v;
      epafi::store<n>(state.position, x), epafi::store<n>(state.velocity, v);
      const RowOf<n> later = v + kept.lag * a;
      epafi::store<n>(state.predicted, with_fourth(later, row<n>(state.predicted)));
      if constexpr (!alone) p.low = least(p.low, x), p.high = most(p.high, x);
      p.finite = p.finite + splat<n>(0.0) * (x + w);
      if constexpr (!shown) {
        const RowOf<n> way = splat<n>(kept.hurry[s]) * v;
        p.hurry = most(p.hurry, way * way);
      }
    } else {
      p.finite = p.finite + splat<n>(0.0) * (v + w);
    }
    epafi::store<n>(sum.force, kept.none), epafi::store<n>(sum.pull, kept.none);
    if constexpr (alone) return;
    if (!onward || shown || kept.watched != nullptr) {
      write<n>(world.force[s].data(), force);
      if (rotates) write<n>(world.torque[s].data(), torque);
    }
    if (!onward || shown || (kept.watched != nullptr && kept.watched[s] != 0)) {
      write<n>(world.position[s].data(), row<n>(state.position)), write<n>(world.velocity[s].data(), v);
      if (rotates) write<n>(world.angular_velocity[s].data(), w);
    }
  }
};

}  // namespace epafi
