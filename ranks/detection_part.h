/// @file detection_part.h  The search for contacts, shared out: each rank finds those of its bodies, with ghosts of
/// others and all held bodies, and rank 0, which has all bodies, gets them as if it had found them itself. For steps
/// whose impulses belong to all contacts together. A pair is tested by one rank alone, the owner of its first free
/// body. All functions but the getters are called by all ranks together; what only rank 0 has is null elsewhere.
#pragma once
#include "engine/step/simulation.h"
#include "ranks/part_figures.h"
#include "ranks/plan.h"
#include "ranks/territory.h"

namespace epafi {

class DetectionPart {
 public:
  /// The simulation is of the same scene as the whole one; of its stages those of detection are used.
  DetectionPart(Simulation& simulation, PartSetup setup) : sim_(simulation), territory_(std::move(setup)) {}

  /// All bodies are cut anew and shared out, with what the narrow phase of the whole remembers; longest: way of a body
  /// between two searches [m].
  void receive(World* whole, NarrowPhase* memory, double longest);
  /// Where the bodies are now, to all; the contacts come to rank 0 in canonical order.
  void find(const World* whole, ContactSet* contacts);
  /// What the narrow phases remember goes back into that of the whole.
  void give(NarrowPhase* memory);

  /// By how much a free body may move from where it was received [m].
  double margin() const { return territory_.margin(); }
  const PartFigures& figures() const { return figures_; }
  /// For what others book of this rank's time.
  PartFigures& ledger() { return figures_; }

 private:
  void spread(const World* whole);
  const PairList& list_pairs();
  void gather(ContactSet* contacts);

  Simulation& sim_;
  Territory territory_;
  Plan bodies_;                       ///< from rank 0: whom each rank has, in the order of its slots
  std::vector<Slot> from_;            ///< at rank 0: of the whole, one for each row of the plan
  std::vector<std::uint32_t> place_;  ///< by slot: that of the whole
  PairList pairs_;                    ///< those that this rank tests
  bool listed_ = false;               ///< they are those of the last list
  double own_ = 0.0;                  ///< free bodies of this rank
  RowBytes out_, in_;
  WorkMeter work_;
  PartFigures figures_;
};

}  // namespace epafi
