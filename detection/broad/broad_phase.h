/// @file broad_phase.h  Base of all broad phases: fat bodies, the test whether the list is outdated, the canonical list
/// (Verlet 1967). A method only provides candidates; the list depends on the fat boxes, not on the method. Contacts do
/// not depend on the list's age, since a pair with gap < reach is always listed. So `visit` saves nothing, and a
/// restart gives the same bits.
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
  /// After keeps_pairs() returned false: true where slow bodies ended the list.
  bool used_up_by_slow() const { return used_up_by_slow_; }
  /// Adds the pairs of bodies that entered since, in slots after the others, to a list that is valid for the others, by
  /// tests against every body. Returns false, without changes, if a new list is needed.
  bool take_in(const World& world, PairList& pairs);
  /// Builds the list anew, outdated or not.
  void renew_pairs(const World& world, PairList& pairs, bool used_up_by_slow);
  /// Sets the time after steps without calls of the two functions above.
  void see_time(double now);
  /// The next call builds the list anew, since it contains slots.
  void reorder(const Reordering&) override { valid_ = known_ = false; }
  void visit(StateVisitor&) override { known_ = false; }  ///< the loaded state may differ
  const FatBodies& bodies() const { return bodies_; }

 protected:
  /// Passes every ordinary body and its candidates to the collector.
  virtual void collect(const FatBodies& bodies, PairCollector& collector) = 0;
  /// Within collect: data by slot are invalid. Slots of images differ in every list.
  bool slots_changed() const { return !valid_ || !bodies_.images.empty(); }

 private:
  void name_margins(PairList& pairs) const;

  BroadSetup setup_;
  FatBodies bodies_;
  PairCollector collector_;
  BallPairs balls_;
  PairColumn found_;  ///< with images, in a periodic cell
  bool valid_ = false;
  bool used_up_by_slow_ = false;  ///< by the last test of all bodies
  bool known_ = false;            ///< the bodies are in the slots in which bodies_ has seen them
  double last_time_ = infinity;   ///< of the last call [s]
  double step_time_ = 0.0;        ///< dt as seen between two calls [s]; 0: not known yet
};

}  // namespace epafi
