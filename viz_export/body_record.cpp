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

BodyList::BodyList(const World& world, SurfaceCache& surfaces) : world_(&world), surfaces_(&surfaces) {
  slots_.reserve(world.size());
  for (std::uint32_t id = 0; id < world.ids_given(); ++id)
    if (const Slot s = world.slot_of(static_cast<BodyId>(id)); s != no_slot) slots_.push_back(s);
}

/// Without the surface, which is looked up in a map that grows.
BodyRecord BodyList::made(Slot s) const {
  BodyRecord r;
  r.id = static_cast<std::uint32_t>(world_->id[s]), r.shape = world_->shape[s], r.material = world_->material[s];
  r.mass = world_->is_movable(s) ? 1.0 / world_->inverse_mass[s] : 0.0;
  r.radius = surfaces_->shapes().bounding_radius({world_->shape[s]});
  r.pose = world_->pose(s), r.velocity = world_->velocity[s];
  if (world_->rotates()) r.angular_velocity = world_->angular_velocity[s];
  r.kinetic_energy = kinetic_energy(*world_, s);
  return r;
}

BodyRecord BodyList::operator[](std::size_t k) const {
  if (records_ != nullptr) return (*records_)[k];
  BodyRecord r = made(slots_[k]);
  r.surface = surfaces_->of(*world_, slots_[k]);
  return r;
}

std::vector<BodyRecord> BodyList::all() const {
  if (records_ != nullptr) return *records_;
  std::vector<BodyRecord> records(slots_.size());
  parallel_for(slots_.size(), [&](std::size_t k) { records[k] = made(slots_[k]); });
  for (std::size_t k = 0; k < slots_.size(); ++k) records[k].surface = surfaces_->of(*world_, slots_[k]);
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
