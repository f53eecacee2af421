/// @file run_record.h  Record of a run in its checkpoint: its stages, the changes by resumes, and the time step of the
/// present stage if the scene alone does not determine it.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/state/world.h"
#include "scenes/generators.h"
#include "scenes/reader/stages.h"

namespace epafi {

/// Division of the step by the largest speed: `time_step = "adaptive"`.
struct AdaptiveStep {
  double top = 0.0;          ///< speed of the survey [m/s]
  double longest = 0.0;      ///< step [s]
  double shortest = 0.0;     ///< step at `top` [s]
  double power = 0.0;        ///< exponent of the speed in the step
  double least_share = 0.0;  ///< speed over `top` below which the step is the longest
  int parts(const World& world) const;
};

/// The time step and its origin.
struct TimeStep {
  double value = 0.0;  ///< [s]
  double limit = 0.0;  ///< stability or accuracy limit [s]; infinite where there is none
  std::string reason;
  std::string limit_reason{};  ///< of the limit; empty: that of the step
  std::optional<AdaptiveStep> adaptive{};
};

/// Bodies by fill of a scene; those that are not known are empty.
using KnownFills = std::vector<std::vector<FillBody>>;

/// A stage that has begun.
struct StageRecord {
  std::string name;
  double from = 0.0;   ///< [s]
  double until = 0.0;  ///< so far [s]
  double clock = 0.0;  ///< of the stage at its end [s]
  std::uint64_t first_step = 0;
  std::string ended;  ///< duration, condition, at_most, changed; empty: not ended
};

struct StageSpec;
/// Warning of a stage that ended at its longest time.
std::string at_most_warning(const StageRecord& record, const StageSpec& stage);

struct RunRecord {
  std::size_t stage = 0;              ///< of the scene that is run
  std::size_t scenes = 0;             ///< records of scenes before this one
  std::vector<StageRecord> stages{};  ///< the last one is the present
  std::vector<InsertedStage> inserted{};
  std::string start_run{};  ///< as ReadOptions has it
  std::optional<TimeStep> time_step{};
  KnownFills fills{};  ///< of stages after the first: placed among bodies that stand elsewhere since

  /// Clocks of the stages of this scene before the present one, at their ends [s].
  std::vector<double> clocks() const;
  std::string to_text() const;
  /// Throws FileError where it is none.
  static RunRecord from_text(const std::string& text);
};

}  // namespace epafi
