/// @file rolling_search.h  Takes the pairs of wheelsets and tracks out of the narrow phase and finds their contact
/// regions with the gaps around them; all other pairs go on. Only in scenes with such a pair and a law that rolls.
#pragma once
#include <map>
#include <memory>

#include "detection/profiles/wheelset_on_track.h"
#include "detection/shape_store.h"
#include "engine/step/pipeline.h"

namespace epafi {

class RollingSearch final : public NarrowPhase {
 public:
  /// `regions` is filled anew in every step; it and `shapes` must outlive this.
  RollingSearch(const ShapeStore& shapes, std::unique_ptr<NarrowPhase> others, RollingRegions& regions)
      : shapes_(shapes), others_(std::move(others)), regions_(regions) {}
  const char* name() const override { return "wheels on rails apart"; }
  void collide(const World& world, const PairList& pairs, ContactSet& contacts) override;
  void unite(const World& world, ContactSet& contacts) override { others_->unite(world, contacts); }
  void reorder(const Reordering& change) override {
    known_ = false;
    others_->reorder(change);
  }
  void visit(StateVisitor& visitor) override { others_->visit(visitor); }

 private:
  void split(const World& world, const PairList& pairs);

  const ShapeStore& shapes_;
  std::unique_ptr<NarrowPhase> others_;
  RollingRegions& regions_;
  bool known_ = false;
  std::uint64_t generation_ = 0;
  PairList rest_;
  std::vector<std::pair<Slot, Slot>> rolling_;  ///< wheelset, track
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<WheelsetOnTrack>>
      searches_;  ///< by shapes: one per pair
};

}  // namespace epafi
