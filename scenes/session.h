/// @file session.h  One run on disk: a simulation with its observers and files, from start or from a checkpoint, to its
/// end.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/assemble.h"
#include "scenes/carry_over.h"
#include "scenes/progress.h"
#include "scenes/scene_hash.h"
#include "viz_export/hdf5/checkpoint.h"
#include "viz_export/output/output_observers.h"
#include "viz_export/report/summary.h"

namespace epafi {

class CourseRecorder;
class TrackWatch;

struct SessionLimits {
  std::optional<double> until = {};         ///< simulated time [s]
  std::optional<std::uint64_t> steps = {};  ///< steps of the whole run
  std::optional<double> wall = {};          ///< wall time of this session [s]
  std::optional<double> processor = {};     ///< processor time of this process, all threads [s]
};

/// Why a session ended.
/// stopped: a bound with then = "stop" was reached; the run is done.
enum class Ending { completed, stopped, until, bound_violated, failed, time_limit, interrupted, terminated };

class Session {
 public:
  /// Files of a run: all, or no frames and no snapshot but the last.
  enum class Output { all, least };
  /// A new run in an empty folder.
  Session(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides, std::filesystem::path folder,
          Output output = Output::all);
  /// Continues a run from folder/checkpoint.h5; `assembly` is the same scene assembled anew, at the stage that it is
  /// in.
  static std::unique_ptr<Session> resume(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides,
                                         std::filesystem::path folder);
  /// Continues with another scene: a change of this one (`inserted`), or one that starts from this run.
  void change(Scene next, const RunRecord& record, std::vector<std::string> overrides);
  /// Extends the last stage to this time [s] at least.
  void extend(double until);
  /// Extends the last stage to this number of steps of the run at least.
  void extend_to_step(std::uint64_t steps);
  /// Remaining time of the present stage [s]; until: end of the last stage at least.
  double rest(std::optional<double> until) const;
  const RunRecord& record() const { return record_; }
  /// True if the last stage is over.
  bool is_done() const;
  ~Session();

  Ending run(const SessionLimits& limits, bool quiet);
  /// Text of the failure or of the violated bound; empty when all is well.
  const std::string& trouble() const { return trouble_; }
  /// Message if the solver stopped above its tolerance: how often, how far, and which solver reaches it; else empty.
  std::string advice() const;
  /// Reason why a run ended early without failure; else empty.
  const std::string& stop_reason() const { return stop_reason_; }
  /// Remark on the files of a resumed run; or empty.
  const std::string& note() const { return note_; }
  /// A line for each warning of the run, body names written out.
  std::vector<std::string> warnings() const;
  RunSummary summary() const;
  const Assembly& assembly() const { return *assembly_; }

 private:
  struct Files;
  /// Opens files and adds observers. from: the checkpoint to continue from, null for a new run.
  Session(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides, std::filesystem::path folder,
          const CheckpointHeader* from, Output output);
  void add_observers();
  void write_contact_problem() const;
  CheckpointHeader header() const;
  void save_checkpoint_now();
  void keep_up_files();
  void walk(StateVisitor& visitor);
  bool goes_on(const SessionLimits& limits, std::initializer_list<std::uint64_t> intervals) const;
  Ending take_steps(const SessionLimits& limits, Progress& progress);
  void begin();
  void begin_record();
  void end_record(const std::string& how);
  bool next_stage();
  void enter(Scene next, const RunRecord& record);
  bool stage_is_met();
  bool is_final() const;  ///< no stage follows
  double last_value(const Condition& condition) const;
  std::uint64_t last_step() const { return record_.stages.back().first_step + assembly_->steps; }
  bool has_record() const;
  void keep_fills();
  void warn_of_end(const StageSpec& stage) const;
  void report_dropped(const std::vector<std::string>& dropped) const;
  void files_renew();  ///< for bodies and shapes of another assembly
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
  std::string trouble_, note_, stop_reason_;
  RunRecord record_;
  double met_since_ = -1.0;            ///< when the stage's condition began to hold, by its clock [s]; < 0: it does not
  bool quiet_ = false, fresh_ = true;  ///< fresh: the last good state is not one of this stage
  MeasureRecorder* watched_ = nullptr;  ///< of the stage's condition
  std::size_t component_ = 0;           ///< of it
  StateRecorder* frames_ = nullptr;
  CourseRecorder* course_ = nullptr;
  std::uint64_t first_step_ = 0;  ///< done before this session
  double first_body_steps_ = 0;
  std::uint64_t lost_ = 0;
  std::chrono::steady_clock::time_point start_;
  double wall_ = 0, cpu_ = 0;
};

/// Steps between two rows of a measure in the files; without `interval` in the scene at most 10 000 rows.
std::uint64_t rows_apart(const MeasureSpec& spec, std::uint64_t steps);

}  // namespace epafi
