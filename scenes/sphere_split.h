/// @file sphere_split.h  Sorts the pair list of a scene with many spheres: pairs of free spheres, and of free spheres
/// with fixed planes, go to the fused contact model, all others to the narrow phase.
#pragma once
#include <memory>

#include "detection/broad/broad_phase.h"
#include "detection/shape_store.h"
#include "engine/pipeline.h"
#include "laws/smooth/fused/fused_spheres.h"

namespace epafi {

/// The list of a scene with many spheres: while the ways that the model knows of add up to less than the margins nobody
/// looks at the bodies (of 100 000 spheres a look, and the positions written for it, are a fifth of all bytes of a
/// step).
class WornPairs final : public BroadPhase {
 public:
  /// The model is that of the pipeline, whichever it has; the pipeline must outlive this.
  WornPairs(std::unique_ptr<ListBroadPhase> list, const Pipeline& pipeline)
      : list_(std::move(list)), pipeline_(pipeline) {}
  const char* name() const override { return list_->name(); }
  void find_pairs(const World& world, PairList& pairs) override;
  bool keeps_pairs(const World& world) override;
  void reorder(const Reordering& change) override { wear_ = infinity, list_->reorder(change); }
  void visit(StateVisitor& visitor) override { wear_ = infinity, list_->visit(visitor); }

 private:
  std::unique_ptr<ListBroadPhase> list_;
  const Pipeline& pipeline_;
  double way_ = infinity;   ///< of this step, as the model knows it
  double wear_ = infinity;  ///< at least the largest way of a body over half its margin
};

class SphereSplit final : public NarrowPhase {
 public:
  /// model must outlive this; fixed: by body id, true for bodies that never move; ids beyond it are free.
  SphereSplit(const ShapeStore& shapes, std::unique_ptr<NarrowPhase> others, FusedSpheres& model,
              std::vector<bool> fixed)
      : shapes_(shapes), others_(std::move(others)), model_(model), fixed_(std::move(fixed)) {}
  const char* name() const override { return "spheres apart"; }
  void collide(const World& world, const PairList& pairs, ContactSet& contacts) override;
  void reorder(const Reordering& change) override { known_ = false, others_->reorder(change); }
  void visit(StateVisitor& visitor) override { others_->visit(visitor); }

 private:
  void split(const World& world, const PairList& pairs);
  bool is_fixed(const World& world, Slot s) const {
    const auto id = static_cast<std::size_t>(world.id[s]);
    return id < fixed_.size() && fixed_[id];
  }

  const ShapeStore& shapes_;
  std::unique_ptr<NarrowPhase> others_;
  FusedSpheres& model_;
  std::vector<bool> fixed_;
  bool known_ = false;
  std::uint64_t generation_ = 0;
  PairList rest_;
  std::vector<Slot> watched_;
};

}  // namespace epafi
