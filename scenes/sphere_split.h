/// @file sphere_split.h  Splits the pair list of a scene with many spheres: pairs of spheres and balls of clumps, and
/// of these with fixed planes, go to the fused contact model, all others to the narrow phase.
#pragma once
#include <memory>

#include "detection/broad/ball_pairs.h"
#include "detection/broad/broad_phase.h"
#include "detection/shape_store.h"
#include "engine/ranks/shared_list.h"
#include "engine/step/pipeline.h"
#include "laws/smooth/fused/fused_spheres.h"

namespace epafi {

/// The list of a scene with many spheres, and half-spaces that may move. The positions of a block are read only when
/// its displacement bound, a sum of largest displacements per step, reaches the margin: writing and reading all
/// positions would be a fifth of the memory traffic of a step of 100 000 spheres.
class BlockBoundPairs final : public BroadPhase, public SharedList {
 public:
  /// The model is that of the pipeline, whichever it has; the pipeline must outlive this.
  BlockBoundPairs(std::unique_ptr<ListBroadPhase> list, const Pipeline& pipeline)
      : list_(std::move(list)), pipeline_(pipeline) {}
  const char* name() const override { return list_->name(); }
  void find_pairs(const World& world, PairList& pairs) override;
  bool keeps_pairs(const World& world) override;
  End predicted_end() const override { return predicted_; }
  void end_with_others(const End& theirs) override { theirs_ = theirs; }
  void reorder(const Reordering& change) override {
    used_margin_.clear();
    list_->reorder(change);
    if (FusedSpheres* const m = model()) m->forget_margins();
  }
  void visit(StateVisitor& visitor) override {
    used_margin_.clear();
    list_->visit(visitor);
  }

 private:
  bool keep_bounds(const World& world);
  bool ends_with_others(std::span<const double> displacements, double strain_use, const ListState& nearly_used_up);
  std::size_t block_size() const;
  std::size_t blocks(const World& world) const;
  ListState measure(const World& world);
  /// Null where it is another one.
  FusedSpheres* model() const { return dynamic_cast<FusedSpheres*>(pipeline_.contact_model.get()); }

  std::unique_ptr<ListBroadPhase> list_;
  const Pipeline& pipeline_;
  std::vector<double>
      used_margin_;  ///< by block of the model: at least the largest used_margin of its bodies; empty: not known
  bool displacements_known_ = false;   ///< in this step
  End predicted_, theirs_;             ///< as SharedList has them: of this process, of all in this step
  Vec3 cell_size_ = Vec3::Zero();      ///< for which used_margin_ is valid, in a periodic cell [m]
  std::vector<Wraps> wraps_;           ///< the same: bodies put back into the cell have moved by an edge of it
  ListState used_up_;                  ///< state of the list when it ended
  std::vector<std::size_t> doubtful_;  ///< blocks whose bound has reached the margin
};

class SphereSplit final : public NarrowPhase {
 public:
  /// model must outlive this.
  SphereSplit(const ShapeStore& shapes, std::unique_ptr<NarrowPhase> others, FusedSpheres& model, SphereRoles roles)
      : shapes_(shapes), others_(std::move(others)), model_(model), roles_(std::move(roles)) {}
  const char* name() const override { return "spheres apart"; }
  void collide(const World& world, const PairList& pairs, ContactSet& contacts) override;
  void unite(const World& world, ContactSet& contacts) override { others_->unite(world, contacts); }
  void reorder(const Reordering& change) override {
    known_ = false;
    others_->reorder(change);
  }
  void visit(StateVisitor& visitor) override {
    known_ = false;
    others_->visit(visitor);
  }

 private:
  void split(const World& world, const PairList& pairs);
  void read_bodies(const World& world, std::size_t first);

  const ShapeStore& shapes_;
  std::unique_ptr<NarrowPhase> others_;
  FusedSpheres& model_;
  SphereRoles roles_;
  bool known_ = false;      ///< the bodies are in the slots in which the model has seen them
  bool alone_ = false;      ///< only free spheres and half-spaces move
  std::size_t bodies_ = 0;  ///< as many as there were then
  std::vector<BodyBall> balls_;
  std::uint64_t generation_ = 0;
};

}  // namespace epafi
