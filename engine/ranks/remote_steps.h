/// @file remote_steps.h  Steps made by several processes, each with a part of the bodies. The simulation of process 0
/// holds the whole state between steps whenever checkpoints, events or sorts need it: these know one process only.
/// Observers get the bodies as files show them. What is summed over bodies is summed where they are.
#pragma once
#include <array>
#include <vector>

#include "engine/step/domain.h"
#include "engine/step/observer.h"
#include "engine/step/report.h"
#include "engine/step/totals.h"

namespace epafi {

class Simulation;

/// Where the wall time of a process goes: stages of its own steps; `exchange`, what it waits for ghosts and packs them;
/// `sums`, what it waits for sums over all; `orders`, what it waits for process 0, whose own work with files, events
/// and sorts this is; `sharing`, bodies and contacts that go to other processes. `hidden`, beside all these: ghosts on
/// their way while it computes.
enum class RankStage { integrate, broad_phase, narrow_phase, contact, exchange, sums, orders, sharing, hidden };
inline constexpr std::array<const char*, 9> rank_stage_names{
    "integrate", "broad_phase", "narrow_phase", "contact", "exchange", "sums", "orders", "sharing", "hidden"};
using RankSeconds = std::array<double, rank_stage_names.size()>;

/// How the bodies are shared out.
struct RankFigures {
  int ranks = 1;
  double imbalance = 1.0;              ///< most free bodies of a rank over their mean, mean of the steps
  double ghosts = 0.0;                 ///< bodies that a rank has of others over its own
  double bytes_per_step = 0.0;         ///< sent by all ranks, mean of the steps
  double moves = 0.0;                  ///< how often bodies changed ranks between two sorts
  std::vector<RankSeconds> seconds{};  ///< by rank
};

/// What is summed over all bodies and overlaps while they are elsewhere.
struct RemoteTotals {
  BodyTotals bodies;
  OverlapTotals overlaps;  ///< where these are asked for
  RemoteTotals& operator+=(const RemoteTotals& other) {
    bodies += other.bodies;
    overlaps += other.overlaps;
    return *this;
  }
};

class RemoteSteps {
 public:
  virtual ~RemoteSteps() = default;
  /// The state of the simulation goes to the processes.
  virtual void send(Simulation& whole) = 0;
  /// Their state comes into the simulation.
  virtual void fetch(Simulation& whole) = 0;
  /// What a step changes of bodies comes into the simulation, and into its workspace the contacts of the last step that
  /// observers want: pieces in the order of ContactPieces, all in canonical order. Whatever else it knows may be of an
  /// earlier step.
  virtual void fetch_seen(Simulation& whole, ContactView contacts) = 0;
  /// Of the present state, before it is fetched.
  virtual RemoteTotals totals(bool overlaps) = 0;
  /// What stiffness_bound gives over all of them for steps of dt [s] with the contacts of the last one; infinite where
  /// nothing is known.
  virtual double stiffness(double dt) = 0;
  /// A step of all of them; what it did is summed up in the report. False where some free body is outside the domain or
  /// its state is no number. run_on: they may begin the next one, as Simulation::advance has it.
  virtual bool step(double dt, const std::optional<Domain>& domain, bool run_on, StepReport& report) = 0;
  /// They have begun it: the state must not be fetched.
  virtual bool is_ahead() const = 0;
  virtual RankFigures figures() = 0;
};

}  // namespace epafi
