/// @file sphere_blocks.h  Contacts of free spheres among themselves and with fixed planes, laid out for a loop over
/// four at a time. Slots are cut into blocks of 1024; a block owns the contacts whose lower slot it holds and adds
/// their forces to its own bodies; what it finds for bodies of later blocks it writes down, and those blocks add it in
/// a second pass. The order of every sum is that of the slots, so the bits depend neither on threads nor on which pairs
/// that do not touch are listed.
#pragma once
#include <span>

#include "engine/contacts.h"
#include "engine/lanes.h"
#include "engine/state_visitor.h"

namespace epafi {

/// What the loop reads of a body: 128 bytes, two cache lines.
struct alignas(32) SphereState {
  Lanes position, velocity, spin,
      predicted;  ///< x y z, fourth unused; predicted: velocity at the time of the detection
};
/// What it writes: force and, in its fourth, the energy stored in the contacts the body owns; torque and what their
/// springs lost.
struct alignas(32) SphereSum {
  Lanes force, torque;
};

/// Force on A times branch, by axis, of the contacts a body owns [N m].
struct alignas(32) SphereVirial {
  Lanes sum;
};

/// A fixed plane.
struct SpherePlane {
  Slot slot = 0;
  Vec3 normal = Vec3::UnitZ();  ///< out of the wall
  Vec3 point = Vec3::Zero();
};

/// A pair for the fused loop; `plane` >= 0: b is planes[plane] and a the sphere.
struct SpherePair {
  Slot a, b;
  std::int32_t plane = -1;
  std::uint32_t image = 0;  ///< as Pair::image; 0 with planes, which repeat in themselves
};

/// Four contacts. Of a padding lane radius_sum is -1, so that it never touches.
struct alignas(32) SphereGroup {
  Lanes share;                   ///< of the line of centres that belongs to A; 1 for planes
  Lanes radius_sum;              ///< [m]
  Lanes radius, mass;            ///< effective [m], [kg]
  Lanes load_x, load_y, load_z;  ///< friction on A [N]
  Lanes stiffness;               ///< of the friction spring [N/m], 0: not loaded
  Lanes energy;                  ///< of the friction spring [J]
  Lanes viscous;                 ///< power lost in the damper [W]
  Lanes normal_force;            ///< [N]; < 0: does not touch
  Slot a[lane_count], b[lane_count];
  std::int32_t plane = -1;   ///< all four against this plane
  std::uint32_t record = 0;  ///< first of four places in `records`, for groups between blocks
  bool loaded = false;       ///< some lane touched in the last step
};

/// Beside a group in a periodic cell: which images its B are.
struct alignas(32) SphereImages {
  Lanes x, y, z;                      ///< cells from B to the image, -1, 0 or 1
  std::uint32_t key[lane_count] = {};  ///< image code of the contact's key
};

class SphereBlocks {
 public:
  static constexpr std::size_t block_size = 1024;

  struct Block {
    std::vector<SphereGroup> groups;     ///< planes, then inside the block, then across blocks
    std::vector<SphereImages> images;    ///< by group, in a periodic cell only
    std::size_t inside = 0, across = 0;  ///< where the second and third kind begin
    std::vector<std::pair<std::uint32_t, Slot>>
        incoming;  ///< records for bodies of this block, in the order of their owners
    double stored = 0.0, frictional = 0.0, viscous = 0.0;  ///< energy in contacts, lost by slip, by dampers [J]
    Vec3 virial = Vec3::Zero();  ///< force on A times branch, by axis [N m]; in a periodic cell only
    std::size_t touching = 0;
  };

  /// Lays out the pairs anew; springs of contacts that go on are kept. radius: by slot.
  void rebuild(const World& world, std::span<const SpherePair> pairs, std::vector<SpherePlane> planes,
               std::span<const double> radius);
  /// Bodies went to other slots: springs follow, the layout waits for the next rebuild.
  void reorder(const Reordering& change);
  void visit(StateVisitor& visitor);

  /// Reads the bodies, with velocities `lag` later.
  void pack(const World& world, double lag);
  /// Adds what other blocks found for a block's bodies, and writes force and torque (added where `add`).
  void unpack(World& world, bool add);
  /// Appends the contacts that touch, as the generic path would have them.
  void publish(const World& world, ContactSet& contacts) const;

  std::vector<Block>& blocks() { return blocks_; }
  const std::vector<SpherePlane>& planes() const { return planes_; }
  std::span<const SphereState> states() const { return states_; }
  std::span<SphereSum> sums() { return sums_; }
  std::span<SphereSum> records() { return records_; }
  /// By slot; in a periodic cell only.
  std::span<SphereVirial> virials() { return virials_; }
  /// By slot.
  std::span<double> viscous() { return viscous_; }
  std::size_t pairs() const { return pairs_; }
  /// False where springs wait for a rebuild: at the start, after a reordering, after a state was saved or loaded.
  bool laid_out() const { return laid_out_; }

 private:
  /// A spring by the slots of its bodies, a < b, and the image code of its key; of a plane b is its slot.
  struct Kept {
    Slot a, b;
    std::uint32_t key;
    double load[3], stiffness, energy, viscous, normal_force;
  };
  std::vector<Kept> springs() const;
  void restore(std::vector<Kept>& kept, std::size_t slots);
  void place(const World& world, std::span<const SpherePair> pairs, std::span<const double> radius);
  void fill_block(const World& world, std::span<SpherePair> pairs, Slot index, std::span<const double> radius);
  /// Sorts by the first slot, keeping the order among equals; first_[s] is then where those of slot s begin.
  template <class T>
  void by_first_slot(std::vector<T>& list, std::size_t slots);

  std::vector<Block> blocks_;
  std::vector<SpherePlane> planes_;
  std::vector<SphereState> states_;
  std::vector<SphereSum> sums_, records_;
  std::vector<SphereVirial> virials_;
  std::vector<double> viscous_;
  std::vector<SpherePair> sorted_;
  std::vector<Slot> first_;
  std::vector<Kept> kept_;  ///< springs while the layout waits
  bool laid_out_ = false;
  std::size_t pairs_ = 0;
};

}  // namespace epafi
