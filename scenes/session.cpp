#include "scenes/session.h"
#include "scenes/law_potential.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/ranks/rank_team.h"
#include "engine/state/hash.h"
#include "engine/state/state_snapshot.h"
#include "engine/step/contact_layer.h"
#include "engine/threads/parallel.h"
#include "laws/nonsmooth/assembled.h"
#include "laws/nonsmooth/nonsmooth_contact.h"
#include "scenes/about.h"
#include "scenes/frames_to_the_end.h"
#include "scenes/peak_memory.h"
#include "scenes/processor_time.h"
#include "scenes/railway/on_rails.h"
#include "scenes/railway/rolling.h"
#include "scenes/stop.h"
#include "scenes/version.h"
#include "scenes/watch_parts.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/problem_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/output/course_recorder.h"

namespace epafi {

namespace {

/// Number of steps in `interval` [s], from 1 to 1e15.
std::uint64_t steps_of(double interval, double dt) {
  return static_cast<std::uint64_t>(std::clamp(std::round(interval / dt), 1.0, 1e15));
}

/// The run file of a continued run. A damaged file is set aside: the new one lacks its data, but the state is not lost.
RunFile continued_run(const std::filesystem::path& path, const RunFileHeader& header, const CheckpointHeader& from,
                      std::string& note) {
  const std::string damage = damage_of(path);
  if (damage.empty()) return {path, header, from.step, from.time};
  const std::filesystem::path aside = path.string() + ".damaged";
  std::error_code none;
  std::filesystem::rename(path, aside, none);
  note = none ? path.string() + ": is missing;" : damage + "; it is kept as " + aside.filename().string() + ",";
  note += " a new one begins at step " + std::to_string(from.step);
  return {path, header};
}

/// Continues the file where it exists: older versions wrote none.
std::unique_ptr<MeasuresCsv> course_file(const std::filesystem::path& path, const CheckpointHeader* from) {
  const bool goes_on = from != nullptr && std::filesystem::exists(path);
  return goes_on ? std::make_unique<MeasuresCsv>(path, from->time) : std::make_unique<MeasuresCsv>(path);
}

}  // namespace

std::uint64_t rows_apart(const MeasureSpec& spec, std::uint64_t steps) {
  constexpr std::uint64_t most_rows = 10'000;
  return spec.thinned ? (steps + most_rows - 1) / most_rows : 1;
}

struct Session::Files {
  MeasuresCsv csv;
  RunFile run;
  FrameWriter frames;
  StateSnapshot last_good;
  RunMark mark;
  std::unique_ptr<MeasuresCsv> course{};  ///< null: none is written
  OutputThread beside{};                  ///< writes run and frames; last: it ends before them
};

Session::Session(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides, std::filesystem::path folder,
                 const CheckpointHeader* from, Output output)
    : assembly_(std::move(assembly)), overrides_(std::move(overrides)), folder_(std::move(folder)), output_(output) {
  std::filesystem::create_directories(folder_);
  const Scene& scene = assembly_->scene;
  const bool known = from && (scene.stage > 0 || has_hash(scene, from->scene_hash));
  scene_hash_ = known ? from->scene_hash : scene_hash(scene);
  const RunFileHeader header{
      version(), scene_hash_, scene.title, scene.text, overrides_, to_text(about_of(*assembly_)), assembly_->origins};
  if (from)
    files_.reset(new Files{MeasuresCsv(folder_ / "measures.csv", from->time),
                           continued_run(folder_ / "run.h5", header, *from, note_), FrameWriter(folder_, from->time),
                           StateSnapshot(folder_ / ".last_good"), RunMark(folder_)});
  else
    files_.reset(new Files{MeasuresCsv(folder_ / "measures.csv"), RunFile(folder_ / "run.h5", header),
                           FrameWriter(folder_), StateSnapshot(folder_ / ".last_good"), RunMark(folder_)});
  files_->run.write_beside(files_->beside);
  if (output_ == Output::all) files_->course = course_file(folder_ / "progress.csv", from);
  if (from) record_ = RunRecord::from_text(from->record);
  if (record_.stages.empty()) begin_record();
  add_observers();
  tracks_ = std::make_unique<TrackWatch>(*assembly_);
  if (from && assembly_->scene.start) assembly_->scene.start->made.reset();
  std::vector<BodySpec>().swap(assembly_->scene.bodies);  // they are in the world now: 184 bytes each, more than there
}

Session::Session(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides, std::filesystem::path folder,
                 Output output)
    : Session(std::move(assembly), std::move(overrides), std::move(folder), nullptr, output) {
  begin();
}

std::unique_ptr<Session> Session::resume(std::unique_ptr<Assembly> assembly, std::vector<std::string> overrides,
                                         std::filesystem::path folder) {
  const std::filesystem::path file = folder / "checkpoint.h5";
  const CheckpointHeader header = read_checkpoint_header(file);
  const bool later = assembly->scene.stage > 0;  // its positions are those of no scene
  const bool same = later || has_hash(assembly->scene, header.scene_hash);
  const std::string expected = same ? header.scene_hash : scene_hash(assembly->scene);
  std::unique_ptr<Session> s(
      new Session(std::move(assembly), std::move(overrides), std::move(folder), &header, Output::all));
  load_checkpoint(file, expected, [&](StateVisitor& v) { s->walk(v); });
  if (header.version != version())
    s->note_ +=
        (s->note_.empty() ? "" : "; ") + ("the checkpoint is of version " + header.version + ", this is " + version() +
                                          ": from here on bits may differ from those of an uninterrupted run");
  s->first_step_ = s->assembly_->simulation->steps();
  s->first_body_steps_ = s->monitor_->body_steps();
  return s;
}

Session::~Session() = default;

bool Session::is_final() const { return assembly_->scene.stage + 1 >= assembly_->scene.stages.size(); }

bool Session::is_done() const {
  return is_final() && (assembly_->simulation->steps() >= last_step() || !record_.stages.back().ended.empty());
}

void Session::files_renew() {
  files_->beside.wait();
  files_->run.renew_shapes(assembly_->origins);
  files_->last_good = StateSnapshot(folder_ / ".last_good");
}

void Session::walk(StateVisitor& visitor) {
  files_->beside.wait();  // the frames are a part of the state
  assembly_->simulation->visit(visitor);
  files_->frames.visit(visitor);
  if (watched_) visitor.value("session/met_since", met_since_);
}

namespace {

const ContactModel& under_layers(const Simulation& sim) {
  const ContactModel* model = sim.pipeline.contact_model.get();
  while (const auto* layer = dynamic_cast<const ContactLayer*>(model)) model = &layer->below();
  return *model;
}
}  // namespace

void Session::add_observers() {
  const Scene& scene = assembly_->scene;
  Simulation& sim = *assembly_->simulation;
  const double dt = sim.time_step;
  std::vector<BodyIds> bound_bodies;
  for (const auto& b : scene.bounds) bound_bodies.push_back(assembly_->ids(b.bodies));
  for (const auto& b : scene.accuracy) bound_bodies.push_back(assembly_->ids(b.bodies));
  const std::uint64_t frame_every = steps_of(scene.run.output_interval.value, dt);
  const std::uint64_t first = record_.stages.back().first_step;
  const RunMonitor::Setup setup{last_step(), std::min<std::uint64_t>(50, frame_every), least_radius(*assembly_),
                                swing_on_springs(*assembly_), way_to_a_potential(*assembly_)};
  auto monitor = std::make_unique<RunMonitor>(scene, bound_bodies, *assembly_->shapes, setup, sim.warnings);
  monitor->read_measures([this](const Condition& c) { return last_value(c); });
  monitor_ = monitor.get();
  if (scene.contact.method.value == Method::smooth)
    sim.events.push_back(std::make_unique<WatchParts>(*assembly_, setup.least_radius, setup.interval));
  sim.observers.push_back(std::move(monitor));
  if (files_->course) {
    const bool smooth = scene.contact.method.value == Method::smooth;
    const auto overlap = [this] { return monitor_->last_overlap().max_relative; };
    auto course = std::make_unique<CourseRecorder>(*files_->course,
                                                   CourseRecorder::Setup{setup.steps, setup.interval, smooth, overlap});
    course_ = course.get();
    sim.observers.push_back(std::move(course));
  }
  for (const auto& spec : scene.measures) {
    const std::uint64_t written = rows_apart(spec, assembly_->steps);
    auto recorder =
        std::make_unique<MeasureRecorder>(spec.name, assembly_->measure(spec), &files_->csv, &files_->run,
                                          EverySteps::of_time(spec.interval, dt, first), spec.kind, written);
    recorders_.push_back(recorder.get());
    if (const auto& until = scene.stages[scene.stage].until; until && until->measure == spec.name) {
      watched_ = recorder.get();
      component_ = recorder->component(until->component);
    }
    sim.observers.push_back(std::move(recorder));
  }
  if (output_ != Output::all) return;
  const double interval = scene.run.output_interval.value;
  auto frames = std::make_unique<StateRecorder>(
      &files_->run, &files_->frames, *assembly_->shapes, EverySteps::of_time(interval, dt, first),
      [&sim] { return contact_residuals(under_layers(sim)); }, scene.stages[scene.stage].name);
  frames_ = frames.get();
  frames_->write_beside(files_->beside);
  if (ends_between_steps(scene.run.duration.value, interval, dt))
    sim.observers.push_back(std::make_unique<FramesToTheEnd>(std::move(frames), last_step()));
  else
    sim.observers.push_back(std::move(frames));
}

/// Last value of a measure; NaN where there is none yet.
double Session::last_value(const Condition& condition) const {
  for (const MeasureRecorder* r : recorders_) {
    const std::size_t k = r->component(condition.component);
    if (r->name() == condition.measure && k < r->components()) return r->last(k);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string Session::advice() const {
  if (monitor_->not_converged() == 0) return {};
  const Simulation& sim = *assembly_->simulation;
  const std::string would_do = solver_advice(under_layers(sim));
  return fmt::format("solver {}: {} of {} steps ended above its tolerance, worst residual {:.2g}{}{}",
                     assembly_->scene.contact.solver.value, monitor_->not_converged(), sim.steps(),
                     monitor_->residual_max(), would_do.empty() ? "" : "; ", would_do);
}

/// Writes the contact problem of the last step, for `epafi solve`: problems/<scene>-i<step>-<contacts>.hdf5.
void Session::write_contact_problem() const {
  const Simulation& sim = *assembly_->simulation;
  const ContactProblem* problem = last_problem(under_layers(sim));
  if (problem == nullptr || problem->size() == 0) return;
  const std::string scene = std::filesystem::path(assembly_->scene.file).stem().string();
  files_->beside.wait();
  std::filesystem::create_directories(folder_ / "problems");
  write_problem(folder_ / "problems" / fmt::format("{}-i{:06}-{}.hdf5", scene, sim.steps(), problem->size()),
                assemble_global(*problem),
                fmt::format("{}, step {}, t = {:.9g} s", scene, sim.steps(), sim.world.time));
}

CheckpointHeader Session::header() const {
  const Simulation& sim = *assembly_->simulation;
  const Scene& scene = assembly_->scene;
  return {version(),   scene_hash_,    std::filesystem::absolute(scene.file).string(),  scene.text, overrides_,
          sim.steps(), sim.world.time, has_record() ? record_.to_text() : std::string()};
}

void Session::save_checkpoint_now() {
  files_->beside.wait();
  files_->csv.flush();
  if (files_->course) files_->course->flush();
  files_->run.flush();
  save_checkpoint(folder_ / "checkpoint.h5", header(), [this](StateVisitor& v) { walk(v); });
  files_->last_good.save([this](StateVisitor& v) { walk(v); });  // a failure does not go back behind the checkpoint
}

double Session::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::optional<Ending> Session::reason_to_stop(const SessionLimits& limits) const {
  const Simulation& sim = *assembly_->simulation;
  if (const int signal = SignalWatch::received()) return signal == 2 ? Ending::interrupted : Ending::terminated;
  if (limits.wall && elapsed() >= *limits.wall) return Ending::time_limit;
  if (limits.processor && process_seconds() >= *limits.processor) return Ending::time_limit;
  if (limits.steps && sim.steps() >= *limits.steps) return Ending::until;
  if (limits.until && sim.world.time >= *limits.until - 1e-9 * sim.time_step) return Ending::until;
  return std::nullopt;
}

namespace {
constexpr std::uint64_t keep_every = 1000;  // a copy of 20 000 spheres takes 2 ms: 0.1 % of 1000 steps
}

/// True where neither limits nor intervals need the state after the next step.
bool Session::goes_on(const SessionLimits& limits, std::initializer_list<std::uint64_t> intervals) const {
  const Simulation& sim = *assembly_->simulation;
  const std::uint64_t next = sim.steps() + 1;
  for (const std::uint64_t every : intervals)
    if (every > 0 && next % every == 0) return false;
  if (limits.steps && next >= *limits.steps) return false;
  return !limits.until || sim.world.time + (1.0 + 1e-6) * sim.time_step < *limits.until;
}

std::optional<Ending> Session::step_once(std::uint64_t last_step, bool run_on) {
  Simulation& sim = *assembly_->simulation;
  if (sim.steps() % keep_every == 0 || fresh_) files_->last_good.save([this](StateVisitor& v) { walk(v); });
  fresh_ = false;
  if (const auto failure = sim.advance(sim.steps() + 1 == last_step, run_on)) return fail(*failure);
  if (const auto failure = sim.is_ahead() ? std::nullopt : tracks_->look(sim.steps())) return end_off_track(*failure);
  if (const auto bound = monitor_->violated()) {
    trouble_ = fmt::format("[bounds] {}: {:.6g} exceeds {:.6g} at t = {:.6g} s (step {})", bound->name, bound->value,
                           bound->bound, sim.world.time, sim.steps());
    return Ending::bound_violated;
  }
  if (const auto bound = monitor_->reached()) {
    stop_reason_ =
        fmt::format("[bounds] {}: {:.6g} has passed {:.6g} at t = {:.6g} s (step {}): the run stops, as asked",
                    bound->name, bound->value, bound->bound, sim.world.time, sim.steps());
    return Ending::stopped;
  }
  return std::nullopt;
}

/// Sets the text of a failure, with its body and the component that computed it.
void Session::set_trouble(const Failure& failure) {
  trouble_ = fmt::format("{}: {}{}", failure.kind, failure.text,
                         failure.body ? " ('" + body_name(*assembly_, *failure.body) + "')" : "");
  const ContactSettings& contact = assembly_->scene.contact;
  trouble_ +=
      contact.method.value == Method::smooth ? "; law " + contact.law.value : "; solver " + contact.solver.value;
}

/// The state of a derailed wheelset is valid: it is saved as it is.
Ending Session::end_off_track(const Failure& failure) {
  set_trouble(failure);
  trouble_ += fmt::format("; the state of step {} is saved in checkpoint.h5", assembly_->simulation->steps());
  return Ending::failed;
}

/// Restores the last good state.
Ending Session::fail(const Failure& failure) {
  set_trouble(failure);
  lost_ = failure.kind == "lost body" ? 1 : 0;
  const Warnings met = assembly_->simulation->warnings;  // those since the saved state count too
  if (files_->last_good.saved()) files_->last_good.restore([this](StateVisitor& v) { walk(v); });
  assembly_->simulation->warnings = met;
  trouble_ += fmt::format("; the state of step {} is saved in checkpoint.h5", assembly_->simulation->steps());
  return Ending::failed;
}

/// Updates the files that other programs read during the run, each second.
void Session::keep_up_files() {
  files_->csv.flush_each_second();
  if (files_->course) files_->course->flush_each_second();
  if (files_->mark.beat() && !assembly_->simulation->warnings.empty()) files_->mark.tell(warnings());
}

Ending Session::take_steps(const SessionLimits& limits, Progress& progress) {
  Simulation& sim = *assembly_->simulation;
  const auto interval = assembly_->scene.run.checkpoint_interval;
  const std::uint64_t checkpoint_every = interval ? steps_of(*interval, sim.time_step) : 0;
  const auto& problems = assembly_->scene.output.problems_every;
  const std::uint64_t problems_every = problems ? steps_of(problems->value, sim.time_step) : 0;
  while (sim.steps() < last_step()) {
    const auto reason = reason_to_stop(limits);
    if (reason && !sim.is_ahead()) return *reason;
    const bool last = sim.steps() + 1 == last_step();
    const bool run_on = !reason && !last && goes_on(limits, {keep_every, problems_every, checkpoint_every});
    if (const auto stop = step_once(is_final() ? last_step() : 0, run_on)) return *stop;
    progress.update(sim, *monitor_);
    keep_up_files();
    if (problems_every > 0 && sim.steps() % problems_every == 0) write_contact_problem();
    if (stage_is_met()) return Ending::completed;
    if (checkpoint_every > 0 && sim.steps() % checkpoint_every == 0) save_checkpoint_now();
  }
  return Ending::completed;
}

namespace {
/// Shows the last state of an interrupted run to its monitor.
class LastLook final : public Observer {
 public:
  explicit LastLook(RunMonitor& monitor) : monitor_(monitor) {}
  bool is_due(std::uint64_t) const override { return true; }
  ContactView wants_contacts(std::uint64_t, bool) const override { return ContactView::none; }
  void observe(const StepView& view) override { monitor_.report_balance(view); }

 private:
  RunMonitor& monitor_;
};
}  // namespace

Ending Session::run(const SessionLimits& limits, bool quiet) {
  SignalWatch signals;
  std::error_code none;
  std::filesystem::remove(folder_ / "summary.json", none);  // of a run that goes on it shows the end no more
  start_ = std::chrono::steady_clock::now();
  quiet_ = quiet;
  const double first_cpu = process_seconds();
  Progress progress(last_step(), first_step_, quiet);
  with_team([&] {
    do {
      progress.enter(record_.stages.back().name, record_.stages.back().first_step, last_step());
      ending_ = record_.stages.back().ended.empty() ? take_steps(limits, progress) : Ending::completed;
      // a run interrupted between two stages is saved at the end of the first one
      if (const auto reason = reason_to_stop(limits); reason && ending_ == Ending::completed && !is_final())
        ending_ = *reason;
    } while (ending_ == Ending::completed && next_stage());
    files_->beside.wait();
  });
  Simulation& sim = *assembly_->simulation;
  if (ending_ == Ending::stopped) end_record("condition");
  record_.stages.back().until = sim.world.time;
  wall_ = elapsed();
  cpu_ = process_seconds() - first_cpu;
  // saved first: measuring extends the reference of the energy error, and a continued run must not show an interruption
  const bool is_cut = !is_done() && ending_ != Ending::failed && ending_ != Ending::bound_violated;
  if (is_cut) save_checkpoint_now();
  sim.gather_state();
  report_late_sources(*assembly_);
  sim.measure();
  if (course_ && ending_ != Ending::failed) sim.show(*course_);
  // measures and frames include the state that violated a bound, whatever their interval
  if (ending_ == Ending::stopped || ending_ == Ending::bound_violated) {
    for (MeasureRecorder* recorder : recorders_) sim.show(*recorder);
    const bool at_end = is_final() && sim.steps() >= last_step();
    if (frames_ && !at_end && !frames_->is_due(sim.steps())) sim.show(*frames_);
  }
  if (const auto failure = is_cut ? sim.check_energy() : std::nullopt) {
    ending_ = fail(*failure);
    save_checkpoint_now();
  } else if (is_cut) {
    LastLook look(*monitor_);
    sim.show(look);
  }
  if (output_ == Output::least) {
    files_->beside.wait();
    StateRecorder last(&files_->run, nullptr, *assembly_->shapes, EverySteps());
    sim.show(last);
  }
  progress.finish(sim, *monitor_);
  if (!is_cut) save_checkpoint_now();
  return ending_;
}

std::vector<std::string> Session::warnings() const {
  std::vector<std::string> out;
  for (const Warning& w : assembly_->simulation->warnings.all())
    out.push_back(warning_line(w, w.body ? body_name(*assembly_, *w.body) : std::string()));
  return out;
}

namespace {

const char* status_of(Ending ending) {
  if (ending == Ending::completed || ending == Ending::until || ending == Ending::stopped) return "completed";
  if (ending == Ending::bound_violated) return "bound_violated";
  return ending == Ending::failed ? "failed" : "interrupted";
}

}  // namespace

RunSummary Session::summary() const {
  const Simulation& sim = *assembly_->simulation;
  const bool smooth = assembly_->scene.contact.method.value == Method::smooth;
  RunSummary s;
  s.epafi = version();
  s.scene = assembly_->scene.file;
  s.scene_hash = scene_hash_;
  s.failure = trouble_;
  s.status = status_of(ending_);
  s.warnings = warnings();
  s.stop_reason = stop_reason_;
  for (const StageRecord& r : record_.stages)
    if (has_record()) s.stages.push_back({r.name, r.from, r.until, r.ended});
  s.bodies = sim.world.size();
  s.bodies_lost = lost_;
  s.bodies_removed = sim.bodies_removed();
  s.steps = sim.steps();
  s.time_step = sim.time_step;
  s.simulated_time = sim.world.time;
  s.wall_time = wall_;
  s.threads = thread_count();
  s.cpu_time = cpu_;
  if (RankTeam* const team = RankTeam::of_program()) {
    s.ranks = team->figures();
    s.ranks_share = smooth ? "steps" : "search for contacts";
  }
  s.stage_seconds = sim.work.report.seconds;
  const double output = s.stage_seconds[Stage::output], body_steps = monitor_->body_steps() - first_body_steps_;
  if (body_steps > 0) s.ns_per_body_step = 1e9 * (wall_ - output) / body_steps;
  s.contacts_mean = monitor_->contacts_mean();
  const Energy& e = sim.ledger.last();
  s.energy = RunSummary::Energy{e.kinetic, e.potential, std::nullopt, e.dissipated,
                                e.work,    e.gained,    std::nullopt, sim.ledger.relative_error()};
  (smooth ? s.energy->elastic : s.energy->correction) = smooth ? e.elastic : e.correction;
  s.momentum_error = monitor_->momentum_error();
  const Overlap o = monitor_->overlap();
  s.overlap = RunSummary::Overlap{o.max, o.mean, o.max_relative};
  if (!smooth) {
    s.residual = RunSummary::MaxMean{monitor_->residual_max(), monitor_->residual_mean()};
    s.iterations = RunSummary::MaxMean{monitor_->iterations_max(), monitor_->iterations_mean()};
    s.unconverged_steps = monitor_->not_converged();
  }
  for (const auto* r : recorders_) s.measures[r->name()] = r->summary();
  const auto reached = monitor_->reached();  // it ended the run as asked
  for (const auto& c : monitor_->checks())
    s.checks[c.name] = {c.value, c.bound, c.ok || (reached && reached->name == c.name)};
  for (const auto& c : monitor_->accuracy()) s.accuracy[c.name] = {c.value, c.bound, c.ok};
  s.peak_memory_bytes = peak_memory();
  s.state_hash = state_hash(sim.world);
  return s;
}

}  // namespace epafi
