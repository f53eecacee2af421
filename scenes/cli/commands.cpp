#include "scenes/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "engine/threads/parallel.h"
#include "engine/threads/start_threads.h"
#include "scenes/cli/check.h"
#include "scenes/cli/library.h"
#include "scenes/cli/list.h"
#include "scenes/cli/new_scene.h"
#include "scenes/cli/print.h"
#include "scenes/cli/reference.h"
#include "scenes/cli/schema_json.h"
#include "scenes/folder_lock.h"
#include "scenes/full_registry.h"
#include "scenes/last_state.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "scenes/several_ranks.h"
#include "scenes/spring_file.h"
#include "scenes/stage_check.h"
#include "scenes/start_run.h"
#include "scenes/stop.h"
#include "scenes/time_step.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/output/export.h"
#include "viz_export/report/report.h"

namespace epafi {

namespace {

constexpr const char* memory_message = "epafi: not enough memory; `epafi check` says what the scene needs\n";

void say(const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }

/// Prints problems; returns their number.
std::size_t print_problems(const std::vector<Problem>& problems) {
  for (const auto& p : problems) say(p.to_string());
  return problems.size();
}

/// Prints the warnings of later stages; returns their number. Warnings printed for the scene or another stage are left
/// out.
std::size_t print_warnings(const std::vector<StageCheck>& stages, std::vector<Problem> printed) {
  const std::size_t before = printed.size();
  for (const StageCheck& stage : stages)
    for (const Problem& p : stage.warnings) {
      if (std::ranges::count(printed, p.to_string(), &Problem::to_string) > 0) continue;
      say(p.to_string());
      printed.push_back(p);
    }
  return printed.size() - before;
}

/// The scene, or a SceneError with all its problems; warnings are printed, and added to `warnings`.
Scene read_or_throw(const std::string& path, const std::vector<std::string>& overrides,
                    std::size_t* warnings = nullptr) {
  ReadResult result = read_scene(existing_scene_file(path), overrides, full_registry());
  if (!result.scene) throw SceneError(result.problems);
  const std::size_t printed = print_problems(result.problems);
  if (warnings) *warnings += printed;
  return std::move(*result.scene);
}

int exit_code(Ending ending) {
  switch (ending) {
    case Ending::completed:
    case Ending::stopped:
    case Ending::until:
      return exit_done;
    case Ending::bound_violated:
      return exit_bound;
    case Ending::failed:
      return exit_failed;
    case Ending::time_limit:
      return exit_time_limit;
    case Ending::interrupted:
      return exit_interrupt;
    case Ending::terminated:
      return exit_terminate;
  }
  return exit_failed;
}

SessionLimits limits_of(const RunOptions& o) {
  const auto duration = [](const char* option, const std::string& text) -> std::optional<double> {
    if (text.empty()) return std::nullopt;
    const auto seconds = parse_duration(text);
    if (!seconds) throw SceneError(std::string(option) + " '" + text + "' is no duration; write 90s, 30m or 3h50m");
    return seconds;
  };
  return {o.until, o.steps, duration("--time-limit", o.time_limit), duration("--cpu-limit", o.cpu_limit)};
}

/// With --strict any warning of the scene or of the run counts as a violated bound.
int strict_code(int code, const RunOptions& options, std::size_t of_scene, std::size_t of_run) {
  if (!options.strict || code != exit_done || of_scene + of_run == 0) return code;
  say(fmt::format("epafi: exit code {} by --strict: {} warnings of the scene, {} of the run", int(exit_bound), of_scene,
                  of_run));
  return exit_bound;
}

/// scene_warnings: number printed before the first step.
int finish(Session& session, const std::filesystem::path& folder, const RunOptions& options,
           const SessionLimits& limits, std::size_t scene_warnings) {
  const Ending ending = session.run(limits, options.quiet);
  const RunSummary summary = session.summary();
  write_summary(folder / "summary.json", summary);
  for (const std::string& warning : summary.warnings) say("epafi: warning: " + warning);
  if (!session.trouble().empty()) say("epafi: " + session.trouble());
  if (!session.stop_reason().empty()) say("epafi: " + session.stop_reason());
  if (const std::string advice = session.advice(); !advice.empty()) say("epafi: warning: " + advice);
  if (summary.bodies_removed > 0 && !options.quiet)
    say(fmt::format("epafi: {} bodies were taken out, by remove_at, stages, outlets or the domain",
                    summary.bodies_removed));
  if (options.json)
    print(summary_json(summary) + "\n");
  else if (!options.quiet)
    say(fmt::format("{}: {} steps, t = {:.6g} s, {:.3g} s of wall time, energy error {:.2g}, state {}; results in {}",
                    summary.status, summary.steps, summary.simulated_time, summary.wall_time,
                    summary.energy->relative_error, summary.state_hash, folder.string()));
  return strict_code(exit_code(ending), options, scene_warnings, summary.warnings.size());
}

void set_threads(int threads) {
  if (threads > 0) set_thread_count(threads);
  if (!start_threads())
    throw FileError(
        fmt::format("cannot start {} threads: the limits of memory or processes of this shell are reached; "
                    "run with -t 1 or raise them (ulimit -a)",
                    thread_count()));
}

/// Removes the files of an earlier run; the folder of frames may hold others.
void remove_results(const std::filesystem::path& folder) {
  for (const char* name : {"run.h5", "checkpoint.h5", "measures.csv", "progress.csv", "summary.json", "frames.pvd"})
    std::filesystem::remove(folder / name);
  if (!std::filesystem::is_directory(folder / "frames")) return;
  std::vector<std::filesystem::path> frames;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "frames"))
    if (entry.path().extension() == ".vtp") frames.push_back(entry.path());
  for (const auto& frame : frames) std::filesystem::remove(frame);
  if (std::filesystem::is_empty(folder / "frames")) std::filesystem::remove(folder / "frames");
}

