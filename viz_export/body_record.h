/// @file body_record.h  One body as files show it: what snapshots store and frames draw. Made from the running world,
/// or read back from run.h5, so that frames made afterwards are those that the run would have written.
#pragma once
#include <map>
#include <memory>
#include <vector>

#include "engine/contacts.h"
#include "viz_export/surface.h"

namespace epafi {

struct BodyRecord {
  static constexpr std::uint32_t sphere_type = ShapeStore::type_of<Sphere>();
  std::uint32_t id = 0;
  std::uint32_t shape = 0;  ///< packed reference, see detection/shape_store.h
  std::uint16_t material = 0;
  double mass = 0.0;                 ///< [kg], 0 for fixed and driven bodies
  double radius = 0.0;               ///< of the bounding sphere [m], infinite for half-spaces
  const Surface* surface = nullptr;  ///< null: a sphere
  Pose pose;
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< world axes [rad/s]
  double kinetic_energy = 0.0;           ///< translation and rotation [J], 0 for fixed and driven bodies
  bool is_wall() const { return mass == 0.0; }
};

/// One contact as a frame shows it.
struct ContactRecord {
  std::uint32_t id_a = 0, id_b = 0;
  Vec3 from = Vec3::Zero(),
       to = Vec3::Zero();     ///< centre of A and of B; the contact point in place of a wall's centre [m]
  Vec3 force = Vec3::Zero();  ///< on A [N]
  double normal_force = 0.0;  ///< > 0 pushes the bodies apart [N]
  double overlap = 0.0;       ///< [m], >= 0
};

/// Surfaces of the shapes that occur, made once each. Half-spaces are cut to squares as large as the bodies' extent
/// when the first surface was made.
class SurfaceCache {
 public:
  explicit SurfaceCache(const ShapeStore& shapes) : shapes_(shapes) {}
  const ShapeStore& shapes() const { return shapes_; }
  /// Null for spheres. Pointers stay valid.
  const Surface* of(const World& world, Slot body);

 private:
  const ShapeStore& shapes_;
  double plane_size_ = 0.0;  ///< [m], 0 before the first surface
  Vec3 plane_centre_ = Vec3::Zero();
  std::map<std::uint32_t, std::unique_ptr<Surface>> made_;
};

/// Bodies in the order of their ids, each record made when it is asked for: together they take 152 bytes a body.
class BodyList {
 public:
  BodyList(const World& world, SurfaceCache& surfaces);
  /// Of records that somebody keeps meanwhile.
  BodyList(const std::vector<BodyRecord>& records) : records_(&records) {}
  std::size_t size() const { return records_ != nullptr ? records_->size() : slots_.size(); }
  BodyRecord operator[](std::size_t k) const;
  /// All of them, made in parallel.
  std::vector<BodyRecord> all() const;

 private:
  BodyRecord made(Slot s) const;
  const std::vector<BodyRecord>* records_ = nullptr;
  const World* world_ = nullptr;
  SurfaceCache* surfaces_ = nullptr;
  std::vector<Slot> slots_;
};

/// All bodies in the order of their ids.
inline std::vector<BodyRecord> body_records(const World& world, SurfaceCache& surfaces) {
  return BodyList(world, surfaces).all();
}
/// Contacts that touch or carry force, in canonical order.
std::vector<ContactRecord> contact_records(const World& world, const ContactSet& contacts);

}  // namespace epafi
