/// @file body_record.h  One body for snapshots and frames, from the running world or from run.h5, so that frames made
/// afterwards equal those of the run.
#pragma once
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "engine/state/large_column.h"
#include "engine/state/world.h"
#include "viz_export/vtk/surface.h"

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

/// Bodies in the order of their ids, each value fetched on access: records of all would take 152 bytes a body.
class BodyList {
 public:
  BodyList(const World& world, SurfaceCache& surfaces);
  /// List of records, which the caller keeps alive.
  BodyList(const std::vector<BodyRecord>& records);
  /// The bodies of this list at `places`, ascending.
  BodyList only(UnwrittenColumn<Slot> places) const;
  /// The spheres of this list; others: places of all other bodies.
  BodyList spheres(std::span<const Slot> others) const;
  std::size_t size() const { return size_; }

  std::uint32_t id(std::size_t k) const;
  std::uint32_t shape(std::size_t k) const;
  std::uint16_t material(std::size_t k) const;
  double mass(std::size_t k) const;    ///< [kg], 0 for fixed and driven bodies
  double radius(std::size_t k) const;  ///< of the bounding sphere [m]
  Pose pose(std::size_t k) const;
  Vec3 position(std::size_t k) const;          ///< [m]
  Vec3 velocity(std::size_t k) const;          ///< [m/s]
  Vec3 angular_velocity(std::size_t k) const;  ///< world axes [rad/s]
  double kinetic_energy(std::size_t k) const;  ///< [J]
  bool is_sphere(std::size_t k) const;
  bool is_wall(std::size_t k) const { return mass(k) == 0.0; }
  /// Null for spheres; not by two threads at once, the cache grows.
  const Surface* surface(std::size_t k) const;
  BodyRecord operator[](std::size_t k) const;

 private:
  BodyList() = default;
  /// A record's member, or what of(slot) gives.
  template <class T, class Of>
  T value(std::size_t k, T BodyRecord::*member, const Of& of) const {
    return records_ != nullptr ? (*records_)[place(k)].*member : static_cast<T>(of(place(k)));
  }
  /// Among the records, or a slot.
  Slot place(std::size_t k) const {
    if (!place_.empty()) return place_[k];
    k += first_;
    return records_ != nullptr ? static_cast<Slot>(k) : world_->slot_of(static_cast<BodyId>(k));
  }
  const std::vector<BodyRecord>* records_ = nullptr;
  const World* world_ = nullptr;
  SurfaceCache* surfaces_ = nullptr;
  std::size_t size_ = 0;
  std::size_t first_ = 0;
  UnwrittenColumn<Slot> place_;  ///< empty: `size` records or ids one behind the other from `first` on
};

/// All bodies in the order of their ids.
std::vector<BodyRecord> body_records(const World& world, SurfaceCache& surfaces);

}  // namespace epafi
