/// @file narrow_phase.h  Pairs to contacts: blocks of consecutive pairs, runs of equal cells, results joined in order.
/// Each block fills its own contact set, kept from step to step, so nothing is allocated once the scene has settled and
/// the contacts are the same bits in the same order for every thread count.
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

  /// The reach of a pair shrinks to twice what its bodies move in `seconds`, not below `least`: at rest a pile of 1000
  /// polyhedra has 4000 points within 0.005 of its smallest radius and 5400 within 0.02, of which 2900 carry load.
  /// Pairs of polyhedra that hardly move keep their points without a query (resting_patch.h).
  void follow_motion(double seconds, double least) {
    seconds_ = seconds;
    least_reach_ = least;
  }

  /// Walls that touch act as one surface (seams.h).
  void join_walls();

  const char* name() const override { return "batches"; }
  void collide(const World& world, const PairList& pairs, ContactSet& contacts) override;
  void unite(const World& world, ContactSet& contacts) override;
  /// Not those near no triangle of a mesh.
  void reorder(const Reordering&) override { known_ = restored_ = seams_known_ = false; }
  /// Of the resting patches; what else is remembered changes no bit.
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
  /// What a block's pairs remember, in their order, and whom it belongs to, to be found again in the next list.
  struct Memory {
    std::vector<Known> known;
    std::vector<PairCache> caches;                       ///< where a cell remembers; shortcuts only, so not state
    std::vector<std::unique_ptr<RestingPatch>> resting;  ///< the same, where the reach follows motion
    std::vector<PartMemory> parts;                       ///< the same, where a cell has parts
  };
  /// What is derived from the pair list lasts until its next generation; the contacts last one step.
  struct Block {
    std::vector<Pair> pairs;  ///< those of the list but bodies near no triangle of a mesh, no hollow wall
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
  void foresee_motion(const World& world);

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
  std::unique_ptr<Seams> seams_;  ///< null: each wall stands for itself
  bool seams_known_ = false;      ///< which bodies have flat faces
  std::vector<Memory> old_;       ///< of the last list's blocks, in order, none empty
};

}  // namespace epafi
