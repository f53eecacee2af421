#include "viz_export/body_record.h"

#include <cmath>

#include "engine/energy.h"
#include "engine/parallel.h"

namespace epafi {

const Surface* SurfaceCache::of(const World& world, Slot body) {
  const ShapeRef ref{world.shape[body]};
  if (ref.type() == BodyRecord::sphere_type) return nullptr;
  if (plane_size_ == 0.0) {
    Aabb bodies;
    for (Slot s = 0; s < world.size(); ++s)
      if (std::isfinite(shapes_.bounding_radius({world.shape[s]}))) bodies.include(shapes_.bounding_box(world, s));
    const bool any = (bodies.min.array() <= bodies.max.array()).all();
    plane_size_ = any ? 1.5 * bodies.extent().norm() : 1.0;
    plane_centre_ = any ? bodies.centre() : Vec3(Vec3::Zero());
  }
  auto& surface = made_[ref.packed];
  if (!surface) {
    const Vec3 centre = world.pose(body).to_local(plane_centre_);
    surface = std::make_unique<Surface>(surface_of(shapes_, ref, plane_size_, centre));
  }
  return surface.get();
}

std::vector<BodyRecord> body_records(const World& world, SurfaceCache& surfaces) {
  std::vector<Slot> slots;
  slots.reserve(world.size());
  for (std::uint32_t id = 0; id < world.ids_given(); ++id)
    if (const Slot s = world.slot_of(static_cast<BodyId>(id)); s != no_slot) slots.push_back(s);
  std::vector<BodyRecord> records(slots.size());
  for (std::size_t k = 0; k < slots.size(); ++k) records[k].surface = surfaces.of(world, slots[k]);
  parallel_for(slots.size(), [&](std::size_t k) {
    const Slot s = slots[k];
    BodyRecord& r = records[k];
    r.id = static_cast<std::uint32_t>(world.id[s]), r.shape = world.shape[s], r.material = world.material[s];
    r.mass = world.is_movable(s) ? 1.0 / world.inverse_mass[s] : 0.0;
    r.radius = surfaces.shapes().bounding_radius({world.shape[s]});
    r.pose = world.pose(s), r.velocity = world.velocity[s];
    if (world.rotates()) r.angular_velocity = world.angular_velocity[s];
    r.kinetic_energy = kinetic_energy(world, s);
  });
  return records;
}

std::vector<ContactRecord> contact_records(const World& world, const ContactSet& contacts) {
  std::vector<ContactRecord> records;
  if (contacts.force.size() != contacts.size()) return records;  // nobody has evaluated forces yet
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3& force = contacts.force[i];
    if (contacts.gap[i] >= 0.0 && force.squaredNorm() == 0.0) continue;
    const Slot a = contacts.a[i], b = contacts.b[i];
    ContactRecord r;
    r.id_a = static_cast<std::uint32_t>(world.id[a]), r.id_b = static_cast<std::uint32_t>(world.id[b]);
    r.from = world.is_movable(a) ? world.position[a] : contacts.point(i, world);
    r.to = world.is_movable(b) ? Vec3(world.position[a] + world.branch(a, b, contacts.feature[i])) : contacts.point(i, world);
    r.force = force;
    r.normal_force = -force.dot(contacts.normal[i]);
    r.overlap = std::max(0.0, -contacts.gap[i]);
    records.push_back(r);
  }
  return records;
}

}  // namespace epafi
