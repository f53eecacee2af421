#include "ranks/shared_detection.h"

#include <algorithm>
#include <cmath>

#include "engine/threads/parallel.h"
#include "ranks/detection_part.h"
#include "ranks/orders.h"

namespace epafi {

namespace {

/// Broad phase of the whole simulation: finds nothing, since ranks list the pairs of their bodies themselves.
class PairsElsewhere final : public BroadPhase {
 public:
  const char* name() const override { return "by rank"; }
  void find_pairs(const World&, PairList&) override {}
  bool keeps_pairs(const World&) override { return true; }
};

class SharedNarrowPhase final : public NarrowPhase {
 public:
  SharedNarrowPhase(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup, bool& busy)
      : world_(whole.world),
        memory_(std::move(whole.pipeline.narrow_phase)),
        simulation_(std::move(part)),
        part_(*simulation_, std::move(setup)),
        busy_(busy) {}

  const char* name() const override { return memory_->name(); }

  void collide(const World& world, const PairList&, ContactSet& contacts) override {
    if (away_ && !is_near(world)) fetch();
    const Busy busy(busy_);
    if (!away_) send();
    tell({.task = Task::find});
    searches_ += 1.0;
    part_.find(&world, &contacts);
  }

  void unite(const World& world, ContactSet& contacts) override { memory_->unite(world, contacts); }

  /// Data of ranks by slot become invalid.
  void reorder(const Reordering& change) override {
    memory_->reorder(change);
    away_ = false;
  }

  void visit(StateVisitor& visitor) override {
    if (away_) fetch();
    memory_->visit(visitor);  // the visitor may bring in another state
  }

  RankFigures figures() {
    const Busy busy(busy_);
    tell({.task = Task::figures});
    return gather_figures(part_.figures());
  }

 private:
  /// True while ranks still have all bodies that may touch theirs.
  bool is_near(const World& world) {
    if (world.size() != start_.size()) return false;
    const double square = block_max<double>(world.size(), 0.0, [&](std::size_t s) {
      return world.is_movable(static_cast<Slot>(s)) ? (world.unwrapped(static_cast<Slot>(s)) - start_[s]).squaredNorm()
                                                    : 0.0;
    });
    if (std::sqrt(square) < part_.margin()) return true;
    pace_ = std::sqrt(square) / std::max(1.0, searches_);
    return false;
  }

  void send() {
    tell({.task = Task::receive_to_find});
    part_.receive(&world_, memory_.get(), pace_);
    start_.resize(world_.size());
    for (Slot s = 0; s < world_.size(); ++s) start_[s] = world_.unwrapped(s);
    searches_ = 0.0;
    away_ = true;
  }

  void fetch() {
    const Busy busy(busy_);
    tell({.task = Task::give_found});
    part_.give(memory_.get());
    away_ = false;
  }

  World& world_;
  std::unique_ptr<NarrowPhase> memory_;  ///< has the memory of the others while this is not away; finds nothing
  std::shared_ptr<Simulation> simulation_;
  DetectionPart part_;
  std::vector<Vec3> start_;  ///< by slot: where bodies were when they were sent [m]
  double searches_ = 0.0;    ///< since then
  double pace_ = 0.0;        ///< of the fastest body from one search to the next, when they were last sent for it [m]
  bool away_ = false;        ///< bodies and memory are with the ranks
  bool& busy_;
};

}  // namespace

std::function<RankFigures()> share_detection(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup,
                                             bool& busy) {
  auto narrow_phase = std::make_unique<SharedNarrowPhase>(whole, std::move(part), std::move(setup), busy);
  SharedNarrowPhase* const stage = narrow_phase.get();
  whole.pipeline.narrow_phase = std::move(narrow_phase);
  whole.pipeline.broad_phase = std::make_unique<PairsElsewhere>();
  return [stage] { return stage->figures(); };
}

}  // namespace epafi
