#include "laws/smooth/contact_links.h"

#include <algorithm>
#include <cmath>

#include "laws/smooth/choose_law.h"

namespace epafi {

namespace {

/// Largest gap of a contact of the law (adhesion) [m]; numbers: of the pair.
template <NormalLaw N>
double reach_of(const double* numbers, double radius) {
  const auto p = from_numbers<typename N::Parameters>(numbers);
  if constexpr (requires { N::reach(p, radius); }) return N::reach(p, radius);
  return 0.0;
}

/// A negative overlap is that of an adhesive contact beyond touch.
NormalSlopes slopes_of(const AskedLaw& law, ContactKinematics at) {
  constexpr double little = 1e-4;  // of the scale: digits enough for a slope, near enough for a power law
  const double overlap = at.overlap, size = std::abs(overlap);
  if (law.numbers.empty()) return {};  // bodies of these materials cannot touch
  double fresh = 0.0, loaded = 0.0, next = 0.0;
  at.approach_velocity = 0.0;
  if (overlap < 0.0) {  // it has touched before
    at.overlap = size;
    law.respond(at, fresh, loaded);
    fresh = loaded;
    at.overlap = overlap;
  }
  const NormalResponse still = law.respond(at, fresh, loaded);
  NormalSlopes out;
  out.of_law = still.stiffness;
  out.force = std::max(0.0, still.force);
  // adhesion acts at zero overlap: a smaller difference would be lost in rounding of the force
  const double by_force = std::abs(still.elastic_force) / std::max(still.stiffness, 1e-300);
  const double scale = overlap < 0.0 ? size : std::max(size, by_force);
  if (law.remembers) {
    at.overlap = overlap - scale * little;
    const NormalResponse less = law.respond(at, loaded, next);
    out.stiffness = std::max(0.0, still.elastic_force - less.elastic_force) / (scale * little);
    at.overlap = overlap;
  } else {
    out.stiffness = std::max(0.0, still.stiffness);
  }
  // so fast that a critical dashpot doubles the force: forces of all laws are linear in the velocity
  at.approach_velocity = scale * std::sqrt(std::max(still.stiffness, 1e-300) / at.effective_mass);
  const NormalResponse moving = law.respond(at, loaded, next);
  if (at.approach_velocity > 0.0) out.dashpot = std::max(0.0, moving.force - still.force) / at.approach_velocity;
  return out;
}

/// 1/m + r^2/I pushed sideways at a contact point, as the law takes it [1/kg]; 0 of a body that is not free.
double slip_mobility_of(const World& world, Slot s, const Vec3& arm) {
  if (!world.is_movable(s)) return 0.0;
  return world.inverse_mass[s] + (world.rotates() ? arm.squaredNorm() * world.inverse_inertia_of(s).sum() / 3.0 : 0.0);
}

/// 1/(I + m r^2) [1/(kg m^2)], as the law takes it.
double rolling_mobility_of(const World& world, Slot s, const Vec3& arm) {
  if (!world.is_movable(s) || !world.rotates()) return 0.0;
  return 1.0 / (3.0 / world.inverse_inertia_of(s).sum() + arm.squaredNorm() / world.inverse_mass[s]);
}

}  // namespace

ContactLinks::ContactLinks(const SmoothSetup& setup) : law_(smooth_law(setup)) {
  const std::string normal = smooth_parts(setup).normal;
  normal_.resize(law_.rows.size());
  each_pair(setup.materials, [&](std::size_t k, const MaterialPair& pair) { normal_[k] = asked_law(normal, pair); });
  with_law(NormalLaws{}, normal, [&](auto n) {
    using N = typename decltype(n)::type;
    reach_ = [](const double* numbers, double radius) { return reach_of<N>(numbers, radius); };
  });
}

NormalSlopes ContactLinks::normal(std::uint16_t i, std::uint16_t j, const ContactKinematics& at) const {
  return slopes_of(normal_[i * law_.materials + j], at);
}

StiffLink ContactLinks::link(std::uint16_t i, std::uint16_t j, const ContactKinematics& at, double slip_mobility,
                             double rolling_mobility, double dt) const {
  const std::size_t pair = i * law_.materials + j;
  const NormalSlopes n = slopes_of(normal_[pair], at);
  StiffLink out;
  out.along = damped_weight(n.stiffness, n.dashpot, 1.0 / at.effective_mass, dt);
  const PairRow& row = law_.rows[pair];
  const auto p = from_numbers<CoulombSpring::Parameters>(&row.tangential);
  const double sideways = p.friction > 0.0 ? CoulombSpring::stiffness(p, n.of_law) : 0.0;
  const double dashpot = slip_mobility > 0.0 ? 2.0 * p.damping * std::sqrt(sideways / slip_mobility) : 0.0;
  out.across = damped_weight(sideways, dashpot, slip_mobility, dt);
  const AnyRolling::Parameters r{law_.rolling, row.rolling[0], row.rolling[1]};
  // type A is limited to what stops the spin
  if (!law_.rolls || r.type == AnyRolling::Type::constant || !(rolling_mobility > 0.0)) return out;
  const RollingStep step{n.of_law, n.force, at.effective_radius, 1.0 / rolling_mobility, 0.0, 0.0, dt};
  out.turn = damped_weight(AnyRolling::stiffness(r, step), AnyRolling::damping(r, step), 1.0 / step.inertia, dt);
  return out;
}

void ContactLinks::append(const World& world, const ContactSet& contacts, std::size_t begin, std::size_t end, double dt,
                          std::vector<StiffLink>& links) const {
  for (std::size_t k = begin; k < end; ++k) {
    const Slot a = contacts.a[k], b = contacts.b[k];
    const double mobility = world.inverse_mass[a] + world.inverse_mass[b];
    if (mobility == 0.0) continue;
    ContactKinematics at;
    at.effective_radius = k < contacts.effective_radius.size() ? contacts.effective_radius[k] : 0.0;
    const std::size_t pair = world.material[a] * law_.materials + world.material[b];
    const double reach = reach_(law_.numbers.data() + pair * law_.per_pair, at.effective_radius);
    if (!(contacts.gap[k] < reach)) continue;
    at.overlap = contacts.gap[k] < 0.0 ? -contacts.gap[k] : std::min(-contacts.gap[k], -1e-6 * reach);
    at.effective_mass = 1.0 / mobility;
    if (k < contacts.area.size()) at.area = contacts.area[k];
    const Vec3 arm_a = contacts.arm[k], arm_b = contacts.arm_b(k, world);
    const double slip = slip_mobility_of(world, a, arm_a) + slip_mobility_of(world, b, arm_b);
    const double roll = rolling_mobility_of(world, a, arm_a) + rolling_mobility_of(world, b, arm_b);
    StiffLink l = link(world.material[a], world.material[b], at, slip, roll, dt);
    l.a = a;
    l.b = b;
    l.arm_a = arm_a;
    l.arm_b = arm_b;
    l.normal = contacts.normal[k];
    links.push_back(l);
  }
}

}  // namespace epafi
