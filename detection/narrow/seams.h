/// @file seams.h  Bodies that touch act as one surface: contacts that only one of them would give are taken out.
/// Where walls share a point p, a normal n of one of them is a normal of their union only if no other goes on beyond
/// the plane through p: the normal cone of a union is the intersection of the normal cones (Rockafellar and Wets 1998,
/// section 6). So the edge of the second of two level tiles does not stop a body that slides over it, while a ridge of
/// two roofs holds it. A contact goes only where the neighbour holds the body by a normal of the union at that point:
/// in the corner of floor and wall, which has none, both stand. Of two walls with the same normal at the same point the
/// one of lower id keeps the contact. Walls are fixed or driven bodies, and free ones that stand still against each
/// other (tiles on a floor, stones of an arch): those may differ in level by as much as they are pressed in there, up
/// to a tenth of half their least width. In a periodic cell a wall that is as wide as the cell touches its own images.
/// The convex parts of a solid, free or fixed, are one surface in the same way. On a surface of fixed or driven
/// walls a body rests with the points of one wall, and so does a body of parts (few_points.h); a convex one or a solid
/// on level faces as on one plate (seam_surfaces.cpp), whatever normal and points each pair has chosen.
///
/// Limits: of closed meshes only the surface counts, not the interior; free bodies are not joined for a body that
/// touches more than 64, or that is fixed or driven.
#pragma once
#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "detection/narrow/few_points.h"
#include "detection/narrow/on_surface.h"
#include "engine/state/contacts.h"

namespace epafi {

class Seams {
 public:
  /// Surfaces are level, or touch, within this share of the size of the body on the seam. Contact points of round
  /// bodies have errors of 1e-6 of it (a depth certified to 1e-12).
  static constexpr double tolerance = 1e-5;
  /// The same if one of two neighbours is free: stones of an arch with joints at the limit of friction creep by the
  /// solver's error, 1e-6 m in a second.
  static constexpr double free_tolerance = 1e-4;

  /// `shapes` must outlive this. reach: of contacts [m]; 0: smooth laws without adhesion.
  Seams(const ShapeStore& shapes, double reach) : shapes_(shapes), reach_(reach), springs_(!(reach > 0.0)) {}

  /// Finds the bodies with flat faces; call it whenever slots change. predicted: contacts without overlap carry no load
  /// yet.
  void find(const World& world, bool predicted);
  bool knows(const World& world) const { return flat_.size() == world.size(); }
  /// Removes contacts that the union does not have; the others keep their order. Expects contacts of the narrow phase,
  /// without forces and areas.
  void hide(const World& world, ContactSet& contacts);

 private:
  /// Contacts of two bodies, one image of them.
  struct Group {
    std::size_t begin, end;
    Slot a, b;
    Vec3 branch;         ///< from a to b, which may be an image [m]
    double depth = 0.0;  ///< of the deepest [m]
    /// Of a (0) or b (1) as the wall: by bits, which groups of the other body may be with neighbours of the wall.
    std::uint64_t beside[2] = {0, 0};
    Slot of(bool is_b) const { return is_b ? b : a; }
  };
  /// Numbers by slot.
  struct Lists {
    std::vector<std::uint32_t> begin, entries;
    std::span<const std::uint32_t> at(Slot s) const {
      return std::span(entries).subspan(begin[s], begin[s + 1] - begin[s]);
    }
    /// each(f) calls f(slot, number), the same ones each time; `begin` has an entry more than there are slots, all 0.
    template <class Each>
    void fill(const Each& each) {
      each([&](Slot s, std::uint32_t) { ++begin[s + 1]; });
      std::partial_sum(begin.begin(), begin.end(), begin.begin());
      entries.resize(begin.back());
      each([&](Slot s, std::uint32_t number) { entries[begin[s]++] = number; });
      std::rotate(begin.begin(), begin.end() - 1, begin.end());
      begin.front() = 0;
    }
  };
  /// A group as one of its bodies sees it.
  struct View {
    bool flat = false;               ///< the wall is; else nothing else is known
    Vec3 centre = Vec3::Zero();      ///< of the body, from where the arms begin [m]
    Vec3 wall = Vec3::Zero();        ///< centre of the wall from the body's [m]
    Vec3 out = Vec3::Zero();         ///< of the wall
    double top = 0.0, radius = 0.0;  ///< along `out` and around the wall's centre: seams lie within [m]
    double more = 0.0;               ///< by which a neighbour may be higher [m]
  };
  /// A contact that a neighbour, or another part of the same solid, may hide.
  struct Candidate {
    std::size_t contact;
    bool wall_is_b;
    Slot wall, body;
    BodyId id;                     ///< of the wall
    WallPiece piece;               ///< of the wall, or its part
    Vec3 point = Vec3::Zero();     ///< on the wall where it is itself, not at an image
    Vec3 normal = Vec3::Zero();    ///< out of it
    double near = 0.0;             ///< [m]: closer is touching
    bool on_wall = false;          ///< the point is; else nothing is known
    const Group* group = nullptr;  ///< of this wall and body
    std::size_t first_other = 0, last_other = 0;
  };

