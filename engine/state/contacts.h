/// @file contacts.h  Candidate pairs and contacts: what detection produces and contact models consume.
/// Canonical order: by (a, b, feature) with a, b the slots. A is always the body of lower id, the normal points from A
/// to B. The order is a function of the state alone, so sums taken along it are the same bits for every thread count.
#pragma once
#include <compare>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "engine/state/large_column.h"
#include "engine/state/state_visitor.h"
#include "engine/state/world.h"

namespace epafi {

/// Two bodies whose fattened bounding boxes overlap; id(a) < id(b).
struct Pair {
  Slot a, b;
  std::uint32_t image = 0;  ///< image_code of B, and in the next byte that of the contact's key; 0: B itself
  auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 sees the 0 of <=>
};

using PairColumn = UnwrittenColumn<Pair>;

/// Pairs of spheres, and of spheres with fixed half-spaces, whose contacts the contact model detects itself. They are
/// indexed by place: the balls of clumps and of held bodies come first (engine/state/body_ball.h), then all bodies by
/// slot, of which only free spheres have pairs. A pair is listed at its lower place; one with a half-space at its
/// sphere's. Without balls a place is a slot.
struct SpherePairs {
  static constexpr Slot plane = Slot{1} << 31;  ///< a partner with this bit is a place in `planes`

  std::vector<std::uint32_t> first;      ///< by place: index of its first partner
  UnwrittenColumn<Slot> partner;         ///< ascending; of a pair of spheres the higher place
  UnwrittenColumn<std::uint32_t> image;  ///< by partner, as Pair::image seen from the lower place; empty without a cell
  std::vector<Slot> planes;              ///< slots of the half-spaces, ascending

  std::size_t size() const { return partner.size(); }
};

/// Sorted candidate pairs, kept while no body has moved beyond the margin.
struct PairList {
  PairColumn pairs;
  double margin =
      0.0;  ///< the list holds every pair that comes closer than reach while displacements stay below margin/2 [m]
  std::uint64_t generation = 0;  ///< grows when the list changes: data derived from it are stale then
  /// Per slot: reciprocal of half the body's margin [1/m], rounded up; empty: `margin` for all. Held by the broad
  /// phase until it makes the next list or releases this one.
  std::span<const float> inverse_half_margin{};
  SpherePairs spheres{};  ///< not among `pairs`; empty where no contact model takes them
  /// Distance by which the bodies of a pair may approach while the list is valid [m].
  double margin_of(const Pair& p) const {
    return inverse_half_margin.empty()
               ? margin
               : 1.0 / double{inverse_half_margin[p.a]} + 1.0 / double{inverse_half_margin[p.b]};
  }
};

/// Persistent name of a contact within its pair: part or triangle, face, vertex; image code in the top byte.
using Feature = std::uint64_t;
constexpr Feature feature_of(std::uint32_t high, std::uint32_t low) { return Feature{high} << 32 | low; }

/// Geometry of one contact.
struct ContactPoint {
  double gap = std::numeric_limits<double>::infinity();  ///< signed distance [m], < 0 overlap
  Vec3 normal = Vec3::UnitZ();                           ///< unit, from A to B
  Vec3 arm = Vec3::Zero();                               ///< from A's centre to the contact point, world axes [m]
  double effective_radius = 0.0;                         ///< R* = 1/(1/R_a + 1/R_b) [m], where curvature is needed
  Feature feature = 0;
  double area = 0.0;  ///< volume over overlap of a cell of overlap volume [m^2], where needed
};

/// Walls that form one surface for a body: its contact with `wall` may continue one with `other`, or one at another
/// place of the same wall.
struct JoinedWalls {
  Slot body, wall, other;
  auto operator<=>(const JoinedWalls&) const = default;  // NOLINT(modernize-use-nullptr): as above
};

/// Columns of contacts. Columns the plan does not need stay empty.
struct ContactSet {
  bool with_curvature = false;  ///< effective_radius is filled
  bool with_moment = false;     ///< moment is filled by the contact model
  bool with_area = false;       ///< area is filled: contacts are cells of overlap volume

