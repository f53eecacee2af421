/// @file sphere_blocks.h  Contacts of spheres among themselves and with fixed planes, laid out for a loop over several
/// at a time. Places (SpherePairs) are cut into blocks, those of balls apart from those of bodies; a block owns the
/// contacts whose lower place it holds and adds their forces to its own spheres; what it finds for those of later
/// blocks it writes down, by block, and those blocks add it in a second pass. The sum of a sphere is that of its
/// planes, then of its partners from the highest place down, whichever blocks they lie in: the bits depend neither on
/// threads, nor on the size of the blocks, nor on which pairs that do not touch are listed.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include "engine/lanes/lanes.h"
#include "engine/state/contacts.h"
#include "engine/state/large_column.h"
#include "engine/state/state_visitor.h"
#include "engine/threads/order_free_sum.h"
#include "engine/threads/parallel.h"
#include "laws/smooth/fused/ball_bodies.h"
#include "laws/smooth/fused/sphere_springs.h"
#include "laws/smooth/fused/sphere_sum.h"

namespace epafi {

/// What a contact adds to the sum of a body of another block: 48 bytes, for a million spheres 7 MB less than sums.
struct SphereRecord {
  double first[4], second[2];  ///< as those of a sum
};

/// A fixed plane.
struct SpherePlane {
  Slot slot = 0;
  std::uint16_t material = 0;
  Vec3 normal = Vec3::UnitZ();  ///< out of the wall
  Vec3 point = Vec3::Zero();
};

/// What the blocks are laid out from.
struct SphereList {
  const SpherePairs& pairs;
  std::vector<SpherePlane> planes;  ///< of pairs.planes
  std::span<const float>
      inverse_half_margin;  ///< as PairList::inverse_half_margin; empty: others move too, or the list has none
  bool others = false;      ///< the scene has other pairs
  std::span<const BodyBall> balls{};  ///< whose places come first
};

/// A place in the loop: where its sum begins, from the first one's [B], and, doubled, its state: the loop over contacts
/// multiplies less.
struct SpherePlace {
  static constexpr std::uint32_t unit = sizeof(SphereSum);
  std::uint32_t offset = 0;
  SpherePlace() = default;
  explicit SpherePlace(Slot s) : offset(unit * s) {}
  Slot slot() const { return offset / unit; }
};
static_assert(sizeof(BodyState) % SpherePlace::unit == 0);

/// Two spheres, a < b, or a sphere and the place of a plane.
struct SpherePlaces {
  SpherePlace a, b;
};

/// Beside a pair in a periodic cell: which image its B is.
struct alignas(32) SphereImage {
  Lanes cells;            ///< from B to the image, -1, 0 or 1, by axis; 0
  std::uint32_t key = 0;  ///< image code of the contact's key
};

class SphereBlocks {
 public:
  static constexpr std::size_t largest_block = 1024;  ///< bodies of a block, unless a smaller one is asked for
  static constexpr std::uint32_t pairs_per_byte = 8;  ///< of `touched`; runs are filled up to so many
  static constexpr std::uint32_t pairs_ahead = 24;    ///< the loop asks for bodies so far ahead: as many pairs stand
                                                      ///< behind the last one
  static constexpr std::size_t most_bodies = std::size_t{0xffffffffu} / SpherePlace::unit - largest_block;

  /// Pairs of one plane, inside a block or across blocks: [begin, end) of the block's, begin a multiple of eight,
  /// sorted by (block of b, a, b, key), the largest first.
  struct Run {
    std::uint32_t begin = 0, end = 0;
    std::int32_t plane = -1;
    bool across = false;
  };

  /// What a block finds for a later one: its records from those of the target before on.
  struct Target {
    Slot block = 0;
    std::uint32_t pairs_end = 0;  ///< in the run across blocks
    std::uint32_t records_end = 0;
  };