void note_thinned(const Assembly& assembly) {
  for (const MeasureSpec& m : assembly.scene.measures)
    if (const std::uint64_t apart = rows_apart(m, assembly.steps); apart > 1)
      say(
          fmt::format("measure '{}' has no interval: every step is evaluated, one of {} is written ({:.3g} s); "
                      "interval = 0 writes all",
                      m.name, apart, static_cast<double>(apart) * assembly.time_step.value));
}

/// Handler of uncaught exceptions, as in parallel loops: prints a message instead of aborting. Checkpoints stay valid,
/// since they are written aside and renamed.
[[noreturn]] void give_up() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
    std::fputs("epafi: stopped by an internal error\n", stderr);
  } catch (const std::bad_alloc&) {
    std::fputs(memory_message, stderr);
  } catch (const std::exception& e) {
    std::fprintf(stderr,
                 "epafi: stopped by an internal error: %s; checkpoints are kept; please report it with the scene\n",
                 e.what());
  } catch (...) {
    std::fputs("epafi: stopped by an internal error\n", stderr);
  }
  std::_Exit(exit_file);
}

/// Runs this process as a follower: makes its part of all steps until the run ends.
int follow(std::unique_ptr<Assembly> part) {
  std::signal(SIGINT, SIG_IGN);  // process 0 writes a checkpoint and ends the run
  std::signal(SIGTERM, SIG_IGN);
  while (true) {
    const RankTeam::Followed end = RankTeam::of_program()->follow(*part->simulation, part_setup(*part));
    if (end.announced.empty()) return end.code;
    part = part_of(end.announced);
  }
}

bool follows(const RankTeam* team) { return team != nullptr && team->number() > 0; }

}  // namespace

/// Runs a whole command in one team of threads: OpenMP's own threads, used outside a team, spin for milliseconds after
/// each loop, and for a time slice beside other programs.
template <class F>
int in_team(int threads, const F& command) {
  set_threads(threads);
  int code = exit_done;
  with_team([&] { code = command(); });
  return code;
}

static int run_scene(const CommonOptions& common, const RunOptions& options) {
  const SessionLimits limits = limits_of(options);
  std::size_t warnings = 0;
  auto assembly = assemble(read_or_throw(common.scene, common.overrides, &warnings));
  RankTeam* const team = RankTeam::of_program();
  if (team) check_shareable(*assembly);
  if (follows(team)) return follow(std::move(assembly));
  warnings += print_problems(assembly->warnings);
  check_conditions(*assembly);
  warnings += print_warnings(check_stages(assembly->scene), assembly->warnings);
  const std::filesystem::path folder = options.out.empty()
                                           ? std::filesystem::path("out") / std::filesystem::path(common.scene).stem()
                                           : std::filesystem::path(options.out);
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw SceneError("output folder '" + folder.string() + "' is a file; name another with -o");
  std::filesystem::create_directories(folder);
  const FolderLock lock(folder);
  if (!std::filesystem::is_empty(folder)) {
    if (!options.force)
      throw SceneError("output folder '" + folder.string() +
                       "' is not empty; name another with -o or allow it with --force");
    remove_results(folder);
  }
  if (options.verbose) say(explain(assembly->scene, assembly->plan, *assembly->shapes) + chosen_text(*assembly));
  if (!options.quiet)
    say(fmt::format("time step {:.4g} s: {}; {} steps", assembly->time_step.value, assembly->time_step.reason,
                    assembly->steps));
  if (!options.quiet) note_thinned(*assembly);
  const SignalWatch from_the_first_file_on;
  if (team) share_out(*assembly, assemble(read_or_throw(common.scene, common.overrides)), *team);
  Session session(std::move(assembly), common.overrides, folder,
                  options.least_output ? Session::Output::least : Session::Output::all);
  return finish(session, folder, options, limits, warnings);
}

