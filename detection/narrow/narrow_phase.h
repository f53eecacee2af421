/// @file narrow_phase.h  Narrow phase: finds contacts in blocks of consecutive pairs, sorted by kinds of shapes, and
/// joins them in order. Each block keeps its contact set from step to step, so a settled scene allocates nothing; bits
/// and order of contacts are the same for every thread count.
#pragma once
#include "detection/narrow/pairs/pair_table.h"
#include "engine/step/pipeline.h"

namespace epafi {

class Seams;

class BatchNarrowPhase : public NarrowPhase {
 public:
  /// reach: contacts with gap < reach are reported [m], >= 0. curvature: effective_radius is filled. `shapes` must
  /// outlive this.
  /// area: pairs of polyhedra give the cells of their overlap volume.
  BatchNarrowPhase(const ShapeStore& shapes, double reach, bool curvature, bool area = false);
  ~BatchNarrowPhase() override;

  /// Reduces the reach of a pair to twice the motion of its bodies in `seconds` [s], at least `least` [m]: a resting
  /// pile of 1000 polyhedra has 4000 points within 0.005 of its smallest radius and 5400 within 0.02, of which 2900
  /// carry load. Pairs of polyhedra that hardly move keep their points without a query (resting_patch.h).
  void follow_motion(double seconds, double least) {
    seconds_ = seconds;
    least_reach_ = least;
  }

  /// Walls that touch act as one surface (seams.h).
  void join_walls();

  const char* name() const override { return "batches"; }
  void collide(const World& world, const PairList& pairs, ContactSet& contacts) override;
  void unite(const World& world, ContactSet& contacts) override;
  /// Discards data derived from slots.
  void reorder(const Reordering&) override { known_ = restored_ = seams_known_ = false; }
  /// Visits the resting patches; other memory does not affect results.
  void visit(StateVisitor& visitor) override;

  /// Pairs of the last step whose certified interval stayed wider than 1e-6 of their size.
  std::size_t degenerate_pairs() const { return degenerate_; }

 private:
  static constexpr std::size_t block_size = 256;  // flowing hopper, two threads: of 1024 one waited for a tenth of it

  struct Run {
    std::size_t begin, end;  ///< of the block's pairs
    const PairCell* cell;
  };
  struct Known {
    Pair pair;
    std::uint32_t shape_a, shape_b;
    bool operator==(const Known&) const = default;
  };
  /// Memory of a block's pairs, in their order, with the pairs' names to find it in the next list.
  struct Memory {
    std::vector<Known> known;
    std::vector<PairCache> caches;  ///< for kinds of pairs with memory; no state, since results do not depend on it
    std::vector<std::unique_ptr<RestingPatch>> resting;  ///< the same, where the reach follows motion
    std::vector<PartMemory> parts;                       ///< the same, where a cell has parts
  };
  /// Data derived from the pair list are valid until its next generation, the contacts for one step.
  struct Block {
    std::vector<Pair>
        pairs;  ///< pairs of the list, without those far from all triangles of a mesh or from a hollow wall
    std::vector<Run> runs;
    std::vector<std::uint32_t> triangle_begin, triangles;  ///< CSR over the block's pairs; empty without meshes
    std::vector<Slot> meshes;                              ///< that the pairs touch, one after another
    Memory memory;                                         ///< empty where no cell remembers
    ContactSet contacts;
    std::size_t first = 0;  ///< index of the block's first contact in the whole set
    std::size_t degenerate = 0;
  };

  void prepare(const World& world, const PairList& pairs, Block& block, std::size_t begin, std::size_t end);
  void list_meshes();
  void keep_memory();
  void find_memory(Memory& memory);
  void collide_block(const World& world, Block& block);
  void join(ContactSet& contacts);
  void predict_motion(const World& world);

  const ShapeStore& shapes_;
  double reach_, least_reach_ = 0.0, seconds_ = 0.0;
  std::vector<double> motion_;  ///< by slot; empty where the reach does not follow it
  bool curvature_, area_;
  bool known_ = false;     ///< the runs belong to `generation_`
  bool restored_ = false;  ///< the next list finds its resting patches in `old_`
  std::uint64_t generation_ = 0;
  std::size_t pairs_ = 0;
  std::size_t degenerate_ = 0;
  std::vector<Block> blocks_;
  std::vector<Slot> meshes_;      ///< of all blocks, ascending
  std::unique_ptr<Seams> seams_;  ///< null: walls are not joined
  bool seams_known_ = false;      ///< which bodies have flat faces
  std::vector<Memory> old_;       ///< of the last list's blocks, in order, none empty
};

}  // namespace epafi
