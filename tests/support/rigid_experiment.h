/// @file rigid_experiment.h  Small worlds of spheres and boxes under non-smooth contact, stepped by the real step().
#pragma once
#include <cmath>
#include <numbers>

#include "engine/schemes/moreau_jean.h"
#include "engine/step/energy.h"
#include "engine/step/step.h"
#include "laws/nonsmooth/nonsmooth_contact.h"
#include "tests/support/corner_contacts.h"

namespace epafi::test {

struct RigidSettings {
  double friction = 0.0, restitution = 0.0;
  double dt = 1e-3;                  ///< [s]
  Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s^2]
  double reach = 1e-3;               ///< [m]
  std::string solver = "pgs";
  Parameters parameters{};
};

inline MaterialTable one_material(double friction, double restitution) {
  MaterialTable table;
  table.materials = 1;
  table.pairs.resize(1);
  table.pairs[0].friction = friction;
  table.pairs[0].restitution = restitution;
  return table;
}

class RigidExperiment {
 public:
  World world{Columns{.rotation = true, .anisotropy = true, .force = false}};
  Workspace work;
  RigidSettings settings;
  double dissipated = 0.0, work_done = 0.0, correction = 0.0;  ///< sums over steps [J]
  int most_iterations = 0;
  double worst_residual = 0.0;

  explicit RigidExperiment(RigidSettings s) : settings(std::move(s)) { world.gravity = settings.gravity; }

  Slot plane(const Vec3& point, const Vec3& normal, const Vec3& velocity = Vec3::Zero()) {
    return add({Solid::Kind::plane, normal.normalized()}, {.position = point, .velocity = velocity});
  }
  Slot sphere(double radius, double density, const Vec3& position, const Vec3& velocity = Vec3::Zero(),
              const Vec3& angular_velocity = Vec3::Zero()) {
    const double m = density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    return add({Solid::Kind::sphere, Vec3::Constant(radius)}, {.position = position,
                                                               .velocity = velocity,
                                                               .angular_velocity = angular_velocity,
                                                               .mass = m,
                                                               .inertia = Vec3::Constant(0.4 * m * radius * radius)});
  }
  Slot box(const Vec3& half, double density, const Vec3& position, const Vec3& velocity = Vec3::Zero(),
           const Quat& orientation = Quat(1, 0, 0, 0)) {
    const double m = 8.0 * density * half.prod();
    const Vec3 s = half.cwiseProduct(half);
    return add({Solid::Kind::box, half}, {.position = position,
                                          .orientation = orientation,
                                          .velocity = velocity,
                                          .mass = m,
                                          .inertia = m / 3.0 * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y())});
  }
  void fix(Slot s) {
    world.inverse_mass[s] = 0.0;
    world.inverse_inertia[s].setZero();
  }

  void run(int steps) {
    if (!pipeline.scheme) build();
    for (int k = 0; k < steps; ++k) {
      step(world, pipeline, work, settings.dt);
      dissipated += work.report.dissipated;
      work_done += work.report.work;
      correction += work.report.correction;
      most_iterations = std::max(most_iterations, work.report.solver.iterations);
      worst_residual = std::max(worst_residual, work.report.solver.residual);
    }
  }
  void run_for(double time) { run(static_cast<int>(std::lround(time / settings.dt))); }

  double kinetic() const { return kinetic_energy(world); }
  double potential() const { return potential_energy(world); }
  double energy() const { return kinetic() + potential(); }
  double deepest() const {
    double depth = 0.0;
    for (const double gap : work.contacts.gap) depth = std::max(depth, -gap);
    return depth;
  }

  Pipeline pipeline;

 private:
  Slot add(const Solid& solid, Body body) {
    body.shape = static_cast<std::uint32_t>(solids_.size());
    solids_.push_back(solid);
    return world.slot_of(world.add(body));
  }
  void build() {
    pipeline.scheme = std::make_unique<MoreauJean>();
    pipeline.broad_phase = std::make_unique<EveryPair>();
    pipeline.narrow_phase = std::make_unique<CornerContacts>(solids_, settings.reach);
    pipeline.contact_model = make_nonsmooth_contact(
        {settings.solver, settings.parameters, one_material(settings.friction, settings.restitution)});
  }
  std::vector<Solid> solids_;
};

}  // namespace epafi::test
