#include <array>

#include "engine/lanes/targets.h"
#include "laws/smooth/passes/tile_passes.h"
#include "laws/smooth/smooth_contact.h"

namespace epafi {

namespace {

/// What the contacts of a tile remember of a part of the law: so many numbers each, from `begin` on in their records.
struct TileMemory {
  std::size_t begin = 0, numbers = 0;
  std::vector<TileSpring> before{}, now{};  ///< numbers, one contact behind the other

  void fit(std::size_t first, std::size_t of_contact) {
    begin = first;
    numbers = of_contact;
    before.resize(ContactTile<2>::most * numbers * sizeof(double) / sizeof(TileSpring));
    now.resize(before.size());
  }
  static double* of(std::vector<TileSpring>& column) { return reinterpret_cast<double*>(column.data()); }
  EPAFI_LANES void copy(const double* from, double* to) const {
    if (numbers * sizeof(double) == sizeof(TileSpring))
      std::memcpy(to, from, sizeof(TileSpring));
    else
      std::copy_n(from, numbers, to);
  }
};
/// Of the normal law, friction, rolling and the force of the dashpot.
using TileMemories = std::array<TileMemory, 4>;

/// Power that fixed and driven bodies put into contact i: minus the force on them times the velocity there.
[[gnu::noinline]] double driven_power(const SmoothCall& call, std::size_t i) {
  const World& world = call.world;
  const ContactSet& contacts = call.contacts;
  const auto power = [&](Slot s, double sign, const auto& arm) {
    if (world.is_movable(s)) return 0.0;
    Vec3 velocity = world.velocity[s];
    double moment_power = 0.0;
    if (world.rotates() && !world.angular_velocity[s].isZero(0.0)) velocity += world.angular_velocity[s].cross(arm());
    if (call.law.rolls) moment_power = contacts.moment[i].dot(world.angular_velocity[s]);
    return -sign * (contacts.force[i].dot(velocity) + moment_power);
  };
  return power(contacts.a[i], 1.0, [&] { return contacts.arm[i]; }) +
         power(contacts.b[i], -1.0, [&] { return contacts.arm_b(i, world); });
}

template <int n>
class TileLoop {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  using Group = typename ContactTile<n>::Group;

 public:
  EPAFI_LANES TileLoop(const SmoothCall& of, TileMemories& of_parts)
      : call(of), world(of.world), contacts(of.contacts), law(of.law), memories(of_parts) {}

  EPAFI_LANES void run() {
    for (std::size_t i = call.begin; i < call.end || t.count > 0; evaluate())  // once in the code: it is large
      while (i < call.end && t.count < t.most) take(i++);
    SmoothSums& sums = call.sums;
    sums.touching = total.touching;
    sums.elastic = total.elastic.total();
    sums.spring_energy = 0.5 * total.twice_stored.total();
    sums.spring_energy_before = 0.5 * twice_before.total();
    sums.slipped = 0.5 * total.twice_slipped.total();
    sums.viscous_power = total.viscous.total();
    sums.late = total.late.total();
    sums.driven_power = driven;
    sums.lost = total.lost.total();
  }

 private:
  /// Adds contact i to the tile if it touches.
  EPAFI_LANES void take(std::size_t i) {
    const Slot a = contacts.a[i], b = contacts.b[i];
    const bool touches = contacts.gap[i] < 0.0 || (law.holds && law.holds(call.memory.before(i)));
    if (!touches || world.inverse_mass[a] + world.inverse_mass[b] == 0.0) {
      contacts.force[i].setZero();
      if (law.rolls) contacts.moment[i].setZero();
      if (law.remembers()) call.memory.forget(i);
      return;
    }
    const std::size_t k = t.count++;
    t.x[k] = contacts.normal[i].x();
    t.y[k] = contacts.normal[i].y();
    t.z[k] = contacts.normal[i].z();
    t.overlap[k] = -contacts.gap[i];
    t.row[k] = world.material[a] * law.materials + world.material[b];
    slot_a[k] = a;
    slot_b[k] = b;
    at[k] = i;
  }