  /// A possible continuation of the surface at a point: a neighbour, or another part of the same solid.
  struct Other {
    Slot wall;
    BodyId id;
    WallPiece piece;     ///< where it is, with its shift
    Vec3 shift;          ///< of the image [m]; zero: the wall itself
    const Group* held;   ///< contacts of the body with it
    double level = 0.0;  ///< closer is touching, lower is level [m]
    bool free = false;   ///< it or the wall
    Aabb box{};          ///< of the piece, where both are held
  };

  /// A plane side of one wall of a surface, level with the others, relative to the body's centre.
  struct Top {
    const Group* group;
    WallPiece piece;
    PlaneSide side;
    double above(const Vec3& place) const { return side.normal.dot(place - piece.pose.position) - side.offset; }
  };

  bool touch_several(const World& world, const ContactSet& contacts);
  void list_groups(const World& world, const ContactSet& contacts);
  void find_beside(const World& world, const ContactSet& contacts);
  View view_of(const ContactSet& contacts, const Group& group, Slot body) const;
  static bool may_reach(const ContactSet& contacts, const View& wall, const View& other, const Group& group);
  void consider(const World& world, const ContactSet& contacts, const Group& group);
  bool may_be_near(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b,
                   std::span<const Other> others) const;
  bool has_other_near(const Candidate& c) const;
  std::span<const Other> others_of(const Candidate& c) const {
    return std::span(others_).subspan(c.first_other, c.last_other - c.first_other);
  }
  void list_others(const World& world, const ContactSet& contacts, const Group& group, bool wall_is_b);
  void add_other(const World& world, const ContactSet& contacts, const Group& group, bool wall_is_b, const Group& held);
  double near_of(Slot wall, Slot body) const;
  Candidate candidate(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) const;
  WallPiece piece_at(const Candidate& c, const Vec3& point) const;
  void find_hidden(const World& world, ContactSet& contacts);
  bool is_hidden(const World& world, ContactSet& contacts, const Candidate& c);
  /// Their walls are one surface.
  void join(const Group& first, const Group& second);
  std::uint32_t surface_of(std::uint32_t group) const;
  static SurfacePoint seen(const ContactSet& contacts, std::size_t i, const Group& group, bool wall_is_b);
  void join_level(const World& world, const ContactSet& contacts);
  bool are_level(const World& world, const ContactSet& contacts, std::uint32_t k, std::uint32_t m, Slot body);
  void rest_on_few(const World& world, ContactSet& contacts);
  void rest_on_few(const World& world, ContactSet& contacts, std::span<const std::uint32_t> surface);
  void find_corners(const World& world, Slot body, const Vec3& centre, OutlineCorners& out) const;
  void find_tops(const World& world, std::span<const std::uint32_t> surface, Slot body, const Vec3& normal,
                 const Vec3& on_wall);
  bool is_under(const Top& top, const Vec3& place, double near) const;
  bool is_in_joint(const SurfacePoint& p, double gap, double size) const;
  const Top* top_under(const Vec3& place, double near) const;
  bool stand_on_tops(const World& world, ContactSet& contacts, Slot body, double deepest, double size);
  ContactSet& meet_plate(const World& world, Slot body, bool curvature) const;
  void rest_on_tops(const World& world, ContactSet& contacts, std::span<const std::uint32_t> surface, double size);
  std::size_t find_holder(const World& world, const ContactSet& contacts, const Candidate& c, const Other& other) const;
  static bool comes_first(const Candidate& c, const Other& other);
  static Vec3 centre_of_body(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b);
  void decide_faces(const World& world, ContactSet& contacts);

  const ShapeStore& shapes_;
  double reach_;
  bool springs_;
  bool predicted_ = false;
  bool solids_ = false;                     ///< some body has parts
  bool joins_ = false;                      ///< there are bodies with flat faces that may touch
  std::vector<std::uint8_t> flat_;          ///< by slot: has flat faces
  std::vector<std::uint8_t> convex_;        ///< by slot, no ball: lies behind each of its contact planes
  std::vector<std::uint8_t> parts_;         ///< by slot: has several convex parts
  std::vector<std::uint8_t> touching_;      ///< by slot: has been seen in the contacts; 0 between steps
  std::vector<double> radius_;              ///< by slot: of the bounding sphere [m]
  std::vector<double> thin_;                ///< by slot: half the least width of the box around it [m]
  std::vector<double> deepest_;             ///< by slot: overlap of the contacts of free bodies [m]
  Lists of_body_;                           ///< places in groups_
  std::vector<View> views_;                 ///< of one body
  std::vector<Group> groups_;               ///< with a body of flat faces, in the order of the contacts
  std::vector<Candidate> candidates_;       ///< in the order of the contacts
  std::vector<Other> others_;               ///< of the candidates
  std::vector<std::uint8_t> hidden_;        ///< by contact
  std::vector<std::size_t> instead_;        ///< by hidden contact: what holds instead of it
  std::vector<std::uint32_t> surface_;      ///< by group: an earlier one whose wall is of the same surface, or itself
  std::vector<std::uint32_t> ordered_;      ///< groups that share a surface, or have a body of parts
  std::vector<SurfacePoint> points_on_;     ///< of one surface
  std::array<OutlineCorners, 2> outlines_;  ///< of the bodies there
  std::vector<Top> tops_;                   ///< of one surface
};

}  // namespace epafi
