/// @file session.h  One run on disk: a simulation with its observers and files, from start or from a checkpoint, to its
/// end.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/assemble.h"
#include "scenes/progress.h"
#include "viz_export/checkpoint.h"
#include "viz_export/output_observers.h"
#include "viz_export/summary.h"

namespace epafi {

class TrackWatch;

struct SessionLimits {
  std::optional<double> until = {};         ///< simulated time [s]
  std::optional<std::uint64_t> steps = {};  ///< steps of the whole run
  std::optional<double> wall = {};          ///< wall time of this session [s]
  std::optional<double> processor = {};     ///< processor time of this process, all threads [s]
};

/// Why a session ended.
enum class Ending { completed, until, bound_violated, failed, time_limit, interrupted, terminated };

class Session {
 public:
  /// Files of a run: all, or no frames and no snapshot but the last.
  enum class Output { all, least };
  /// A new run in an empty folder.
  Session(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides, std::filesystem::path folder,
          Output output = Output::all);
  /// Continues a run from folder/checkpoint.h5; `assembly` is the same scene assembled anew.
  static std::unique_ptr<Session> resume(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides,
                                         std::filesystem::path folder);
  ~Session();

  Ending run(const SessionLimits& limits, bool quiet);
  /// Text of the failure or of the violated bound; empty when all is well.
  const std::string& trouble() const { return trouble_; }
  /// Of a run whose solver stopped above its tolerance: how often, how far, and which solver would do; else empty.
  std::string advice() const;
  /// What a resumed run has to say of the files it found; empty when nothing.
  const std::string& note() const { return note_; }
  /// A line for each warning of the run, body names written out.
  std::vector<std::string> warnings() const;
  RunSummary summary() const;
  const Assembly& assembly() const { return *assembly_; }

 private:
  struct Files;
  /// from: the checkpoint to continue from, null for a new run. Files are opened, observers added.
  Session(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides, std::filesystem::path folder,
          const CheckpointHeader* from, Output output);
  void add_observers();
  void write_contact_problem() const;
  void save_checkpoint_now();
  void walk(StateVisitor& visitor);
  bool goes_on(const SessionLimits& limits, std::initializer_list<std::uint64_t> intervals) const;
  Ending take_steps(const SessionLimits& limits, Progress& progress);
  std::optional<Ending> step_once(std::uint64_t last_step, bool run_on);
  Ending fail(const Failure& failure);
  Ending end_off_track(const Failure& failure);
  void set_trouble(const Failure& failure);
  std::optional<Ending> reason_to_stop(const SessionLimits& limits) const;
  double elapsed() const;

  std::unique_ptr<Assembly> assembly_;
  std::vector<std::string> overrides_;
  std::filesystem::path folder_;
  Output output_;
  std::string scene_hash_;
  std::unique_ptr<Files> files_;
  RunMonitor* monitor_ = nullptr;
  std::unique_ptr<TrackWatch> tracks_;
  std::vector<MeasureRecorder*> recorders_;
  Ending ending_ = Ending::completed;
  std::string trouble_, note_;
  std::uint64_t first_step_ = 0;  ///< done before this session
  double first_body_steps_ = 0;
  std::uint64_t lost_ = 0;
  std::chrono::steady_clock::time_point start_;
  double wall_ = 0, cpu_ = 0;
};

/// Steps between two rows of a measure in the files: where the scene writes no interval, 10 000 rows at most.
std::uint64_t rows_apart(const MeasureSpec& spec, std::uint64_t steps);

/// Hash of everything that decides the run: scene text with includes, overrides.
std::string scene_hash(const Scene& scene);

}  // namespace epafi
