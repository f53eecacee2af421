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

/// Wall time of a process [s]: stages of its own steps; `exchange`: packing ghosts and waiting for them; `sums`:
/// waiting for sums over all processes; `orders`: waiting for process 0 (at process 0: its work with files, events and
/// sorts); `sharing`: migration of bodies and contacts. `hidden`, in no other entry: messages of ghosts during
/// computation.
enum class RankStage { integrate, broad_phase, narrow_phase, contact, exchange, sums, orders, sharing, hidden };
inline constexpr std::array<const char*, 9> rank_stage_names{
    "integrate", "broad_phase", "narrow_phase", "contact", "exchange", "sums", "orders", "sharing", "hidden"};
using RankSeconds = std::array<double, rank_stage_names.size()>;

/// Statistics of the distribution of bodies.
struct RankFigures {
  int ranks = 1;
  double imbalance = 1.0;              ///< most free bodies of a rank over their mean, mean of the steps
  double ghosts = 0.0;                 ///< ghosts over own bodies of a process
  double bytes_per_step = 0.0;         ///< sent by all ranks, mean of the steps
  double moves = 0.0;                  ///< migrations between two sorts
  std::vector<RankSeconds> seconds{};  ///< by rank
};

/// Sums over all bodies and overlaps in other processes.
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
  /// Sends the state of the simulation to the processes.
  virtual void send(Simulation& whole) = 0;
  /// Gathers their state in the simulation. goes_on: a step comes next, and nothing reads the contacts of the last one.
  virtual void fetch(Simulation& whole, bool goes_on) = 0;
  /// What a step changes of bodies comes into the simulation, and into its workspace the contacts of the last step that
  /// observers want: pieces in the order of ContactPieces, all in canonical order. Whatever else it knows may be of an
  /// earlier step.
  virtual void fetch_seen(Simulation& whole, ContactView contacts) = 0;
  /// Of the present state, before it is fetched.
  virtual RemoteTotals totals(bool overlaps) = 0;
  /// stiffness_bound over all processes for steps of dt [s] with the contacts of the last one; infinite if unknown.
  virtual double stiffness(double dt) = 0;
  /// One step of all processes; sums go to the report. False if some free body is outside the domain or not finite.
  /// run_on: as in Simulation::advance.
  virtual bool step(double dt, const std::optional<Domain>& domain, bool run_on, StepReport& report) = 0;
  /// True if they have begun the next step: the state must not be gathered.
  virtual bool is_ahead() const = 0;
  virtual RankFigures figures() = 0;
};

}  // namespace epafi
