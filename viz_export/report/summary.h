/// @file summary.h  Description and results of a run, as summary.json. A quantity that a scene does not have is absent.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/ranks/remote_steps.h"
#include "engine/step/report.h"

namespace epafi {

struct RunSummary {
  struct Energy {
    double kinetic = 0, potential = 0;  ///< at the end [J]
    std::optional<double> elastic;      ///< [J]; smooth contact only
    double dissipated = 0, work = 0;    ///< since the start [J]
    double gained = 0;                  ///< created by contacts since the start, an error of the method [J]
    std::optional<double> correction;   ///< created by position correction [J]; non-smooth only
    double relative_error = 0;          ///< of the ledger
  };
  struct Overlap {
    double max = 0, mean = 0;  ///< over pairs that overlap [m]
    double max_relative = 0;   ///< of the smaller body's bounding radius
  };
  struct MaxMean {
    double max = 0, mean = 0;
  };
  struct Component {
    double last = 0, min = 0, max = 0;
  };
  struct Check {
    double value = 0, bound = 0;
    bool ok = true;
  };

  std::string epafi;  ///< version
  std::string scene;
  std::string scene_hash;
  std::string status;       ///< completed, bound_violated, failed, interrupted
  std::string stop_reason;  ///< why it ended early without failure; else empty and absent
  struct StageTimes {
    std::string name;
    double from = 0, until = 0;  ///< [s]
    std::string ended;           ///< duration, condition, at_most, changed; empty: it was cut off
  };
  std::vector<StageTimes> stages{};   ///< absent where the scene has none
  std::string failure;                ///< why, where the status is not completed; else empty and absent
  std::vector<std::string> warnings;  ///< warnings of the run; may be empty
  std::uint64_t bodies = 0, bodies_lost = 0;
  std::uint64_t bodies_removed = 0;  ///< by remove_at, stages, outlets and the domain
  std::uint64_t steps = 0;
  double time_step = 0;                    ///< [s]
  double simulated_time = 0;               ///< [s]
  double wall_time = 0;                    ///< [s]
  double cpu_time = 0;                     ///< of the stepping, all threads, output included [s]
  int threads = 1;                         ///< of each process
  std::optional<RankFigures> ranks;        ///< of a run that several processes share
  std::string ranks_share;                 ///< part of the work that they share
  std::optional<double> ns_per_body_step;  ///< of moving bodies, everything but output
  StageSeconds stage_seconds;
  std::optional<double> contacts_mean;
  std::optional<Energy> energy;
  std::optional<double> momentum_error;
  std::optional<Overlap> overlap;
  std::optional<MaxMean> residual, iterations;     ///< non-smooth contact only
  std::optional<std::uint64_t> unconverged_steps;  ///< that ended above the solver's tolerance; non-smooth contact only
  std::map<std::string, std::map<std::string, Component>> measures;  ///< by measure, by component
  std::map<std::string, Check> checks;                               ///< of [bounds]
  std::map<std::string, Check> accuracy;  ///< of [accuracy]; absent where the scene asks for none
  std::uint64_t peak_memory_bytes = 0;
  std::string state_hash;
};

std::string summary_json(const RunSummary& summary);
void write_summary(const std::filesystem::path& path, const RunSummary& summary);

}  // namespace epafi
