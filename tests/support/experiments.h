/// @file experiments.h  Small worlds wired by hand, without the scene reader: spheres and planes, smooth contact.
/// Detection here is all pairs by closed forms, an independent stand-in for the detection floor.
#pragma once
#include <algorithm>
#include <numbers>
#include <numeric>

#include "engine/schemes/velocity_verlet.h"
#include "engine/step/energy.h"
#include "engine/step/step.h"
#include "laws/smooth/make_smooth_contact.h"

namespace epafi::experiments {

using std::numbers::pi;

/// A hard wall, and a ball of glass softened to a time step of microseconds.
inline const Material rigid{"rigid", 1000, std::numeric_limits<double>::infinity(), 0.0};
inline const Material ball{"ball", 2500, 1e9, 0.25};

/// Nothing to find: the narrow phase below tries all pairs.
class NoBroadPhase final : public BroadPhase {
 public:
  const char* name() const override { return "none"; }
  void find_pairs(const World&, PairList&) override {}
};

/// Shape numbers of World::shape index `shapes`: a radius, or 0 for the half space below a plane of that normal.
struct HandShape {
  double radius = 0.0;
  Vec3 normal = Vec3::UnitZ();
};

/// All pairs; reports contacts of gap below `reach` as well, which must carry no force. The contact point divides the
/// line of centres in proportion to the radii: inside the overlap, and at the sphere's own radius where the other is a
/// plane.
class HandNarrowPhase final : public NarrowPhase {
 public:
  std::vector<HandShape> shapes;
  double reach = 0.0;

  const char* name() const override { return "by hand"; }
  void collide(const World& world, const PairList&, ContactSet& contacts) override {
    contacts.clear();
    contacts.with_curvature = true;
    for (Slot s = 0; s < world.size(); ++s)
      for (Slot r = 0; r < world.size(); ++r)
        if (world.id[s] < world.id[r] && (world.is_movable(s) || world.is_movable(r))) meet(world, s, r, contacts);
  }

 private:
  void meet(const World& world, Slot a, Slot b, ContactSet& contacts) const {
    const HandShape &p = shapes[world.shape[a]], &q = shapes[world.shape[b]];
    ContactPoint c;
    if (p.radius > 0.0 && q.radius > 0.0) {
      const Vec3 d = world.position[b] - world.position[a];
      const double far = p.radius + q.radius + reach;
      if (d.squaredNorm() > far * far) return;
      c.gap = d.norm() - p.radius - q.radius;
      c.normal = d.normalized();
      c.arm = p.radius / (p.radius + q.radius) * d;
      c.effective_radius = p.radius * q.radius / (p.radius + q.radius);
    } else {
      const bool plane_is_a = p.radius == 0.0;
      const Slot plane = plane_is_a ? a : b, ball = plane_is_a ? b : a;
      const Vec3 n = shapes[world.shape[plane]].normal;
      const double radius = shapes[world.shape[ball]].radius;
      c.gap = n.dot(world.position[ball] - world.position[plane]) - radius;
      c.normal = plane_is_a ? n : Vec3(-n);
      const Vec3 point = world.position[ball] - radius * n;
      c.arm = point - world.position[a];
      c.effective_radius = radius;
    }
    if (c.gap < reach) contacts.append(a, b, c);
  }
};

/// A world with its stages, advanced by velocity Verlet, and its energy ledger.
struct Rig {
  World world;
  HandNarrowPhase* detection = nullptr;  ///< owned by stage
  Pipeline stage;
  Workspace work;
  EnergyLedger ledger;

  Rig(const SmoothSetup& setup, Columns columns) : world(columns) {
    auto hand = std::make_unique<HandNarrowPhase>();
    detection = hand.get();
    stage = {std::make_unique<VelocityVerlet>(), std::make_unique<NoBroadPhase>(), std::move(hand),
             make_smooth_contact(setup)};
  }
  explicit Rig(const SmoothSetup& setup) : Rig(setup, Columns{.rotation = smooth_needs(setup).rotation}) {}

  BodyId add_sphere(double radius, double density, const Vec3& position, const Vec3& velocity,
                    const Vec3& spin = Vec3::Zero()) {
    Body body;
    body.mass = 4.0 / 3.0 * pi * radius * radius * radius * density;
    body.inertia = Vec3::Constant(0.4 * body.mass * radius * radius);
    body.position = position;
    body.velocity = velocity;
    body.angular_velocity = spin;
    return add(body, {.radius = radius});
  }
  BodyId add_plane(const Vec3& normal, const Vec3& point = Vec3::Zero(), const Vec3& velocity = Vec3::Zero()) {
    Body body;
    body.position = point;
    body.velocity = velocity;
    body.material = wall_material;
    return add(body, {0.0, normal});
  }
  void start() {
    evaluate_forces(world, stage, work);
    ledger.start(world, work.report);
  }
  void step(double dt) {
    epafi::step(world, stage, work, dt);
    ledger.add(work.report);
  }
  double mass(Slot s = 0) const { return 1.0 / world.inverse_mass[s]; }
  std::uint16_t wall_material = 0;