  std::vector<Slot> meshes;         ///< ascending: meshes, whose contacts move from face to face
  std::vector<JoinedWalls> joined;  ///< ascending

  std::vector<Slot> a, b;
  std::vector<Feature> feature;
  std::vector<double> gap;               ///< [m]
  std::vector<Vec3> normal;              ///< from A to B
  std::vector<Vec3> arm;                 ///< from A's centre to the contact point [m]
  std::vector<double> effective_radius;  ///< [m]
  std::vector<double> area;              ///< [m^2]
  std::vector<Vec3> force;               ///< on A, written by the contact model [N] (impulse / dt for non-smooth)
  std::vector<Vec3> moment;              ///< on A beside the force [N m]

  std::size_t size() const { return a.size(); }
  void clear();
  void append(Slot slot_a, Slot slot_b, const ContactPoint& c);
  /// Replaces all contacts by `size` ones that `put` must fill; reserves some more.
  void renew(std::size_t size);
  void put(std::size_t i, Slot slot_a, Slot slot_b, const ContactPoint& c, const Vec3& on_a, const Vec3& moment_on_a);
  void put(std::size_t i, const ContactSet& from, std::size_t k);
  /// Sorts into canonical order, with force and moment if they are filled.
  void sort();
  /// Appends all of `other` behind this.
  void append(const ContactSet& other);
  std::span<const JoinedWalls> joined_to(Slot body, Slot wall) const;
  /// From B's centre to the contact point [m].
  Vec3 arm_b(std::size_t i, const World& world) const { return arm[i] - world.branch(a[i], b[i], feature[i]); }
  Vec3 point(std::size_t i, const World& world) const { return world.position[a[i]] + arm[i]; }
  /// Bytes of one contact, as `epafi explain` prints them.
  std::size_t bytes_per_contact() const;
};

/// Keys of the contacts of the last step, to carry data (tangential springs, warm starts) from step to step. Both lists
/// are in canonical order, so matching is one merge. A contact that begins continues one of the same two bodies that
/// ends at the same place: the name of a corner changes where edges of two bodies cross. On a mesh, and on joined
/// walls, it may also continue one of the same body across an edge or seam: if both have the same name on the body, or
/// if they are the only ones that begin and end. A contact that existed before, but without remembered data, counts as
/// beginning.
class ContactMemory {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  using IsEmpty = std::function<bool(std::size_t)>;
  /// Sets previous[i] to the index of contact i in the remembered list, or none; then remembers `contacts`.
  /// is_empty(k): the remembered contact k has no data. turned: receives the contacts whose body A was B in the
  /// remembered list.
  void match(const World& world, const ContactSet& contacts, std::vector<std::uint32_t>& previous,
             const IsEmpty& is_empty = {}, std::vector<std::uint32_t>* turned = nullptr);
  /// Renames slots and restores canonical order; order[k] = old index of the entry now at k (removed ones are dropped).
  std::vector<std::uint32_t> reorder(const Reordering& change);
  void visit(StateVisitor& visitor, const std::string& name);
  std::size_t size() const { return a_.size(); }

 private:
  std::uint32_t left_for(const ContactSet& contacts, std::size_t i, const IsEmpty& is_empty) const;
  std::uint32_t left_nearby(const World& world, const ContactSet& contacts, std::size_t i, std::size_t k,
                            const IsEmpty& is_empty) const;
  void settle_joined(const ContactSet& contacts, std::vector<std::uint32_t>& previous,
                     std::vector<std::uint32_t>* turned);

  std::vector<Slot> a_, b_;
  std::vector<Feature> feature_;
  std::vector<Vec3> arm_;            ///< from A's centre, world axes [m]
  std::vector<std::uint8_t> taken_;  ///< of the remembered contacts, where walls are joined
};

}  // namespace epafi
