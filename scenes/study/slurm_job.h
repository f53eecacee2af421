/// @file slurm_job.h  `epafi sweep --slurm`: the cases of a sweep as an array job of Slurm, and a job that collects
/// their rows when all have ended. Every task calls `epafi sweep --case K`, which skips what is finished.
#pragma once
#include <filesystem>
#include <string>

#include "scenes/study/sweep.h"

namespace epafi {

/// Slurm's own limit, MaxArraySize, is 1001 by default: array numbers end at 1000.
inline constexpr std::size_t most_array_tasks = 1000;

struct SlurmJob {
  std::string program;           ///< the executable that the tasks call
  std::filesystem::path folder;  ///< of the cases; the tasks' messages and the CSV go there too
  int threads = 1;               ///< asked for by each task; --cpus-per-task of sbatch goes before
};

/// Numbers as Slurm writes them: 0-2,5,7-8. They ascend.
std::string array_range(const std::vector<std::size_t>& numbers);

/// The script; `bash` on it sends both jobs, `sbatch` only the array. Empty where no case is open. All paths in it are
/// absolute. Sweeps of more cases than an array may have tasks give each task several.
std::string slurm_script(const SweepPlan& sweep, const SlurmJob& job);

}  // namespace epafi