  EPAFI_LANES void evaluate() {
    if (t.count == 0) return;
    t.groups = (t.count + n - 1) / n;
    for (std::size_t k = t.count; k < t.groups * n; ++k) {
      t.copy(t.count - 1, k);
      t.row[k] = t.row[t.count - 1];
      slot_a[k] = slot_a[t.count - 1];
      slot_b[k] = slot_b[t.count - 1];
      at[k] = at[t.count - 1];
    }
    for (std::size_t g = 0; g < t.groups; ++g) find_motion(g);
    recall();
    const Passes& passes = call.passes;
    const PassCall of{&t, &passes, law.rows.data(), law.materials == 1, call.dt};
    auto& [normal, friction, rolling, push] = memories;
    double* const pushes = law.needs.push ? TileMemory::of(push.now) : nullptr;
    passes.normal({of, TileMemory::of(normal.before), TileMemory::of(normal.now), TileMemory::of(push.before), pushes,
                   call.lag, true, call.ratio});
    if (passes.tangential) passes.tangential({of, friction.before.data(), friction.now.data()});
    if (passes.rolling) passes.rolling({of, rolling.before.data(), rolling.now.data(), call.lag, &r});
    remember();
    for (std::size_t g = 0; g < t.groups; ++g) write_loads(g);
    add_up_all();
    t.count = 0;
  }

  template <class F>
  EPAFI_LANES static V3 columns(const F& row_of) {
    V3 out;
    V none;
    read_columns(row_of, out.x, out.y, out.z, none);
    return out;
  }
  /// Of the bodies.
  template <class Column>
  EPAFI_LANES static V3 of(const Column& column, const Slot* slots) {
    return columns([&](int l) EPAFI_INLINED { return load<n>(column[slots[l]].data()); });
  }
  /// Of B less that of A.
  template <class Column>
  EPAFI_LANES static V3 apart(const Column& column, const Slot* a, const Slot* b) {
    return columns([&](int l) EPAFI_INLINED { return load<n>(column[b[l]].data()) - load<n>(column[a[l]].data()); });
  }

  EPAFI_LANES V3 branch(const Slot* a, const Slot* b, const std::size_t* contact) const {
    if (!world.cell) return apart(world.position, a, b);
    V3 out;
#pragma GCC unroll 1
    for (int l = 0; l < n; ++l) {
      const Vec3 to_b = world.branch(a[l], b[l], contacts.feature[contact[l]]);
      out.x[l] = to_b.x();
      out.y[l] = to_b.y();
      out.z[l] = to_b.z();
    }
    return out;
  }

  /// Relative velocity at the contacts: slip in the middle of the step, approach at the end.
  EPAFI_LANES void find_motion(std::size_t g) {
    Group& c = t.group[g];
    const Slot *const a = slot_a + g * n, *const b = slot_b + g * n;
    const std::size_t* const contact = at + g * n;
    const V3 normal = t.normal(g);
    V3 velocity = apart(world.velocity, a, b), change{}, arm_a{}, arm_b{}, spin_a{}, spin_b{};
    if (call.lag > 0.0) change = apart(call.change.linear, a, b);
    if (world.cell || world.rotates()) {
      const V3 to_b = branch(a, b, contact);
      if (world.cell) {
        const Vec3& rate = world.cell->strain_rate;
        velocity = velocity + V3{rate.x() * to_b.x, rate.y() * to_b.y, rate.z() * to_b.z};
      }
      if (world.rotates()) {
        arm_a = columns([&](int l) EPAFI_INLINED { return load<n>(contacts.arm[contact[l]].data()); });
        arm_b = arm_a - to_b;
        spin_a = of(world.angular_velocity, a);
        spin_b = of(world.angular_velocity, b);
        velocity = velocity + (spin_b.cross(arm_b) - spin_a.cross(arm_a));
        if (call.lag > 0.0)
          change = change + (of(call.change.angular, b).cross(arm_b) - of(call.change.angular, a).cross(arm_a));
      }
    }
    const V opening = velocity.dot(normal);
    c.slip = velocity - opening * normal;
    c.middle = -opening;
    c.approach = call.lag > 0.0 ? -opening - change.dot(normal) : -opening;
    c.twist = 0.5 * call.dt * normal.dot(spin_a + spin_b);
    for (int l = 0; l < n; ++l) {
      c.inverse_mass[l] = world.inverse_mass[a[l]] + world.inverse_mass[b[l]];
      c.radius[l] = law.contact.curvature ? contacts.effective_radius[contact[l]] : no_radius;
      if (law.contact.area) c.area[l] = contacts.area[contact[l]];
    }
    if (!law.needs.damps_slip()) return;
    const Side of_a = side(a, arm_a), of_b = side(b, arm_b);
    r.slip[g] = in_plane(c.slip + change, normal);
    r.slip_mobility[g] = of_a.slip_mobility + of_b.slip_mobility;
    if (!law.rolls) return;
    r.turning[g] = r.spin[g] = in_plane(spin_b - spin_a, normal);
    if (call.lag > 0.0) r.spin[g] = r.spin[g] + in_plane(apart(call.change.angular, a, b), normal);
    r.inertia[g] = 1.0 / (of_a.rolling_mobility + of_b.rolling_mobility);
    r.inverse_inertia[g] = of_a.inverse_inertia + of_b.inverse_inertia;
  }

