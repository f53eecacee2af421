/// @file fat_bodies.h  Bounding volumes of a broad phase: boxes and balls enlarged so that the pair list lasts for many
/// steps. A fat volume is the exact bound plus (reach + margin)/2 on every side; each body has its own margin. Two
/// bodies are near if their fat boxes AND their fat bounding balls overlap. Every method lists the near pairs, so all
/// lists are equal. Displacements are relative to the common motion (engine/step/common_motion.h): in any frame two
/// bodies approach by at most the sum of their displacements, and 20 000 spheres that fall into a hopper need half as
/// many lists (10.9 instead of 17.5 ns a step). The margin of a half-space is used up by its approach to the positions
/// of the bodies. In a periodic cell the columns continue with images (detection/broad/periodic_pairs.h), which have
/// the margins of their bodies.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "detection/aabb.h"
#include "detection/broad/list_frame.h"
#include "detection/broad/periodic_pairs.h"
#include "detection/broad/sphere_roles.h"
#include "detection/shape_store.h"
#include "engine/state/large_column.h"
#include "engine/step/common_motion.h"

namespace epafi {

/// Pairs of shapes that can touch. Pairs of two immovable bodies never do.
struct PairFilter {
  /// types * types flags [type_a * types + type_b]: a cell of the pair table exists; empty: all do.
  std::vector<char> has_cell;
  bool allows(std::uint32_t a, std::uint32_t b) const { return has_cell.empty() || has_cell[a * AllShapes::size + b]; }
};

/// Settings of every broad phase.
struct BroadSetup {
  const ShapeStore* shapes = nullptr;
  double reach = 0.0;   ///< lists pairs whose gap may become smaller than this [m], >= 0
  double margin = 0.0;  ///< margin of all bodies [m]; <= 0: chosen for each body from size and motion
  PairFilter filter{};
  SphereRoles spheres{};  ///< which pairs go to PairList::spheres
  bool strays = true;     ///< the few fastest bodies may have margins of many radii; not in a periodic cell
};

/// Fat bounding ball; 32 bytes, so that a candidate costs half a cache line.
struct Ball {
  double x, y, z, r;
  bool overlaps(const Ball& o) const {
    const double dx = x - o.x, dy = y - o.y, dz = z - o.z, s = r + o.r;
    return dx * dx + dy * dy + dz * dz <= s * s;
  }
};

/// Plane of apart[k] if that is a half-space.
struct ApartPlane {
  Vec3 normal = Vec3::Zero();  ///< world axes; zero where it is none
  Vec3 point = Vec3::Zero();
  double reach = 0.0;    ///< its enlargement [m]
  Slot place = no_slot;  ///< if it has the role of a plane: its place in SpherePairs
  bool loose = false;    ///< it may move: bodies outside FatBodies::around are always near it
  bool is_plane() const { return normal.squaredNorm() > 0.0; }
};

/// State of a list: whether it is outdated.
struct ListState {
  bool out = false, by_slow = false;  ///< by_slow: a slow body (with the least margin) has used up its margin
  void see(bool beyond, bool slow) {
    out = out || beyond;
    by_slow = by_slow || (beyond && slow);
  }
  ListState& operator+=(const ListState& o) {
    out = out || o.out;
    by_slow = by_slow || o.by_slow;
    return *this;
  }
};

/// The largest displacement of a body since the list was built, over half its margin; the list is outdated above 1.
struct MarginUse {
  double most = 0.0;
  ListState used_up{};
  /// limit: use of a margin above which the list is used up.
  void see(double used_margin, bool slow, double limit) {
    most = std::max(most, used_margin);
    used_up.see(used_margin > limit, slow);
  }
};

/// Ratio to the median radius above which one box test per body is cheaper than one more grid level.
inline constexpr double giant_ratio = 16.0;

/// Median bounding radius of some thousand bodies [m]; affects only which bodies are giants and which margins are
/// large.
double median_radius(const World& world, const ShapeStore& shapes);
/// Bounding radius above which bodies are tested one by one against all others [m]; radius(s): that of body s < count.
double largest_ordinary(std::size_t count, double median, const std::function<double(std::size_t)>& radius);

/// Bounding volumes by slot, and the state at their update.
struct FatBodies {
  FatBodies();
  std::vector<Aabb> boxes;     ///< fat, world axes [m]; empty if all are spheres and half-spaces (balls suffice)
  UnwrittenColumn<Ball> ball;  ///< fat, about the centre of mass [m]; bodies, then images
  std::vector<double> half;    ///< as half_of; with boxes
  std::vector<double> radius;  ///< bounding radius of the shape [m], infinite for half-spaces; with boxes
  std::vector<float> inverse_half_margin;  ///< rounded up [1/m]; at most largest_inverse_half_margin; without images
  std::vector<CellImage> images;           ///< of bodies, in a periodic cell
  std::vector<std::uint32_t> id;
  std::vector<std::uint8_t> type;
  std::vector<char> immovable;
  std::vector<SphereRole> role;     ///< with setup.spheres.wanted
  std::vector<char> elsewhere;      ///< bodies of other processes; empty: there are none
  std::vector<Quat> orientation;    ///< at the last update, in worlds that rotate
  std::vector<Slot> ordinary;       ///< bounded bodies, ascending
  std::vector<Slot> apart;          ///< unbounded bodies and a few giants, ascending: tested one by one against all
  std::vector<ApartPlane> plane;    ///< of apart[k]
  std::vector<Slot> sphere_planes;  ///< half-spaces with the role of a plane, ascending
  Aabb around;                ///< box around the centres of all free bodies except strays, if half-spaces may move [m]
  bool only_spheres = false;  ///< every pair is one of PairList::spheres
  bool ordered_spheres = false;  ///< all ordinary bodies are such spheres, and no body in `apart` is