 private:
  BodyId add(Body body, const HandShape& shape) {
    body.shape = static_cast<std::uint32_t>(detection->shapes.size());
    detection->shapes.push_back(shape);
    return world.add(body);
  }
};

struct ContactChoice {
  std::string law;
  double restitution = 1.0, friction = 0.0, rolling_friction = 0.0;
  Parameters parameters{};
  std::string tangential{}, rolling{};
};

/// One material, or two: bodies of the first against walls of the second.
inline SmoothSetup setup_of(const ContactChoice& choice, const std::vector<Material>& materials) {
  SmoothSetup setup{choice.law, choice.tangential, choice.rolling, {materials.size(), {}}};
  for (const Material& a : materials)
    for (const Material& b : materials)
      setup.materials.pairs.push_back(
          {a, b, choice.restitution, choice.friction, choice.rolling_friction, choice.parameters});
  if (materials.size() > 1) setup.materials.pairs.back().occurs = false;  // wall and wall
  return setup;
}

inline Parameters parameters_of(std::initializer_list<std::pair<const char*, double>> values) {
  Parameters out;
  for (const auto& [name, value] : values) out.set(name, value);
  return out;
}

/// Two equal spheres about to meet head on along x with relative speed 2 v; `phase` of a step before they touch.
inline Rig two_spheres(const SmoothSetup& setup, double radius, double v, double first_gap) {
  Rig rig(setup);
  const double density = setup.materials.pairs[0].a.density;
  rig.add_sphere(radius, density, {-radius - 0.5 * first_gap, 0, 0}, {v, 0, 0});
  rig.add_sphere(radius, density, {radius + 0.5 * first_gap, 0, 0}, {-v, 0, 0});
  return rig;
}

/// A sphere above the plane z = 0 of the set-up's second material (or its only one).
inline Rig sphere_on_plane(const SmoothSetup& setup, double radius, double gap, const Vec3& velocity,
                           const Vec3& spin = Vec3::Zero()) {
  Rig rig(setup);
  rig.wall_material = setup.materials.materials > 1 ? 1 : 0;
  rig.add_sphere(radius, setup.materials.pairs[0].a.density, {0, 0, radius + gap}, velocity, spin);
  rig.add_plane(Vec3::UnitZ());
  return rig;
}

/// What is seen of one impact.
struct Impact {
  double largest_overlap = 0.0, largest_force = 0.0, contact_time = 0.0, restitution = 0.0;
  double loop_area = 0.0;     ///< closed integral of N d(delta) by trapezoids [J]
  double lowest_force = 0.0;  ///< most attractive force seen [N]
  double energy_error = 0.0;  ///< of the ledger, after the impact
};

/// Runs until the bodies have parted. Separation is timed at the end of force by linear interpolation between steps.
inline Impact run_impact(Rig& rig, double dt) {
  Impact out;
  rig.start();
  const auto approach = [&] {
    const Vec3 n = rig.detection->shapes[1].radius > 0.0 ? Vec3(Vec3::UnitX()) : Vec3(-Vec3::UnitZ());
    return (rig.world.velocity[0] - rig.world.velocity[1]).dot(n);
  };
  const double before = approach();
  double gap = 1.0, force = 0.0;
  bool touched = false;
  for (int k = 0; k < 10000000; ++k) {
    const double old_gap = gap, old_force = force;
    rig.step(dt);
    const bool in_contact = rig.work.report.touching > 0;
    if (!in_contact && touched) break;
    if (rig.work.contacts.size() == 0) continue;
    gap = rig.work.contacts.gap[0];
    force = -rig.work.contacts.force[0].dot(rig.work.contacts.normal[0]);
    if (!in_contact) continue;
    if (touched)
      out.loop_area += 0.5 * (force + old_force) * (old_gap - gap);
    else
      out.loop_area += 0.5 * force * -gap;
    touched = true;
    if (force > 0.0) out.contact_time += dt;
    out.largest_overlap = std::max(out.largest_overlap, -gap);
    out.largest_force = std::max(out.largest_force, force);
    out.lowest_force = std::min(out.lowest_force, force);
  }
  out.restitution = -approach() / before;
  rig.ledger.measure(rig.world);
  out.energy_error = rig.ledger.relative_error();
  return out;
}

}  // namespace epafi::experiments
