#include "laws/smooth/fused/sphere_rolling.h"

#include <array>

#include "engine/lanes/targets.h"

namespace epafi {

namespace {

/// From the centre of a body to a contact of its ball, whose centre is at `offset` [m^2].
EPAFI_LANES double square_of_arm(const Vec3& offset, double arm, const std::array<double, 3>& normal) {
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double x = offset[k] + arm * normal[static_cast<std::size_t>(k)];
    square += x * x;
  }
  return square;
}

/// Motion and mobility of one side of n contacts.
template <int n>
struct SphereSide {
  using V = typename LanesOf<n>::Real;
  VectorsOf<V> late_spin{};
  V inverse_inertia{}, slip_mobility{}, rolling_mobility{};

  /// place(lane): of the sphere; normal: from it to the other one.
  template <class Place>
  EPAFI_LANES void read(const SphereArrays& with, const Place& place, const V& radius, const V& lever,
                        const VectorsOf<V>& normal) {
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.late_spin(place(l))); }, late_spin.x, late_spin.y,
                 late_spin.z, inverse_inertia);
    V inverse_mass{};
    for (int l = 0; l < n; ++l) inverse_mass[l] = with.state(place(l)).velocity[3];
    const V arm = radius * lever;
    V square = arm * arm;
    if (with.offsets != nullptr) [[unlikely]]
      for (int l = 0; l < n; ++l)
        if (place(l).slot() < with.balls)
          square[l] = square_of_arm(with.offsets[place(l).slot()], arm[l], {normal.x[l], normal.y[l], normal.z[l]});
    const V turning = square * inverse_inertia;
    slip_mobility = inverse_mass + turning;
    rolling_mobility = inverse_inertia * inverse_mass / at_least<n>(slip_mobility, 1e-300);  // of a held ball 0
  }
};

template <int n>
EPAFI_LANES void find_rolling(const SphereTile<n>& t, TileRolling<n>& r, std::size_t g, const SphereRollingCall& call) {
  const SphereArrays& with = call.arrays;
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  const typename SphereTile<n>::Group& c = t.group[g];
  const VectorsOf<V> normal = t.normal(g);
  SphereSide<n> a, b;
  a.read(
      with, [&](int l) EPAFI_INLINED { return bodies[l].a; }, c.radius_a, c.lever, normal);
  if (!call.wall)
    b.read(
        with, [&](int l) EPAFI_INLINED { return bodies[l].b; }, c.radius_b, c.lever, -normal);
  if (call.passes->needs.dashpots) {
    const VectorsOf<V> turning = c.lever * (c.radius_a * a.late_spin + c.radius_b * b.late_spin);
    r.slip[g] = in_plane(-c.nearer, normal) - turning.cross(normal);
    r.slip_mobility[g] = a.slip_mobility + b.slip_mobility;
  }
  if (!call.passes->needs.rolling) return;
  r.spin[g] = in_plane(b.late_spin - a.late_spin, normal);
  r.turning[g] = in_plane(c.turning, normal);
  r.inertia[g] = 1.0 / (a.rolling_mobility + b.rolling_mobility);
  r.inverse_inertia[g] = a.inverse_inertia + b.inverse_inertia;
}

/// Adds the moments to the sums as add_forces does the forces; of B to records where it lies in another block.
template <int n>
EPAFI_LANES void add_moments(const SphereTile<n>& t, const TileRolling<n>& r, std::size_t g,
                             const SphereRollingCall& call) {
  const SphereArrays& with = call.arrays;
  SphereBlocks::Block& block = call.block;
  const SphereSprings::Places at = call.at;
  using V = typename LanesOf<n>::Real;
  const VectorsOf<V>& moment = r.moment[g];
  RowOf<n> rows[n];
  write_rows(moment.x, moment.y, moment.z, V{}, rows);
  const SpherePlaces* bodies = t.bodies + g * n;
  for (std::size_t l = 0; l < n && g * n + l < t.count; ++l) {
    Lanes& a = with.moment(bodies[l].a);
    store<n>(a, row<n>(a) + rows[l]);
    if (call.across) store<n>(block.record_moments[at.record + g * n + l], -rows[l]);
    if (call.wall || call.across) continue;
    Lanes& b = with.moment(bodies[l].b);
    store<n>(b, row<n>(b) - rows[l]);
  }
}

/// Stores the loads of the contacts of a tile for observers.
template <int n>
[[gnu::noinline]] void tell_loads(const SphereTile<n>& t, const TileRolling<n>& r, const SphereRollingCall& call) {
  SphereLoads* const loads = call.block.springs.loads();
  for (std::size_t k = 0; k < t.count; ++k) {
    const auto row_of = [at = k / n, l = k % n](const auto* x) {
      return Lanes{x[at].x[l], x[at].y[l], x[at].z[l], 0.0};
    };
    SphereLoads& now = loads[call.dt > 0.0 ? call.at.write + k : t.spring[k]];
    now.friction = row_of(r.friction);
    now.moment = call.passes->needs.rolling ? row_of(r.moment) : Lanes{};
  }
}

struct SphereRollingPass {
  const SphereRollingCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    auto& t = static_cast<SphereTile<n>&>(*static_cast<ContactTile<n>*>(call.tile));
    TileRolling<n> r;
    for (std::size_t g = 0; g < t.groups; ++g) find_rolling<n>(t, r, g, call);
    RollingCall of_law = call;
    of_law.motion = &r;
    call.passes->rolling(of_law);
    if (call.passes->needs.rolling)
      for (std::size_t g = 0; g < t.groups; ++g) add_moments<n>(t, r, g, call);
    if (call.arrays.tells_loads()) tell_loads<n>(t, r, call);
  }
};

}  // namespace

void (*sphere_rolling())(const SphereRollingCall&) { return best_loop<SphereRollingPass, SphereRollingCall>(); }

}  // namespace epafi
