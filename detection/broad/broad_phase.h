/// @file broad_phase.h  What all broad phases share: fat bodies, the test when the list is outdated, the canonical list
/// (Verlet 1967). A method only hands over candidates. The list is a function of the fat boxes, not of the method.
/// Contacts do not depend on the list's age: a pair with gap < reach is always listed. Hence nothing is saved in
/// `visit` and any restart gives the same bits.
#pragma once
#include "detection/broad/ball_pairs.h"
#include "detection/broad/fat_bodies.h"
#include "detection/broad/pair_collector.h"
#include "engine/step/pipeline.h"

namespace epafi {

class ListBroadPhase : public BroadPhase {
 public:
  explicit ListBroadPhase(BroadSetup setup) : setup_(std::move(setup)), collector_(bodies_, setup_.filter) {}
  ListBroadPhase(const ListBroadPhase&) = delete;
  ListBroadPhase& operator=(const ListBroadPhase&) = delete;

  void find_pairs(const World& world, PairList& pairs) final;
  bool keeps_pairs(const World& world) final;
  /// Of a list that was not kept.
  bool used_up_by_slow() const { return used_up_by_slow_; }
  /// Adds the pairs of bodies that entered since, in slots after the others, to a list that is valid for the others:
  /// tests each of them against every body. False, and nothing has changed, where a new list is needed.
  bool take_in(const World& world, PairList& pairs);
  /// Builds the list anew whatever bodies() says of it.
  void renew_pairs(const World& world, PairList& pairs, bool used_up_by_slow);
  /// The time has come to `now`: of steps in which neither of both is called.
  void see_time(double now);
  /// The next call builds anew: the list names slots.
  void reorder(const Reordering&) override { valid_ = known_ = false; }
  void visit(StateVisitor&) override { known_ = false; }  ///< it may be another state that comes in
  const FatBodies& bodies() const { return bodies_; }

 protected:
  /// Hands every ordinary body and its candidates to the collector.
  virtual void collect(const FatBodies& bodies, PairCollector& collector) = 0;
  /// Within collect: what was kept by slot is void. Slots of images name others in every list.
  bool slots_changed() const { return !valid_ || !bodies_.images.empty(); }

 private:
  void name_margins(PairList& pairs) const;

  BroadSetup setup_;
  FatBodies bodies_;
  PairCollector collector_;
  BallPairs balls_;
  PairColumn found_;  ///< with images, in a periodic cell
  bool valid_ = false;
  bool used_up_by_slow_ = false;  ///< as the last look at all bodies says
  bool known_ = false;            ///< the bodies are in the slots in which bodies_ has seen them
  double last_time_ = infinity;   ///< of the last call [s]
  double step_time_ = 0.0;        ///< dt as seen between two calls [s]; 0: not known yet
};

}  // namespace epafi