int command_run(const CommonOptions& common, const RunOptions& options) {
  return in_team(options.threads, [&] { return run_scene(common, options); });
}

namespace {

/// Inserts a stage with these changes after the present one; returns its number of warnings.
std::size_t change_keys(Session& session, const CheckpointHeader& header, const std::vector<std::string>& overrides,
                        const SessionLimits& limits) {
  RunRecord record = session.record();
  const double rest = session.rest(limits.until);
  if (!(rest > 0.0)) throw SceneError("the run is at its end; say how far it goes on with --until");
  record.inserted.push_back({record.stage, rest, session.assembly().scene.run.output_interval.value, overrides});
  ReadResult read = read_scene(header.scene_path, header.overrides, full_registry(),
                               {record.stage + 1, record.inserted, record.start_run});
  if (!read.scene) throw SceneError(read.problems);
  const std::size_t warnings = print_problems(read.problems);
  session.change(std::move(*read.scene), record, header.overrides);
  return warnings;
}

/// Continues with another scene from the state of this run, which is kept under another name for later resumes. Returns
/// the number of warnings of the scene.
std::size_t change_scene(Session& session, const std::string& path, const std::vector<std::string>& overrides,
                         const std::filesystem::path& folder) {
  if (!std::filesystem::exists(path)) throw FileError("the scene file '" + path + "' does not exist");
  std::filesystem::path kept;
  for (int n = 1; kept.empty() || std::filesystem::exists(kept); ++n)
    kept = folder / fmt::format("checkpoint-{}.h5", n);
  std::filesystem::copy_file(folder / "checkpoint.h5", kept);
  RunRecord record;
  record.start_run = std::filesystem::absolute(kept).string();
  try {
    ReadResult read = read_scene(path, overrides, full_registry(), {0, {}, record.start_run});
    if (!read.scene) throw SceneError(read.problems);
    const std::size_t warnings = print_problems(read.problems) + print_warnings(check_stages(*read.scene), {});
    session.change(std::move(*read.scene), record, overrides);
    return warnings;
  } catch (...) {
    std::filesystem::remove(kept);
    throw;
  }
}

}  // namespace

/// True where the run is complete.
static bool is_over(const CheckpointHeader& header, const RunRecord& record, const Assembly& assembly) {
  if (assembly.scene.stage + 1 < assembly.scene.stages.size()) return false;
  if (record.stages.empty()) return header.step >= assembly.steps;
  const StageRecord& now = record.stages.back();
  return !now.ended.empty() || header.step >= now.first_step + assembly.steps;
}

/// Says that a run is complete, and how to continue it.
static void say_complete(const CheckpointHeader& header, const RunRecord& record, const std::string& directory) {
  const bool by_condition = !record.stages.empty() && record.stages.back().ended == "condition";
  const std::string onwards =
      by_condition ? "it ended by its condition: --set KEY=VALUE changes something and goes on"
                   : fmt::format("`epafi resume {} --steps N` takes N more, --until T goes on to that time", directory);
  say(fmt::format("epafi: the run in {} is complete: {} steps, t = {:.6g} s; nothing is changed; {}", directory,
                  header.step, header.time, onwards));
}

