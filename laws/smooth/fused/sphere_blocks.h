/// @file sphere_blocks.h  Contacts of free spheres among themselves and with fixed planes, laid out for a loop over
/// several at a time. Slots are cut into blocks of 1024; a block owns the contacts whose lower slot it holds and adds
/// their forces to its own bodies; what it finds for bodies of later blocks it writes down, and those blocks add it in
/// a second pass. The order of every sum is that of the slots, so the bits depend neither on threads nor on which pairs
/// that do not touch are listed.
#pragma once
#include <span>

#include "engine/contacts.h"
#include "engine/lanes.h"
#include "engine/state_visitor.h"

namespace epafi {

/// What the loop reads of a body: 128 bytes, two cache lines. The fourth numbers stay from one layout to the next.
struct alignas(64) SphereState {
  Lanes position;   ///< x y z [m], radius [m]
  Lanes velocity;   ///< x y z [m/s], 1/mass [1/kg]
  Lanes spin;       ///< x y z [rad/s], radius [m]
  Lanes predicted;  ///< velocity at the time of the detection [m/s], 1/moment of inertia [1/(kg m^2)]
};
/// What it writes. The torque over the radius: both bodies of a contact feel the same one.
struct alignas(64) SphereSum {
  Lanes force, pull;  ///< x y z [N], unused
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

/// Where a body's sum begins, from the first one's [B], and, doubled, its state: the loop over contacts multiplies
/// less.
struct SpherePlace {
  static constexpr std::uint32_t unit = sizeof(SphereSum);
  std::uint32_t offset = 0;
  SpherePlace() = default;
  explicit SpherePlace(Slot s) : offset(unit * s) {}
  Slot slot() const { return offset / unit; }
};
static_assert(sizeof(SphereState) % SpherePlace::unit == 0);

/// Two spheres, a < b, or a sphere and the slot of a plane.
struct SpherePlaces {
  SpherePlace a, b;
};

/// The friction spring of a contact: 32 bytes.
struct alignas(32) SphereSpring {
  Lanes load;  ///< x y z on A [N], 1/stiffness [m/N]; 0: not loaded
};

/// Beside a pair in a periodic cell: which image its B is.
struct alignas(32) SphereImage {
  Lanes cells;            ///< from B to the image, -1, 0 or 1, by axis; 0
  std::uint32_t key = 0;  ///< image code of the contact's key
};

/// The same pair seen from B: both codes, of Pair::image, turn their sign.
std::uint32_t opposite_image(std::uint32_t image);

class SphereBlocks {
 public:
  static constexpr std::size_t block_size = 1024;
  static constexpr std::uint32_t pairs_per_byte = 8;  ///< of `touched`; runs are filled up to so many
  static constexpr std::uint32_t pairs_ahead = 24;    ///< the loop asks for bodies so far ahead: as many pairs stand
                                                    ///< behind the last one
  static constexpr std::size_t most_bodies = std::size_t{0xffffffffu} / SpherePlace::unit;

  /// Pairs of one plane, inside a block or across blocks: [begin, end), begin a multiple of eight, sorted by (a, b,
  /// key).
  struct Run {
    std::uint32_t begin = 0, end = 0;
    std::int32_t plane = -1;
    bool across = false;
  };

  struct Block {
    std::vector<Run> runs;              ///< planes in order, then inside the block, then across blocks
    std::vector<SpherePlaces> pairs;    ///< every run filled up to whole eights with copies of its last one
    std::vector<SphereSpring> springs;  ///< by pair, where there is friction
    std::vector<SphereImage> images;    ///< by pair, in a periodic cell
    std::vector<std::uint8_t> touched;  ///< by eight pairs: those that touched at the last call, one bit each
    std::uint32_t record = 0;           ///< of the first pair across blocks in `records`
    std::vector<std::pair<std::uint32_t, Slot>>
        incoming;                ///< records for bodies of this block, in the order of their owners
    double elastic = 0.0;        ///< stored in the contacts [J]
    double slipped = 0.0;        ///< lost by slip in the step [J]
    double viscous = 0.0;        ///< power lost in the dampers [W]
    Vec3 virial = Vec3::Zero();  ///< force on A times branch, by axis [N m]; in a periodic cell only
    std::size_t touching = 0;
  };

  /// Lays out the pairs anew; springs of contacts that go on are kept. radius: by slot.
  void rebuild(const World& world, std::vector<SpherePair> pairs, std::vector<SpherePlane> planes,
               std::span<const double> radius, bool friction);
  /// Bodies went to other slots: springs follow, the layout waits for the next rebuild.
  void reorder(const Reordering& change);
  void visit(StateVisitor& visitor);

  /// Adds what other blocks found for the bodies of block i.
  void receive(std::size_t i);
  /// Whether there is room for that many bodies.
  bool holds(std::size_t bodies) const { return states_.size() == bodies; }

  /// f(block, run, pair) for all pairs that touched at the last call, in the order of the layout.
  template <class F>
  void each_touching(const F& f) const {
    for (const Block& block : blocks_)
      for (const Run& run : block.runs)
        for (std::uint32_t k = run.begin; k < run.end; ++k)
          if (block.touched[k / pairs_per_byte] >> (k % pairs_per_byte) & 1u) f(block, run, k);
  }

  std::vector<Block>& blocks() { return blocks_; }
  const std::vector<SpherePlane>& planes() const { return planes_; }
  std::span<const SphereState> states() const { return states_; }
  std::span<SphereState> states() { return states_; }
  /// By four bodies: laws/smooth/fused/body_pass.h may take them together.
  const std::uint8_t* plain() const { return plain_.data(); }
  /// shared: blocks take turns, one after the other, so that their sums stay in cache.
  void set_sums(bool shared) {
    sums_step_ = shared ? 0 : block_size;
    sums_.resize(shared ? block_size : states_.size());  // all are zero between two calls
  }
  /// Of the first slot of block i.
  SphereSum* sums(std::size_t i) { return sums_.data() + i * sums_step_; }
  std::span<SphereSum> records() { return records_; }
  std::size_t pairs() const { return pairs_; }
  /// False where springs wait for a rebuild: at the start, after a reordering, after a state was saved or loaded.
  bool laid_out() const { return laid_out_; }

 private:
  /// A spring by the slots of its bodies, a < b, and the image code of its key; of a plane b is its slot.
  struct Kept {
    Slot a, b;
    std::uint32_t key;
    double load[4];
  };
  std::vector<Kept> springs() const;
  void restore(std::vector<Kept>& kept, std::size_t slots);
  void place(const World& world, std::vector<SpherePair> pairs, std::span<const double> radius, bool friction);
  void fill_block(std::span<SpherePair> pairs, Slot index, bool friction, bool periodic);
  void address_records();
  /// Sorts by the first slot, keeping the order among equals; first_[s] is then where those of slot s begin.
  template <class T>
  void by_first_slot(std::vector<T>& list, std::size_t slots);

  std::vector<Block> blocks_;
  std::vector<SpherePlane> planes_;
  std::vector<SphereState> states_;
  std::vector<SphereSum> sums_, records_;
  std::size_t sums_step_ = 0;  ///< from block to block
  std::vector<std::uint8_t> plain_;
  std::vector<Slot> first_;
  std::vector<Kept> kept_;  ///< springs while the layout waits
  bool laid_out_ = false;
  std::size_t pairs_ = 0;
};

}  // namespace epafi