  std::size_t bodies() const { return inverse_half_margin.size(); }
  /// Number of bodies and images.
  std::size_t size() const { return inverse_half_margin.size() + images.size(); }
  /// Fat box, world axes [m].
  Aabb box(std::size_t i) const {
    return boxes.empty() ? Aabb{position(i) - Vec3::Constant(ball[i].r), position(i) + Vec3::Constant(ball[i].r)}
                         : boxes[i];
  }
  /// When the boxes were taken [m].
  Vec3 position(std::size_t i) const { return {ball[i].x, ball[i].y, ball[i].z}; }
  /// Radius of the part that a rotation moves [m]: 0 for spheres.
  double turning_radius(std::size_t i) const { return is_sphere(i) ? 0.0 : round_ ? infinity : radius[i]; }
  /// Largest distance from the centre to a face of the fat box [m].
  double half_of(std::size_t i) const { return half.empty() ? ball[i].r : half[i]; }
  bool near(Slot i, Slot j) const {
    return ball[i].overlaps(ball[j]) && (boxes.empty() || boxes[i].overlaps(boxes[j]));
  }
  /// True if the fat body reaches the enlarged half-space.
  bool near_plane(Slot i, const ApartPlane& p) const {
    if (p.loose && !is_around(position(i))) return true;
    const double depth = p.normal.dot(position(i) - p.point) - ball[i].r;
    return (boxes.empty() ? depth : std::max(depth, corner_depth(i, p))) <= p.reach;
  }
  bool is_elsewhere(Slot i) const { return !elsewhere.empty() && elsewhere[i] != 0; }
  bool is_sphere_apart(Slot i) const { return role.empty() ? only_spheres : role[i] == SphereRole::sphere; }
  bool may_touch(Slot i, Slot j, const PairFilter& filter) const {
    return !(immovable[i] && immovable[j]) &&
           (id[i] < id[j] ? filter.allows(type[i], type[j]) : filter.allows(type[j], type[i]));
  }

  /// Computes all columns. step_time: dt [s] if known, else 0 (margins from sizes alone). same_bodies: slots are those
  /// of the last call. Includes images if the world has a cell.
  void update(const World& world, const BroadSetup& setup, double step_time, bool same_bodies);
  /// Adds bodies that entered since, in slots after the others, in the frame of the last update. Returns false, without
  /// changes, if that is not possible; the next update adds them.
  bool take_in(const World& world, const BroadSetup& setup, double step_time);
  /// Adapts the margins of slow bodies to the lifetime of a list that is used up. Call it before update.
  void learn(const World& world, double step_time, bool used_up_by_slow);
  /// Tests whether some body, or some slow one, has moved by more than half its margin.
  ListState used_up(const World& world) const;
  /// Use of margins by slots [begin, end), for spheres or resting bodies; at(s): position of slot s now. Excludes
  /// half-spaces that may move.
  template <class At>
  MarginUse used_margin(std::size_t begin, std::size_t end, const At& at, const ListFrame& now,
                        double limit = 1.0) const {
    MarginUse most;
    const double growth = now.growth();
    for (std::size_t s = begin; s < end; ++s)
      if (!is_loose_plane(s))
        most.see(growth * displacement(s, now.back(at(s))) * double{inverse_half_margin[s]} + now.strain_use,
                 slow_[s] != 0, limit);
    return most;
  }
  /// Largest approach of the movable half-spaces to the positions of bodies, over half their margins.
  double plane_use(const World& world, const ListFrame& now) const;
  /// Motion of the list's frame since the last update.
  ListFrame frame(const World& world) const;
  /// True if some bounded body is fixed or driven: a deforming cell flows past it.
  bool holds_bounded() const { return holds_bounded_; }
  /// Largest margin of the bodies from slot `first` on [m].
  double largest_margin(std::size_t first = 0) const;
  /// True if all are spheres and half-spaces, so that used_margin and plane_use cover all displacements.
  bool are_round() const { return round_; }
  /// The common motion from time `now` on.
  CommonMotion common_motion(double now) const {
    return {common_motion_.velocity_at(now - taken_at_), common_motion_.acceleration};
  }