static int resume_run(const std::string& directory, const RunOptions& options, const ResumeChanges& changes) {
  const std::filesystem::path folder(directory);
  RankTeam* const team = RankTeam::of_program();
  std::optional<FolderLock> lock;
  check_is_run(folder);
  if (!follows(team)) lock.emplace(folder);
  const CheckpointHeader header = read_checkpoint_header(folder / "checkpoint.h5");
  const RunRecord record = RunRecord::from_text(header.record);
  Scene scene = scene_of(header, record);
  AssembleOptions ready = options_of(record);
  ready.keep_fill_bodies = !changes.overrides.empty();  // the stage that begins here needs them
  auto assembly = assemble(std::move(scene), ready);
  SessionLimits limits = limits_of(options);
  if (team) check_shareable(*assembly);
  if (options.steps) limits.steps = header.step + *options.steps;  // so many more
  const bool changed = !changes.scene.empty() || !changes.overrides.empty();
  const bool longer = options.steps || (limits.until && *limits.until > header.time);
  if (is_over(header, record, *assembly) && !changed && !longer) {
    say_complete(header, record, directory);
    return exit_done;
  }
  const bool is_final = assembly->scene.stage + 1 >= assembly->scene.stages.size();
  if (limits.steps && is_final && !changed) {
    const std::uint64_t first = record.stages.empty() ? 0 : record.stages.back().first_step;
    assembly->steps = std::max(assembly->steps, *limits.steps - first);
  }
  if (follows(team)) return follow(std::move(assembly));
  const SignalWatch from_the_first_file_on;
  if (team) share_out(*assembly, assemble(scene_of(header, record), ready), *team);
  auto session = Session::resume(std::move(assembly), header.overrides, folder);
  std::size_t warnings = session->note().empty() ? 0 : 1;
  if (warnings > 0) say("epafi: warning: " + session->note());
  if (!changes.scene.empty())
    warnings += change_scene(*session, changes.scene, changes.overrides, folder);
  else if (!changes.overrides.empty())
    warnings += change_keys(*session, header, changes.overrides, limits);
  if (limits.until) session->extend(*limits.until);
  if (limits.steps) session->extend_to_step(*limits.steps);
  return finish(*session, folder, options, limits, warnings);
}

int command_resume(const std::string& directory, const RunOptions& options, const ResumeChanges& changes) {
  return in_team(options.threads, [&] { return resume_run(directory, options, changes); });
}

int command_check(const CommonOptions& common) {
  auto assembly = assemble(read_or_throw(common.scene, common.overrides));
  print_problems(assembly->warnings);
  check_conditions(*assembly);
  const auto later = check_stages(assembly->scene);
  print_warnings(later, assembly->warnings);
  std::string text = check_text(*assembly, later);
  for (const StageCheck& stage : later) text += stage.text;
  print(text);
  return exit_done;
}

int command_explain(const CommonOptions& common) {
  const auto assembly = assemble(read_or_throw(common.scene, common.overrides));
  std::string text = explain(assembly->scene, assembly->plan, *assembly->shapes) + chosen_text(*assembly);
  for (const StageCheck& stage : check_stages(assembly->scene)) text += stage.explained;
  print(text);
  return exit_done;
}

int command_list(const std::string& kind) {
  if (kind == "scenes") {
    print(list_scenes());
    return exit_done;
  }
  print(list_text(full_registry(), kind));
  return exit_done;
}

int command_schema() {
  print(json_schema(full_registry()));
  return exit_done;
}

int command_new(const std::string& kind) {
  print(starter_scene(kind));
  return exit_done;
}

int command_export(const std::string& directory, const std::string& format) {
  const bool tables = format == "csv";
  const LastState last = tables ? last_state(directory) : LastState{};
  const ExportReport report = export_run(directory, tables ? ExportFormat::csv : ExportFormat::vtk, last.bodies);
  const auto counted = [](std::size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  const std::string measures = tables ? " and " + counted(report.measures, "measure") : "";
  say(fmt::format("{}{} exported from {}/run.h5", counted(report.snapshots, "snapshot"), measures, directory));
  if (!last.note.empty()) say("epafi: note: " + last.note);
  for (const std::string& note : report.notes) say("epafi: note: " + note);
  if (!tables) return exit_done;
  if (const std::string note = export_springs(directory); !note.empty()) say("epafi: note: " + note);
  return exit_done;
}

int command_report(const std::string& directory, const std::string& page) {
  say(write_report(directory, page).string());
  return exit_done;
}

int command_reference(const std::string& directory, const std::string& broken_scenes) {
  auto pages = reference_pages(full_registry());
  if (!broken_scenes.empty()) pages.emplace_back("messages.md", messages_page(broken_scenes));
  std::filesystem::create_directories(directory);
  for (const auto& [name, text] : pages) write_whole_file(std::filesystem::path(directory) / name, {text});
  return exit_done;
}

int guarded(const std::function<int()>& command) {
  std::set_terminate(give_up);
  try {
    const int code = command();
    flush_printed();
    return code;
  } catch (const SceneError& e) {
    say(e.what());
    return exit_usage;
  } catch (const FileError& e) {
    say(std::string("epafi: ") + e.what());
    return exit_file;
  } catch (const std::filesystem::filesystem_error& e) {
    say(std::string("epafi: ") + e.what());
    return exit_file;
  } catch (const std::bad_alloc&) {
    std::fputs(memory_message, stderr);
    return exit_file;
  } catch (const std::length_error&) {  // more than any memory holds
    std::fputs(memory_message, stderr);
    return exit_file;
  }
}

}  // namespace epafi