  struct Block {
    explicit Block(const SphereNeeds& needs) : springs(needs) {}
    std::vector<Run> runs;                ///< planes in order, then across blocks, then inside the block
    UnwrittenColumn<SpherePlaces> pairs;  ///< every run filled up to whole eights, `pairs_ahead` more behind the last,
                                          ///< with pairs of the state that is nowhere
    UnwrittenColumn<SphereImage> images;  ///< by pair, in a periodic cell; else empty
    std::vector<std::uint8_t> touched;    ///< by eight pairs: those that touched at the last call, one bit each
    SphereSprings springs;                ///< of those, with friction
    std::uint32_t size = 0;               ///< pairs, whole eights
    std::vector<Target> targets;          ///< descending, one behind the last
    std::vector<Slot> sources;            ///< blocks that have this one among their targets, ascending
    std::vector<std::uint32_t> waits;     ///< those of them that are of balls or of bodies as it is, from its first on
    /// Of contacts across blocks that touch, in their order: forces on B, its place, and with rolling moments [N m].
    UnwrittenColumn<SphereRecord> records;
    UnwrittenColumn<SpherePlace> record_places;
    UnwrittenColumn<Lanes> record_moments;
    double elastic = 0.0;                ///< stored in the contacts when somebody looked last [J]
    double slipped = 0.0;                ///< lost by slip in the step [J]
    double viscous = 0.0;                ///< power lost in the dampers [W]
    double lost = 0.0;                   ///< to plastic deformation or adhesion in the step [J]
    std::array<OrderFreeSum, 3> virial;  ///< force on A times branch, by axis [N m]; in a periodic cell only
    std::size_t touching = 0;            ///< of those listed; none that another process counts or that has broken
    double deepest = 0.0, deepest_relative = 0.0;  ///< overlap [m], over the smaller radius
    void grow_records(std::size_t size, bool rolls);
    /// Pairs that each_touching() goes through.
    std::size_t listed() const {
      std::size_t sum = 0;
      for (const std::uint8_t eight : touched) sum += static_cast<std::size_t>(std::popcount(eight));
      return sum;
    }
    void set_touching(std::uint32_t k) {
      touched[k / pairs_per_byte] |= static_cast<std::uint8_t>(1u << (k % pairs_per_byte));
    }
  };

  /// block_size: a multiple of four, at most largest_block.
  explicit SphereBlocks(SphereNeeds needs, std::size_t block_size = largest_block)
      : needs_(needs), block_size_(block_size) {}
  std::size_t block_size() const { return block_size_; }

  /// Lays out the pairs anew, each block in its own room; springs of contacts that go on are kept.
  void rebuild(const World& world, const SphereList& list);
  /// Records go until the next step.
  /// Bodies went to other slots: springs follow, the layout waits for the next rebuild.
  void reorder(const Reordering& change);
  void visit(StateVisitor& visitor);

  /// Adds what other blocks found for the bodies of block i to the sums of its accumulator.
  void receive(std::size_t i, std::size_t accumulator);
  /// What of the bodies' states is ours and stays, and which bodies are plain; radius: of free spheres, of the bodies
  /// from slot `first` on [m].
  void set_constants(World& world, std::span<const double> radius, std::size_t first = 0);
  /// Bodies that came since the last layout, behind the others: as those without contacts until the next one.
  void welcome(const World& world);
  /// Bodies of the last layout, or welcome since.
  std::size_t bodies() const { return bodies_; }
  BallBodies& balls() { return balls_; }
  const BallBodies& balls() const { return balls_; }
  /// Balls that have not been placed have pairs since the last layout; says it once.
  bool take_new_balls() { return std::exchange(has_new_balls_, false); }
  /// The first blocks are of balls.
  std::size_t ball_blocks() const { return blocks_of(balls_.size()); }
  /// Of the places of a block.
  std::size_t begin_of(std::size_t block) const {
    const std::size_t before = ball_blocks();
    return block < before ? block * block_size_ : balls_.size() + (block - before) * block_size_;
  }
  std::size_t end_of(std::size_t block) const {
    const std::size_t all = block < ball_blocks() ? balls_.size() : balls_.size() + bodies_;
    return std::min(begin_of(block) + block_size_, all);
  }

  /// f(run, pair, rank) for all pairs of a block that touched at the last call, in the order of the layout; rank: its
  /// number among those.
  template <class F>
  static void each_touching(const Block& block, const F& f) {
    std::uint32_t rank = 0;
    for (const Run& run : block.runs)
      for (std::uint32_t k = run.begin; k < run.end; k += pairs_per_byte)
        for (unsigned bits = block.touched[k / pairs_per_byte]; bits != 0; bits &= bits - 1u)
          f(run, k + static_cast<std::uint32_t>(std::countr_zero(bits)), rank++);
  }

