/// @file fat_bodies.h  What a broad phase sees of the bodies: boxes and balls fattened so that the pair list lasts for many steps.
/// Fat means the exact bound plus (reach + margin)/2 on every side, the margin being the body's own. Two bodies are near when
/// their fat boxes AND their fat bounding balls overlap; every method lists the near pairs, so all lists are the same.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "detection/aabb.h"
#include "detection/shape_store.h"

namespace epafi {

/// Which pairs can ever touch. Pairs of two immovable bodies never do.
struct PairFilter {
  /// types * types flags [type_a * types + type_b]: a cell of the pair table exists; empty: all do.
  std::vector<char> has_cell;
  bool allows(std::uint32_t a, std::uint32_t b) const { return has_cell.empty() || has_cell[a * AllShapes::size + b]; }
};

/// What every broad phase is made from.
struct BroadSetup {
  const ShapeStore* shapes = nullptr;
  double reach = 0.0;   ///< pairs whose gap may become smaller than this are wanted [m], >= 0
  double margin = 0.0;  ///< one margin for all bodies [m]; <= 0: each body its own, from its size and motion
  PairFilter filter{};
};

/// Fat bounding ball; 32 bytes, so that a candidate costs half a cache line.
struct Ball {
  double x, y, z, r;
  bool overlaps(const Ball& o) const {
    const double dx = x - o.x, dy = y - o.y, dz = z - o.z, s = r + o.r;
    return dx * dx + dy * dy + dz * dz <= s * s;
  }
};

/// Bounding columns by slot, and the state they were taken from.
struct FatBodies {
  FatBodies();
  std::vector<Aabb> boxes;             ///< fat, world axes [m]; empty where all are spheres and half-spaces: their balls say it
  std::vector<Ball> ball;              ///< fat, about the centre of mass [m]
  std::vector<double> half;            ///< largest distance from the centre to a face of the fat box [m]
  std::vector<double> radius;          ///< bounding radius of the shape [m]; infinite for half-spaces
  std::vector<double> margin;          ///< [m]
  std::vector<std::uint32_t> id, type;
  std::vector<char> immovable;
  std::vector<Quat> orientation;       ///< when the boxes were taken, in worlds that rotate
  std::vector<Slot> ordinary;          ///< bounded bodies, ascending
  std::vector<Slot> apart;             ///< unbounded ones and a few giants, ascending: tested one by one against all
  std::vector<Vec3> plane_normal;      ///< of apart[k], world axes; zero where it is no half-space

  std::size_t size() const { return ball.size(); }
  /// Fat, world axes [m].
  Aabb box(std::size_t i) const {
    return boxes.empty() ? Aabb{position(i) - Vec3::Constant(ball[i].r), position(i) + Vec3::Constant(ball[i].r)} : boxes[i];
  }
  /// When the boxes were taken [m].
  Vec3 position(std::size_t i) const { return {ball[i].x, ball[i].y, ball[i].z}; }
  /// Of what a rotation moves [m]: 0 for spheres.
  double turning_radius(std::size_t i) const { return type[i] == ShapeStore::type_of<Sphere>() ? 0.0 : radius[i]; }
  bool near(Slot i, Slot j) const { return ball[i].overlaps(ball[j]) && (boxes.empty() || boxes[i].overlaps(boxes[j])); }
  /// The fat body reaches the fattened half-space apart[k].
  bool near_plane(Slot i, std::size_t k) const;
  bool may_touch(Slot i, Slot j, const PairFilter& filter) const {
    return !(immovable[i] && immovable[j]) && (id[i] < id[j] ? filter.allows(type[i], type[j]) : filter.allows(type[j], type[i]));
  }

  /// Takes everything from the world; step_time is dt [s] where it is known, else 0 (margins from sizes alone).
  void update(const World& world, const BroadSetup& setup, double step_time);
  /// The list is outdated: how long it lasted says how large the margins of slow bodies ought to be. Before update.
  void learn(const World& world, double step_time);
  /// Some body has moved (its surface, with rotation) by more than half its margin since update.
  bool outdated(const World& world) const;
  /// The largest way of a body since update over half its margin.
  double wear(const World& world) const;
  double largest_margin() const;

 private:
  double median_radius_ = 0.0;
  double least_share_;  ///< least margin over radius
  double taken_at_ = 0.0;  ///< time of the last update [s]
  void read_shapes(const World& world, const ShapeStore& shapes);
  double way(const World& world, std::size_t i) const;
  void choose_margins(const World& world, const BroadSetup& setup, double step_time);
  void fatten(const World& world, const BroadSetup& setup);
  void set_apart(const World& world, const ShapeStore& shapes);
  bool median_holds() const;
  void find_median_radius();
};

}  // namespace epafi