  /// With I the harmonic mean of the moments of a body; all 0 where it is not free.
  struct Side {
    V inverse_inertia;   ///< 1/I
    V slip_mobility;     ///< 1/m + r^2/I of a body pushed sideways at its contact point
    V rolling_mobility;  ///< 1/(I + m r^2) of one that rolls about it
  };
  EPAFI_LANES Side side(const Slot* bodies, const V3& arm) const {
    V inverse_mass{}, inverse_inertia{};
#pragma GCC unroll 1
    for (int l = 0; l < n; ++l) {
      inverse_mass[l] = world.inverse_mass[bodies[l]];
      inverse_inertia[l] = world.is_movable(bodies[l]) ? world.inverse_inertia_of(bodies[l]).sum() / 3.0 : 0.0;
    }
    const V slip = inverse_mass + arm.dot(arm) * inverse_inertia;
    return {inverse_inertia, slip, inverse_inertia * inverse_mass / at_least<n>(slip, 1e-300)};
  }

  /// From the records of the contacts. No time passes: contacts that begin have springs without load.
  EPAFI_LANES void recall() {
    for (TileMemory& part : memories) {
      for (std::size_t k = 0; k < t.groups * n && part.numbers > 0; ++k)
        part.copy(call.memory.before(at[k]) + part.begin, TileMemory::of(part.before) + k * part.numbers);
      if (!(call.dt > 0.0)) std::fill(part.now.begin(), part.now.end(), TileSpring{{0.0, 0.0, 0.0, 1.0}});
    }
  }
  EPAFI_LANES void remember() {
    for (TileMemory& part : memories)
      for (std::size_t k = 0; k < t.count && part.numbers > 0; ++k)
        part.copy(TileMemory::of(part.now) + k * part.numbers, call.memory.now(at[k]) + part.begin);
  }

  EPAFI_LANES void write_loads(std::size_t g) {
    const Group& c = t.group[g];
    V3 force = -(c.force * t.normal(g));
    if (law.needs.friction) force = force + c.load;
    write_vectors(force, g, contacts.force);
    if (law.rolls) write_vectors(r.moment[g], g, contacts.moment);
  }
  EPAFI_LANES void write_vectors(const V3& x, std::size_t g, std::vector<Vec3>& to) const {
    RowOf<n> rows[n];
    write_rows(x.x, x.y, x.z, V{}, rows);
    // not of lanes behind the last contact: evaluated contact by contact, they have no friction
    for (std::size_t l = 0; l < n && g * n + l < t.count; ++l) write<n>(to[at[g * n + l]].data(), rows[l]);
  }

  EPAFI_LANES void add_up_all() {
    for (std::size_t k = 0; k < t.count; ++k) {
      const bool counts = world.counts(slot_a[k], slot_b[k]);
      if (!counts) [[unlikely]] {
        t.leave_out(k);
        --total.touching;
      } else if (world.inverse_mass[slot_a[k]] * world.inverse_mass[slot_b[k]] == 0.0)
        driven += driven_power(call, at[k]);
    }
    if (!law.needs.friction) return total_up<n, false>(t, total, true, call.lag > 0.0, law.needs.normal);
    add_up<n>(t, twice_before, &Group::energy);
    total_up<n, true>(t, total, true, call.lag > 0.0, law.needs.normal);
  }

  static constexpr double no_radius = std::numeric_limits<double>::quiet_NaN();
  const SmoothCall& call;
  const World& world;
  ContactSet& contacts;
  const SmoothLaw& law;
  TileMemories& memories;
  ContactTile<n> t;
  TileRolling<n> r;
  std::size_t at[ContactTile<n>::room];
  Slot slot_a[ContactTile<n>::room], slot_b[ContactTile<n>::room];
  LaneTotals<n> total;
  LaneSum<n> twice_before;  ///< energy of the springs as they come into the step [J]
  double driven = 0.0;
};

struct TileTask {
  const SmoothCall& call;
  template <int n>
  EPAFI_LANES void run() const {
    thread_local TileMemories memories;
    const SmoothLaw& law = call.law;
    memories[0].fit(0, law.state);
    memories[1].fit(law.state, law.friction.memory);
    memories[2].fit(law.state + law.friction.memory, law.rolls ? sizeof(TileSpring) / sizeof(double) : 0);
    memories[3].fit(memories[2].begin + memories[2].numbers, law.needs.push);
    TileLoop<n>(call, memories).run();
  }
};

}  // namespace

void (*contact_tiles())(const SmoothCall&) { return best_loop<TileTask, SmoothCall>(); }

}  // namespace epafi
