/// @file detection_part.h  Distributed search for contacts: each rank finds those of its bodies, with ghosts of others
/// and all held bodies; rank 0, which has all bodies, gathers them in the order of one process. For non-smooth steps,
/// whose impulses depend on all contacts. One rank tests a pair, the owner of its first free body. All ranks call all
/// functions except getters; arguments that only rank 0 has are null elsewhere.
#pragma once
#include "engine/step/simulation.h"
#include "ranks/part_figures.h"
#include "ranks/plan.h"
#include "ranks/territory.h"

namespace epafi {

class DetectionPart {
 public:
  /// simulation: of the same scene as the whole one; only its detection is used.
  DetectionPart(Simulation& simulation, PartSetup setup) : sim_(simulation), territory_(std::move(setup)) {}

  /// Distributes all bodies anew, with the memory of the whole's narrow phase; longest: motion of a body between two
  /// searches [m].
  void receive(World* whole, NarrowPhase* memory, double longest);
  /// Sends the present positions to all; gathers the contacts at rank 0 in canonical order.
  void find(const World* whole, ContactSet* contacts);
  /// Returns the memory of the narrow phases to that of the whole.
  void give(NarrowPhase* memory);

  /// Distance by which a free body may move before bodies must be distributed anew [m].
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
