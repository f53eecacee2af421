/// @file report.h  Report of a step: counts, times, energies, residual. Numerical trouble is a value here, not an
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

/// Result of a solver; the residual is measured outside the solver (laws/nonsmooth/residual.h).
struct SolverReport {
  bool converged = true;
  int iterations = 0;
  double residual = 0.0;
};

/// Reason why no solver can solve the problem of a step.
struct SolverTrouble {
  enum class Kind {
    none,
    no_solution,    ///< no velocity satisfies the constraints: bodies between closing walls
    beyond_measure  ///< impulses so large that rounding errors exceed the velocities
  };
  Kind kind = Kind::none;
  std::string text;        ///< why, with numbers
  double size = 0.0;       ///< closing speed of those contacts [m/s], or the largest impulse [N s]
  std::uint32_t slot = 0;  ///< of a body concerned
};

/// events: work between two steps: driven motion, servo walls, sources, outlets, removal, sorts, wrapping and strain of
/// a cell, loads, ledger and monitors.
enum class Stage { integrate, broad_phase, narrow_phase, contact, events, output };
inline constexpr std::size_t stage_count = 6;
inline constexpr std::array<const char*, stage_count> stage_names{"integrate", "broad_phase", "narrow_phase",
                                                                  "contact",   "events",      "output"};

/// Wall time by stage [s]; serial: the part outside parallel loops.
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
  /// booked: part of this time that is already counted in a stage [s].
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

/// Energy lost in smooth contacts by cause [J]: dashpots and rolling, slip, plastic deformation, adhesion.
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

/// A contact that was solved outside the range of validity of its model.
struct ModelDoubt {
  std::string reason;
  Slot slot = no_slot;  ///< of the body
  double load = 0.0;    ///< normal force [N]
};

/// Report of the contact model for one step.
struct StepReport {
  std::size_t pairs = 0;
  std::size_t contacts = 0;   ///< reported by the narrow phase
  std::size_t touching = 0;   ///< with gap < 0 (smooth) or impulse > 0 (non-smooth)
  double elastic = 0.0;       ///< elastic energy now [J]; with StepClock::run_on possibly that of an earlier step
  double dissipated = 0.0;    ///< energy lost in the contacts during this step [J]
  double work = 0.0;          ///< work of driven bodies on the others during this step [J]
  double correction = 0.0;    ///< potential energy created by position correction in this step [J]
  double servo_energy = 0.0;  ///< non-smooth: energy that servo walls would gain in this step without contacts [J]
  Losses losses;              ///< parts of `dissipated`, of smooth contact
  double deepest = 0.0;       ///< largest overlap of all contacts [m]
  /// Largest overlap over the smaller radius of the pair: of contacts that a model finds itself, and of all contacts in
  /// the earlier parts of a divided step.
  double deepest_relative = 0.0;
  bool has_solver = false;
  SolverReport solver;
  SolverTrouble trouble;
  std::vector<ModelDoubt> doubts;
  StageSeconds seconds;  ///< summed over all steps so far
};

}  // namespace epafi
