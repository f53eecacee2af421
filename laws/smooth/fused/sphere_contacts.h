/// @file sphere_contacts.h  What the blocks know of contacts as the generic path would have it: their geometry, and all
/// that touch, in canonical order among the contacts of others.
#pragma once
#include <functional>

#include "laws/smooth/fused/sphere_blocks.h"

namespace epafi {

/// A contact of a block.
struct SphereContact {
  std::uint32_t block = 0;
  std::uint32_t pair = 0;   ///< among those of the block
  std::uint32_t rank = 0;   ///< among those of the block that touch
  std::int32_t plane = -1;  ///< as SphereBlocks::Run::plane
};

/// On the lower slot.
struct SphereLoad {
  Vec3 force;   ///< [N]
  Vec3 moment;  ///< [N m]
};

class SphereContacts {
 public:
  SphereContacts(const World& world, const SphereBlocks& blocks) : world_(world), blocks_(blocks) {}

  /// f(contact) for all of a block that touch, in the order of the layout.
  template <class F>
  void each(std::uint32_t block, const F& f) const {
    SphereBlocks::each_touching(blocks_.blocks()[block],
                                [&](const SphereBlocks::Run& run, std::uint32_t pair, std::uint32_t rank) {
                                  f(SphereContact{block, pair, rank, run.plane});
                                });
  }
  /// The body whose slot is lower, or the sphere at a plane.
  Slot first(const SphereContact& c) const { return places(c).a.slot(); }
  /// The other body, or that of the plane.
  Slot second(const SphereContact& c) const { return places(c).b.slot(); }
  double gap(const SphereContact& c) const;  ///< [m]
  /// Gap, normal, arm and radius, from the first body to the second.
  ContactPoint point(const SphereContact& c) const;
  /// Image code from the first body to the second.
  std::uint32_t image(const SphereContact& c) const;

 private:
  const SpherePlaces& places(const SphereContact& c) const { return blocks_.blocks()[c.block].pairs[c.pair]; }
  const SpherePlane& plane(const SphereContact& c) const { return blocks_.planes()[static_cast<std::size_t>(c.plane)]; }
  double radius(Slot s) const { return world_.states()[s].position[3]; }
  Vec3 branch(const SphereContact& c) const;

  const World& world_;
  const SphereBlocks& blocks_;
};

/// Adds the contacts of blocks to a set that has those of others. Each goes to its place at once, and all threads do
/// it: appended and sorted column by column, those of 100 000 spheres took one thread 0.18 s of a frame of 0.3, much of
/// it for new pages; 0.03 now.
class SpherePublisher {
 public:
  /// Of a contact with this normal.
  using LoadOf = std::function<SphereLoad(const SphereContact&, const Vec3& normal)>;
  void add(const World& world, const SphereBlocks& blocks, const LoadOf& load, ContactSet& contacts);
  /// The next set is made from the beginning.
  void let_go() { *this = {}; }

 private:
  struct Item {
    Feature feature;
    Slot b;
    SphereContact contact;
  };
  void order(const World& world, const SphereBlocks& blocks, const ContactSet& others);

  std::vector<std::uint32_t> begin_;  ///< by slot of A
  UnwrittenColumn<Item> items_;
};

}  // namespace epafi
