/// @file remote_steps.h  Steps made by several processes, each with a part of the bodies. The simulation of process 0
/// holds all bodies between steps whenever files, observers, events or sorts need them: these know one process only.
#pragma once
#include "engine/step/domain.h"
#include "engine/step/report.h"

namespace epafi {

class Simulation;

/// How the bodies are shared out.
struct RankFigures {
  int ranks = 1;
  double imbalance = 1.0;       ///< most free bodies of a rank over their mean, mean of the steps
  double ghosts = 0.0;          ///< bodies that a rank has of others over its own
  double bytes_per_step = 0.0;  ///< sent by all ranks, mean of the steps
  double moves = 0.0;           ///< how often bodies changed ranks between two sorts
};

class RemoteSteps {
 public:
  virtual ~RemoteSteps() = default;
  /// The state of the simulation goes to the processes.
  virtual void send(Simulation& whole) = 0;
  /// Their state comes into the simulation.
  virtual void fetch(Simulation& whole) = 0;
  /// The contacts of the last step come into its workspace, and its bodies to where they are now: whatever else it
  /// knows of them may be of an earlier step. in_pieces: in the order of ContactPieces, else in canonical order.
  virtual void fetch_contacts(Simulation& whole, bool in_pieces) = 0;
  /// A step of all of them; what it did is summed up in the report. False where some free body is outside the domain or
  /// its state is no number.
  virtual bool step(double dt, const std::optional<Domain>& domain, StepReport& report) = 0;
  virtual RankFigures figures() = 0;
};

}  // namespace epafi
