/// @file sphere_blocks.h  Contacts of spheres with each other and with fixed planes, in a layout for SIMD loops. Places
/// (SpherePairs) are divided into blocks, separately for balls and bodies. A block owns the contacts whose lower place
/// it holds and adds their forces to its own spheres; forces on spheres of later blocks go to records, which those
/// blocks add in a second pass. A sphere sums its planes, then its partners from the highest place down, in any block:
/// the bits depend neither on threads, nor on the block size, nor on listed pairs that do not touch.
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

/// Contribution of a contact to the sum of a body of another block: 48 bytes, for a million spheres 7 MB less than
/// sums.
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

/// Input of the layout.
struct SphereList {
  const SpherePairs& pairs;
  std::vector<SpherePlane> planes;  ///< of pairs.planes
  std::span<const float>
      inverse_half_margin;  ///< as PairList::inverse_half_margin; empty: others move too, or the list has none
  bool others = false;      ///< the scene has other pairs
  std::span<const BodyBall> balls{};  ///< whose places come first
};

/// A place in the loop, as the byte offset of its sum; twice the offset is that of its state. This saves
/// multiplications in the loop over contacts.
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

/// Image of B of a pair in a periodic cell.
struct alignas(32) SphereImage {
  Lanes cells;            ///< from B to the image, -1, 0 or 1, by axis; 0
  std::uint32_t key = 0;  ///< image code of the contact's key
};

class SphereBlocks {
 public:
  static constexpr std::size_t largest_block = 1024;  ///< bodies of a block, unless a smaller one is asked for
  static constexpr std::uint32_t pairs_per_byte = 8;  ///< bits of `touched`; runs are padded to a multiple
  static constexpr std::uint32_t pairs_ahead = 24;    ///< prefetch distance; as many pairs follow the last one
  static constexpr std::size_t most_bodies = std::size_t{0xffffffffu} / SpherePlace::unit - largest_block;

  /// Pairs of one plane, inside a block or across blocks: [begin, end) of the block's, begin a multiple of eight,
  /// sorted by (block of b, a, b, key), the largest first.
  struct Run {
    std::uint32_t begin = 0, end = 0;
    std::int32_t plane = -1;
    bool across = false;
  };

  /// Records of a block for a later one; they follow those of the previous target.
  struct Target {
    Slot block = 0;
    std::uint32_t pairs_end = 0;  ///< in the run across blocks
    std::uint32_t records_end = 0;
  };

  struct Block {
    explicit Block(const SphereNeeds& needs) : springs(needs) {}
    std::vector<Run> runs;                ///< planes in order, then across blocks, then inside the block
    UnwrittenColumn<SpherePlaces> pairs;  ///< runs padded to multiples of eight and by `pairs_ahead`, with NaN states
    UnwrittenColumn<SphereImage> images;  ///< by pair, in a periodic cell; else empty
    std::vector<std::uint8_t> touched;    ///< by eight pairs: those that touched at the last call, one bit each
    SphereSprings springs;                ///< springs of touching pairs, with friction
    std::uint32_t size = 0;               ///< pairs, whole eights
    std::vector<Target> targets;          ///< descending, one behind the last
    std::vector<Slot> sources;            ///< blocks that have this one among their targets, ascending
    std::vector<std::uint32_t> waits;     ///< sources of the same kind (balls or bodies), numbered from its first block
    /// Touching contacts across blocks, in order: forces on B, its place, and with rolling moments [N m].
    UnwrittenColumn<SphereRecord> records;
    UnwrittenColumn<SpherePlace> record_places;
    UnwrittenColumn<Lanes> record_moments;
    double elastic = 0.0;                ///< elastic energy of the contacts at the last measurement [J]
    double slipped = 0.0;                ///< lost by slip in the step [J]
    double viscous = 0.0;                ///< power lost in the dampers [W]
    double late = 0.0;                   ///< as DashpotLoss::late [J]
    double lost = 0.0;                   ///< to plastic deformation or adhesion in the step [J]
    std::array<OrderFreeSum, 3> virial;  ///< force on A times branch, by axis [N m]; in a periodic cell only
    std::size_t touching = 0;  ///< number of touching contacts, without those of other processes or broken ones
    double deepest = 0.0, deepest_relative = 0.0;  ///< overlap [m], over the smaller radius
    void grow_records(std::size_t size, bool rolls);
    /// Number of pairs of each_touching().
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

  /// Lays out the pairs anew; springs of continuing contacts are kept.
  void rebuild(const World& world, const SphereList& list);
  /// Bodies have new slots: springs are renumbered; the layout is invalid until the next rebuild.
  void reorder(const Reordering& change);
  void visit(StateVisitor& visitor);

  /// Adds records of other blocks for the bodies of block i to the sums of its accumulator.
  void receive(std::size_t i, std::size_t accumulator);
  /// Sets the constant members of body states that belong to this model, and the plain bodies. radius: of free spheres,
  /// from slot `first` on [m].
  void set_constants(World& world, std::span<const double> radius, std::size_t first = 0);
  /// Adds bodies that entered since the last layout, after the others, without contacts until the next one.
  void welcome(const World& world);
  /// Number of bodies of the last layout and of those added since.
  std::size_t bodies() const { return bodies_; }
  BallBodies& balls() { return balls_; }
  const BallBodies& balls() const { return balls_; }
  /// True once after a layout with pairs of balls that were not placed before.
  bool take_new_balls() { return std::exchange(has_new_balls_, false); }
  /// Number of blocks of balls, which come first.
  std::size_t ball_blocks() const { return blocks_of(balls_.size()); }
  /// First place of a block.
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

  /// Best order of the blocks for the present threads; empty: ascending.
  std::span<const std::uint32_t> order() const { return order_; }
  std::vector<Block>& blocks() { return blocks_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<SpherePlane>& planes() const { return planes_; }
  /// By four bodies: not 0 where laws/smooth/fused/body_pass.h may process them together, since all are free and of
  /// equal moments; plain_elsewhere: their owners, other processes, tell how they go on.
  static constexpr std::uint8_t plain_elsewhere = 2;
  const std::uint8_t* plain() const { return plain_.data(); }
  /// Sets the number of accumulators (sums of a block) in use at once.
  void set_accumulators(std::size_t accumulators);
  /// Sums of the block that uses this accumulator, by place, and one more that is never read; zero before its first
  /// contact.
  SphereSum* sums(std::size_t accumulator) { return sums_.data() + accumulator * (block_size_ + 1); }
  void clear_accumulator(std::size_t accumulator);
  /// Spin at the time of the detection, by place [rad/s]; null without rolling, as the next ones.
  Lanes* late_spins() { return late_spins_.empty() ? nullptr : late_spins_.data(); }
  /// By slot.
  Lanes* late_spins_of_bodies() { return late_spins_.empty() ? nullptr : late_spins_.data() + balls_.size(); }
  /// Rolling moments, by place like the sums [N m].
  Lanes* moments(std::size_t accumulator) {
    return moments_.empty() ? nullptr : moments_.data() + accumulator * block_size_;
  }
  std::size_t pairs() const { return pairs_; }
  /// False if springs wait for a rebuild: at the start, after a reordering, after a state was saved or loaded.
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
    UnwrittenColumn<double> normal, push;
    UnwrittenColumn<PackedBristles> bristles;
    template <class F>
    void each_more(const SphereNeeds& needs, const F& f) {
      if (needs.rolling) f(rolling, "spheres/rolling");
      if (needs.normal) f(normal, "spheres/normal");
      if (needs.push) f(push, "spheres/push");
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
  /// Iterator to target `to` among the targets of a block; end() where there is none.
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
