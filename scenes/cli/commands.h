/// @file commands.h  The commands of the program as functions that return an exit code. Results go to stdout, messages
/// to stderr.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace epafi {

enum ExitCode {
  exit_done = 0,
  exit_bound = 1,   ///< a [bounds] entry was violated
  exit_usage = 2,   ///< wrong scene or usage
  exit_file = 3,    ///< input/output
  exit_failed = 4,  ///< the simulation failed; last good state saved
  exit_time_limit = 75,
  exit_interrupt = 130,
  exit_terminate = 143,
};

struct CommonOptions {
  std::string scene;
  std::vector<std::string> overrides;
};

struct RunOptions {
  std::string out;              ///< empty: out/<scene name>
  int threads = 0;              ///< 0: all cores
  std::optional<double> until;  ///< [s]
  std::optional<std::uint64_t> steps;
  std::string time_limit, cpu_limit;  ///< "3h50m", "90s"; empty: none
  bool quiet = false, verbose = false, json = false, force = false, least_output = false;
  bool strict = false;  ///< any warning of scene or run ends with exit_bound
};

struct SolveOptions {
  std::vector<std::string> problems;  ///< FCLIB HDF5 or Siconos .dat files
  std::vector<std::string> methods;   ///< names of solvers
  double tolerance = 1e-6;
  double max_iterations = 1e9;
  std::string time_limit = "10s";  ///< CPU time of each solve
  std::string solution, out;       ///< files; empty: none, and rows on stdout
  bool json = false;
};

struct PatchOptions {
  bool json = false;
  bool table = false;     ///< aligned columns for people in place of CSV
  bool geometry = false;  ///< rigid geometry of the wheelset instead of the models
  std::string maps = {};  ///< folder for pressure, traction and slip maps; empty: none
  std::string out = {};   ///< file for the rows; empty: stdout
};

int command_run(const CommonOptions& common, const RunOptions& options);
/// Changes of a resumed run.
struct ResumeChanges {
  std::vector<std::string> overrides;  ///< "KEY.PATH=VALUE", from here on
  std::string scene;                   ///< another scene; empty: the same
};

int command_resume(const std::string& directory, const RunOptions& options, const ResumeChanges& changes = {});
int command_check(const CommonOptions& common);
int command_explain(const CommonOptions& common);
int command_list(const std::string& kind);
int command_schema();
int command_new(const std::string& kind);
int command_solve(const SolveOptions& options);
int command_export(const std::string& directory, const std::string& format);
int command_report(const std::string& directory, const std::string& page);
int command_reference(const std::string& directory, const std::string& broken_scenes);
int command_patch(const CommonOptions& common, const PatchOptions& options);  ///< patch.cpp

/// Runs a command and turns what it throws into a message and an exit code.
int guarded(const std::function<int()>& command);

}  // namespace epafi
