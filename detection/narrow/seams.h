/// @file seams.h  Walls that touch act as one surface: contacts that only one of them would give are taken out.
/// Where walls (fixed or driven bodies) share a point p, a normal n of one of them is a normal of their union only if
/// no other goes on beyond the plane through p: the normal cone of a union is the intersection of the normal cones
/// (Rockafellar and Wets 1998, section 6). So the edge of the second of two level tiles does not stop a body that
/// slides over it, while a ridge of two roofs holds it. A contact goes only where the neighbour holds the body by a
/// normal of the union at that point: in the corner of floor and wall, which has none, both stand. Of two walls with
/// the same normal at the same point the one of lower id keeps the contact. In a periodic cell a wall that is as wide
/// as the cell touches its own images. The convex parts of a solid, free or fixed, are one surface in the same way.
/// Limits: free bodies are not joined to others; of closed meshes only the surface counts, not what it encloses; what a
/// contact remembers (friction, plastic history) ends with its wall.
#pragma once
#include <span>
#include <vector>

#include "detection/narrow/on_surface.h"
#include "engine/state/contacts.h"

namespace epafi {

class Seams {
 public:
  /// Level or touching: within this share of the size of the body that feels the seam. Contact points of round bodies
  /// are known to 1e-6 of it (a depth certified to 1e-12).
  static constexpr double tolerance = 1e-5;

  /// `shapes` must outlive this.
  explicit Seams(const ShapeStore& shapes) : shapes_(shapes) {}

  /// Finds the walls with flat faces whose boxes touch; whenever slots have other bodies.
  void find(const World& world);
  /// Takes out what is no contact of the union; the others keep their order. Of contacts as the narrow phase joins
  /// them: without forces and areas.
  void hide(const World& world, ContactSet& contacts);

 private:
  /// A wall or an image of one, the same wall's too, whose box touches.
  struct Neighbour {
    Slot slot;
    BodyId id;
    Vec3 shift;  ///< of the image [m]; zero: the wall itself
    Aabb box;
  };
  struct Wall {
    Slot slot;
    std::vector<Neighbour> neighbours;
  };
  /// A contact at which a neighbour, or another part of the same solid, may go on.
  struct Candidate {
    std::size_t contact;
    bool wall_is_b;
    Slot wall, body;
    BodyId id;                   ///< of the wall
    WallPiece piece;             ///< of the wall, or its part
    Vec3 point = Vec3::Zero();   ///< on the wall where it is itself, not at an image
    Vec3 normal = Vec3::Zero();  ///< out of it
    double near = 0.0;           ///< [m]: closer is touching
    bool on_wall = false;        ///< the point is; else nothing is known
  };

  /// A neighbour, or another part of the same solid.
  struct Other {
    Slot wall;
    BodyId id;
    WallPiece piece;  ///< where it is, with its shift
    Vec3 shift;
  };

  std::vector<Neighbour> walls_and_images(const World& world) const;
  void find_neighbours(const World& world);
  std::span<const Neighbour> neighbours_of(Slot s) const;
  void follow(const World& world);
  void consider(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b);
  Candidate candidate(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) const;
  WallPiece piece_at(const Candidate& c, const Vec3& point) const;
  bool is_given_before(const ContactSet& contacts, const Candidate& c) const;
  bool has_other_near(const Candidate& c) const;
  bool is_hidden(const World& world, const ContactSet& contacts, const Candidate& c) const;
  bool holds_instead(const World& world, const ContactSet& contacts, const Candidate& c, const Other& other) const;
  static bool comes_first(const Candidate& c, const Other& other);
  static Vec3 centre_of_body(const World& world, const ContactSet& contacts, const Candidate& c);
  void decide_faces(const World& world, ContactSet& contacts);

  const ShapeStore& shapes_;
  std::vector<Wall> walls_;                  ///< ascending slots
  bool moved_ = false;                       ///< some wall, since: boxes and neighbours are those of the step
  std::vector<std::uint32_t> wall_of_slot_;  ///< place in walls_, or no_wall; empty without walls
  bool solids_ = false;                      ///< some shape has parts
  bool touching_ = false;                    ///< some wall has a neighbour
  std::vector<Candidate> candidates_;        ///< in the order of the contacts
  std::vector<std::uint8_t> hidden_;         ///< by contact
};

}  // namespace epafi
