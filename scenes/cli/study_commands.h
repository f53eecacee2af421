/// @file study_commands.h  chart, limits, sweep and bench as functions that return an exit code. Rows go to stdout as
/// CSV or JSON, verdicts and progress to stderr.
#pragma once
#include <string>
#include <vector>

namespace epafi {

struct StudyOptions {
  std::vector<std::string> files;      ///< studies; of sweep and bench the scene
  std::vector<std::string> overrides;  ///< of the study file; of sweep and bench those of the scene
  std::string out;                     ///< empty: out/<file name>
  std::vector<std::string> rows;       ///< of chart: CSV files with rows of others
  int jobs = 1;
  bool json = false, quiet = false, force = false;
  bool all = false;  ///< every study of `studies`, into `atlas`
  std::string studies = "scenes/library/studies", atlas = "docs/atlas", budget = "30m";
};

int command_chart(const StudyOptions& options);
int command_limits(const StudyOptions& options);

struct SweepOptions {
  bool list = false, collect = false;
  bool slurm = false;  ///< write the array job instead of running
  int one = -1;        ///< --case K
  int threads = 1;
};
int command_sweep(const StudyOptions& options, const SweepOptions& sweep);

struct BenchOptions {
  std::vector<int> threads{1, 2};
  int repeats = 3;
  bool copies = false, json = false;
  std::string out_file;  ///< the rows, beside stdout
};
int command_bench(const StudyOptions& options, const BenchOptions& bench);

}  // namespace epafi
