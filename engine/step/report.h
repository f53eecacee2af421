/// @file report.h  What a step did: counts, times, energies, residual. Numerical trouble is a value here, not an
/// exception.
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "engine/state/types.h"
#include "engine/threads/shared_out.h"

namespace epafi {

/// What a solver returns; residual is measured outside the solver (laws/nonsmooth/residual.h).
struct SolverReport {
  bool converged = true;
  int iterations = 0;
  double residual = 0.0;
};

/// What a problem of a step lacks, where its solver cannot help it.
struct SolverTrouble {
  enum class Kind {
    none,
    no_solution,    ///< contacts demand of bodies what no motion gives: squeezed between driven walls
    beyond_measure  ///< impulses so large that rounding is more than every velocity
  };
  Kind kind = Kind::none;
  std::string text;        ///< why, with numbers
  double size = 0.0;       ///< how fast the contacts close that cannot [m/s], or the largest impulse [N s]
  std::uint32_t slot = 0;  ///< of a body it is about
};

/// events: what stands between two steps: driven motion, servo walls, sources, outlets, removal, sorts, wrap and strain
/// of a cell, loads, ledger and watches.
enum class Stage { integrate, broad_phase, narrow_phase, contact, events, output };
inline constexpr std::size_t stage_count = 6;
inline constexpr std::array<const char*, stage_count> stage_names{"integrate", "broad_phase", "narrow_phase",
                                                                  "contact",   "events",      "output"};

/// Wall seconds by stage, and those of them outside loops that are shared out over threads.
struct StageSeconds {
  std::array<double, stage_count> seconds{}, serial{};
  double& operator[](Stage s) { return seconds[static_cast<std::size_t>(s)]; }
  double operator[](Stage s) const { return seconds[static_cast<std::size_t>(s)]; }
  double all() const { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }
};

/// Adds the time since the last lap to a stage.
class StageTimer {
 public:
  explicit StageTimer(StageSeconds& seconds) : seconds_(seconds), last_(Clock::now()), shared_(SharedOut::seconds()) {}
  /// booked: of this time, seconds that stand in a stage already.
  void lap(Stage stage, double booked = 0.0) {
    const auto now = Clock::now();
    const double shared = SharedOut::seconds();
    const double all = std::max(0.0, std::chrono::duration<double>(now - last_).count() - booked);
    seconds_[stage] += all;
    seconds_.serial[static_cast<std::size_t>(stage)] += all - (shared - shared_);
    last_ = now;
    shared_ = shared;
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageSeconds& seconds_;
  Clock::time_point last_;
  double shared_;
};

/// Parts of what smooth contacts lose [J]: dashpots and rolling, slip, plastic deformation, adhesion.
struct Losses {
  double viscous = 0.0, frictional = 0.0, plastic = 0.0, adhesive = 0.0;
  Losses& operator+=(const Losses& o) {
    viscous += o.viscous;
    frictional += o.frictional;
    plastic += o.plastic;
    adhesive += o.adhesive;
    return *this;
  }
};

/// A contact that its model solved outside the range where the model holds.
struct ModelDoubt {
  std::string reason;
  Slot slot = no_slot;  ///< of the body
  double load = 0.0;    ///< normal force [N]
};

/// What the contact model reports of one step.
struct StepReport {
  std::size_t pairs = 0;
  std::size_t contacts = 0;   ///< reported by the narrow phase
  std::size_t touching = 0;   ///< with gap < 0 (smooth) or impulse > 0 (non-smooth)
  double elastic = 0.0;       ///< energy stored in the contacts now [J]; with StepClock::run_on it may be an older one
  double dissipated = 0.0;    ///< energy lost in the contacts during this step [J]
  double work = 0.0;          ///< work of driven bodies on the others during this step [J]
  double correction = 0.0;    ///< potential energy put in by moving overlapping bodies apart in this step [J]
  double servo_energy = 0.0;  ///< non-smooth: what servo walls would gain in this step if nothing held them [J]
  Losses losses;              ///< parts of `dissipated`, of smooth contact
  double deepest = 0.0;       ///< largest overlap of all contacts [m]
  double deepest_relative = 0.0;  ///< of contacts that a model finds itself, over the smaller radius of the pair
  bool has_solver = false;
  SolverReport solver;
  SolverTrouble trouble;
  std::vector<ModelDoubt> doubts;
  StageSeconds seconds;  ///< summed over all steps so far
};

}  // namespace epafi