  /// In which the blocks are best gone through by the threads at hand; empty: ascending.
  std::span<const std::uint32_t> order() const { return order_; }
  std::vector<Block>& blocks() { return blocks_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<SpherePlane>& planes() const { return planes_; }
  /// By four bodies: laws/smooth/fused/body_pass.h may take them together.
  const std::uint8_t* plain() const { return plain_.data(); }
  /// How many sums of a block there are at once.
  void set_accumulators(std::size_t accumulators);
  /// Of the first place of the block that has this accumulator, and one behind the last that nobody reads; all zero
  /// before its first contact.
  SphereSum* sums(std::size_t accumulator) { return sums_.data() + accumulator * (block_size_ + 1); }
  void clear_accumulator(std::size_t accumulator);
  /// Spin at the time of the detection, by place [rad/s]; null without rolling, as the next ones.
  Lanes* late_spins() { return late_spins_.empty() ? nullptr : late_spins_.data(); }
  /// By slot.
  Lanes* late_spins_of_bodies() { return late_spins_.empty() ? nullptr : late_spins_.data() + balls_.size(); }
  /// Moments against rolling beside the sums [N m].
  Lanes* moments(std::size_t accumulator) {
    return moments_.empty() ? nullptr : moments_.data() + accumulator * block_size_;
  }
  std::size_t pairs() const { return pairs_; }
  /// False where springs wait for a rebuild: at the start, after a reordering, after a state was saved or loaded.
  bool laid_out() const { return laid_out_; }

 private:
  /// A spring by the slots of its bodies, of a plane b, or by their places while it goes into a layout.
  struct Kept {
    static constexpr std::uint32_t of_plane = 1u << 31, image = 0xffu;
    Slot a, b;
    std::uint32_t key;   ///< image code of the contact's key, parts of A and B in the next bytes, and of_plane
    std::uint32_t more;  ///< place of what else is remembered of it
    double load[4];
  };
  using Load = std::array<double, 4>;
  struct KeptSprings {
    UnwrittenColumn<Kept> springs;
    // one for each spring that ever was there, where it is needed
    UnwrittenColumn<Load> rolling;
    UnwrittenColumn<double> normal;
    UnwrittenColumn<PackedBristles> bristles;
    template <class F>
    void each_more(const SphereNeeds& needs, const F& f) {
      if (needs.rolling) f(rolling, "spheres/rolling");
      if (needs.normal) f(normal, "spheres/normal");
      if (needs.bristles) f(bristles, "spheres/bristles");
    }
  };
  Kept kept_of(const Block& block, const Run& run, std::uint32_t k, std::uint32_t rank,
               const std::vector<SpherePlane>& planes) const;
  void turn_round(Kept& kept);
  void name_places();
  std::size_t blocks_of(std::size_t places) const { return (places + block_size_ - 1) / block_size_; }
  std::size_t block_of(Slot place) const {
    const std::size_t balls = balls_.size();
    return place < balls ? place / block_size_ : ball_blocks() + (place - balls) / block_size_;
  }
  Slot place_of_body(Slot s) const { return static_cast<Slot>(balls_.size()) + s; }
  void group_kept(std::size_t count);
  bool keeps_rows(std::size_t index, std::size_t end, const SpherePairs& pairs) const;
  void see_rows(const SpherePairs& pairs, bool grown);
  void lay_out(Block& block, Slot index, const SpherePairs& pairs);
  void restore(Block& block, Slot first, std::span<const Kept> kept);
  std::size_t run_of(Slot b, std::size_t end) const;
  void make_runs(Block& block, std::size_t end, std::span<const Slot> partners,
                 std::vector<std::uint32_t>& place) const;
  void fill_up(Block& block) const;
  void fill_pairs(Block& block) const;
  void list_sources();
  /// Of a block or a const one: among its targets.
  template <class B>
  static auto target_of(B& block, std::size_t to) {
    return std::ranges::find(block.targets, static_cast<Slot>(to), &Target::block);
  }
  void take_out(const std::vector<SpherePlane>& planes);

  SphereNeeds needs_;
  std::size_t block_size_;
  BallBodies balls_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> order_;
  std::vector<SpherePlane> planes_;
  UnwrittenColumn<SphereSum> sums_;
  LargeColumn<Lanes> late_spins_;
  UnwrittenColumn<Lanes> moments_;
  std::vector<std::uint8_t> is_clear_;  ///< by accumulator: its sums are zero
  std::vector<std::uint8_t> plain_;
  KeptSprings kept_;                       ///< while the layout waits
  std::vector<std::uint32_t> kept_begin_;  ///< by block, once they are grouped
  bool has_new_balls_ = false;
  bool laid_out_ = false, grouped_ = false;  ///< kept_ is in the order of the blocks
  bool kept_of_balls_ = false;               ///< some of them are, so that the lower place may be that of B
  std::size_t pairs_ = 0, bodies_ = 0;
  std::size_t laid_bodies_ = 0;  ///< of the last layout
  SpherePairs rows_;             ///< the list it was made from, where bodies have come; else empty
};

}  // namespace epafi
