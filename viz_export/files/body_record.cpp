#include "viz_export/files/body_record.h"

#include <cmath>

#include "engine/step/energy.h"
#include "engine/threads/parallel_order.h"

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

BodyList::BodyList(const World& world, SurfaceCache& surfaces)
    : world_(&world), surfaces_(&surfaces), size_(world.size()) {
  if (size_ == world.ids_given()) return;
  const auto slot = [&](std::size_t id) { return world.slot_of(static_cast<BodyId>(id)); };
  parallel_select(
      world.ids_given(), [&](std::size_t id) { return slot(id) != no_slot; }, slot, place_);
}

BodyList::BodyList(const std::vector<BodyRecord>& records) : records_(&records), size_(records.size()) {}

BodyList BodyList::only(UnwrittenColumn<Slot> places) const {
  BodyList out;
  out.records_ = records_;
  out.world_ = world_;
  out.surfaces_ = surfaces_;
  parallel_for(places.size(), [&](std::size_t k) { places[k] = place(places[k]); });
  out.size_ = places.size();
  out.place_ = std::move(places);
  return out;
}

BodyList BodyList::spheres(std::span<const Slot> others) const {
  BodyList out;
  out.records_ = records_;
  out.world_ = world_;
  out.surfaces_ = surfaces_;
  out.size_ = size_ - others.size();
  const bool in_front = others.empty() || others.back() + std::size_t{1} == others.size();
  const bool behind = others.empty() || others.front() == out.size_;
  if (place_.empty() && (in_front || behind))
    out.first_ = first_ + (behind ? 0 : others.size());
  else
    parallel_select(
        size_, [this](std::size_t k) { return is_sphere(k); }, [this](std::size_t k) { return place(k); }, out.place_);
  return out;
}

std::uint32_t BodyList::id(std::size_t k) const {
  return value(k, &BodyRecord::id, [this](Slot s) { return world_->id[s]; });
}
std::uint32_t BodyList::shape(std::size_t k) const {
  return value(k, &BodyRecord::shape, [this](Slot s) { return world_->shape[s]; });
}
std::uint16_t BodyList::material(std::size_t k) const {
  return value(k, &BodyRecord::material, [this](Slot s) { return world_->material[s]; });
}
double BodyList::mass(std::size_t k) const {
  return value(k, &BodyRecord::mass,
               [this](Slot s) { return world_->is_movable(s) ? 1.0 / world_->inverse_mass[s] : 0.0; });
}
double BodyList::radius(std::size_t k) const {
  return value(k, &BodyRecord::radius,
               [this](Slot s) { return surfaces_->shapes().bounding_radius({world_->shape[s]}); });
}
Pose BodyList::pose(std::size_t k) const {
  return value(k, &BodyRecord::pose, [this](Slot s) {
    return Pose{world_->shown_position(s), world_->pose(s).orientation};
  });
}
Vec3 BodyList::position(std::size_t k) const {
  return records_ != nullptr ? (*records_)[place(k)].pose.position : world_->shown_position(place(k));
}
Vec3 BodyList::velocity(std::size_t k) const {
  return value(k, &BodyRecord::velocity, [this](Slot s) { return world_->velocity[s]; });
}
Vec3 BodyList::angular_velocity(std::size_t k) const {
  return value(k, &BodyRecord::angular_velocity,
               [this](Slot s) { return world_->rotates() ? world_->angular_velocity[s] : Vec3(Vec3::Zero()); });
}
double BodyList::kinetic_energy(std::size_t k) const {
  return value(k, &BodyRecord::kinetic_energy, [this](Slot s) { return epafi::kinetic_energy(*world_, s); });
}
bool BodyList::is_sphere(std::size_t k) const {
  return records_ != nullptr ? (*records_)[place(k)].surface == nullptr
                             : ShapeRef{world_->shape[place(k)]}.type() == BodyRecord::sphere_type;
}
const Surface* BodyList::surface(std::size_t k) const {
  return value(k, &BodyRecord::surface, [this](Slot s) { return surfaces_->of(*world_, s); });
}

BodyRecord BodyList::operator[](std::size_t k) const {
  if (records_ != nullptr) return (*records_)[place(k)];
  return {id(k),   shape(k),    material(k),         mass(k),          radius(k), surface(k),
          pose(k), velocity(k), angular_velocity(k), kinetic_energy(k)};
}

std::vector<BodyRecord> body_records(const World& world, SurfaceCache& surfaces) {
  const BodyList list(world, surfaces);
  std::vector<BodyRecord> records;
  records.reserve(list.size());
  for (std::size_t k = 0; k < list.size(); ++k) records.push_back(list[k]);
  return records;
}

}  // namespace epafi