 private:
  double median_radius_ = 0.0;
  double most_margin_;  ///< of the bounding radius, of free bodies
  double least_share_;  ///< least margin over radius
  CommonMotion common_motion_;
  Vec3 mean_velocity_ = Vec3::Zero();  ///< of the bodies that move, at the last update [m/s]
  bool knows_mean_ = false;
  double taken_at_ = 0.0;      ///< time of the last update [s]
  double steps_ = 0.0;         ///< intended lifetime of the list for fast bodies, in steps
  bool round_ = false;         ///< all are spheres and half-spaces
  bool complete_ = false;      ///< every body is in `ordinary` or `apart`
  std::vector<char> slow_;     ///< has the least margin of its size
  bool loose_planes_ = false;  ///< some half-space may move
  bool holds_bounded_ = false;
  double most_radius_ = 0.0;              ///< largest radius of bodies other than spheres [m]
  double strain_over_half_margin_ = 0.0;  ///< largest fat radius over half its margin, in a periodic cell
  Vec3 cell_size_ = Vec3::Ones();         ///< at the last update [m]
  bool is_half_space(std::size_t i) const { return type[i] == ShapeStore::type_of<HalfSpace>(); }
  /// A surface of revolution: rotation about its own axis moves nothing.
  bool is_hollow(std::size_t i) const {
    return type[i] == ShapeStore::type_of<Tube>() || type[i] == ShapeStore::type_of<Cone>();
  }
  bool is_loose_plane(std::size_t i) const {
    return is_half_space(i) && (role.empty() || role[i] != SphereRole::plane);
  }
  bool is_around(const Vec3& x) const {
    return (x.array() >= around.min.array()).all() && (x.array() <= around.max.array()).all();
  }
  bool is_sphere(std::size_t i) const { return type[i] == ShapeStore::type_of<Sphere>(); }
  double radius_of(const World& world, const ShapeStore& shapes, std::size_t i) const {
    return round_ ? shapes.bounding_radius({world.shape[i]}) : radius[i];
  }
  void resize_columns(std::size_t n);
  void read_shapes(const World& world, const BroadSetup& setup);
  static constexpr float largest_inverse_half_margin = 1e37f;
  double displacement(std::size_t i, const Vec3& x) const { return (x - position(i)).norm(); }
  double half_margin(std::size_t i) const { return 1.0 / double{inverse_half_margin[i]}; }
  bool is_beyond(const World& world, std::size_t i, bool rotates, const ListFrame& now) const;
  double corner_depth(Slot i, const ApartPlane& p) const;
  double margin_of(const World& world, Slot s, const BroadSetup& setup, double step_time, double steps) const;
  double mean_motion(const World& world, const BroadSetup& setup, double step_time) const;
  double choose_list_steps(const World& world, const BroadSetup& setup, double step_time, double since);
  static double fattening(const World& world, Slot s, const BroadSetup& setup, double margin);
  void fatten_one(const World& world, const BroadSetup& setup, Slot s, double margin, const Vec3& x);
  void fatten(const World& world, const BroadSetup& setup, double step_time, double steps);
  void set_apart(const World& world, const ShapeStore& shapes, bool same_bodies);
  void set_planes(const World& world, const BroadSetup& setup, double step_time, double steps);
  void look_around(const World& world, const ShapeStore& shapes);
  void add_images(const World& world);
  double speed_of(const World& world, Slot s, const ShapeStore& shapes, const Vec3& common_motion) const;
  double plane_speed(const World& world, Slot s, const ShapeStore& shapes, const Vec3& common_motion) const;
};

}  // namespace epafi
