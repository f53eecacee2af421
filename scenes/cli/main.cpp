#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "scenes/cli/commands.h"
#include "scenes/cli/manual.h"
#include "scenes/cli/narrow.h"
#include "scenes/cli/study_commands.h"

namespace {

/// The flags that several commands share.
void add_scene_flags(CLI::App* command, epafi::CommonOptions& o) {
  command->add_option("scene", o.scene, "scene file (TOML)")->required();
  command->add_option("--set", o.overrides, "override a value, KEY.PATH=VALUE (repeatable)")->allow_extra_args(false);
}

void add_run_flags(CLI::App* command, epafi::RunOptions& o) {
  command->add_option("-t,--threads", o.threads, "threads (default: all cores)")->check(CLI::PositiveNumber);
  command->add_option("--until", o.until, "stop at this simulated time [s], with a checkpoint");
  command->add_option("--steps", o.steps, "stop after this many steps, with a checkpoint");
  command->add_option("--time-limit", o.time_limit,
                      "stop after this wall time (90s, 3h50m) with a checkpoint, exit code 75");
  command->add_flag("-q,--quiet", o.quiet, "no progress");
  command->add_flag("-v,--verbose", o.verbose, "more about the set-up");
  command->add_flag("--json", o.json, "print the summary on stdout, nothing else there");
}

void add_solve_flags(CLI::App* command, epafi::SolveOptions& o) {
  command->add_option("problems", o.problems, "problem files")->required();
  command->add_option("-m,--method", o.methods, "solvers, by name; `all` for every one (default auto)")->delimiter(',');
  command->add_option("--tolerance", o.tolerance, "residual to reach (default 1e-6)")->check(CLI::NonNegativeNumber);
  command->add_option("--max-iterations", o.max_iterations, "iterations at most")->check(CLI::PositiveNumber);
  command->add_option("--time-limit", o.time_limit, "CPU time of each solve (1s, 0.5s, 2m; default 10s)");
  command->add_option("--solution", o.solution, "write <problem>/reaction to this HDF5 file");
  command->add_option("-o,--out", o.out, "write the rows to this file");
  command->add_flag("--json", o.json, "rows as JSON");
}

void add_study_flags(CLI::App* command, epafi::StudyOptions& o, const char* what) {
  command->add_option(what, o.files, "file (TOML)")->required();
  command->add_option("--set", o.overrides, "override a value, KEY.PATH=VALUE (repeatable)")->allow_extra_args(false);
  command->add_option("-o,--out", o.out, "output folder");
  command->add_flag("-q,--quiet", o.quiet, "no progress");
  command->add_flag("--force", o.force, "run finished cases again");
}

/// The parser's own knowledge, for the manual and the completion.
epafi::ProgramText described(const CLI::App& app) {
  epafi::ProgramText program{app.get_description(), {}};
  for (const CLI::App* command : app.get_subcommands({})) {
    epafi::CommandText text{command->get_name(), command->get_description(), {}};
    for (const CLI::Option* option : command->get_options())
      if (option->get_name(false, true) != "--help,-h" && option->get_name(false, true) != "-h,--help")
        text.options.push_back({option->get_name(true, true), option->get_description(), option->get_items_expected_max() > 0,
                                option->get_positional()});
    program.commands.push_back(std::move(text));
  }
  return program;
}

void add_atlas_flags(CLI::App* command, epafi::StudyOptions& o) {
  command->get_option("study")->required(false);
  command->add_flag("--all", o.all, "every study, its table and picture into the atlas; says what has moved");
  command->add_option("--budget", o.budget, "wall time of --all (default 30m)");
  command->add_option("--studies", o.studies, "folder of the studies (default scenes/library/studies)");
  command->add_option("--atlas", o.atlas, "folder of the atlas (default docs/atlas)");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace epafi;
  CLI::App app{"Epafi, a many-body contact engine", "epafi"};
  app.set_version_flag("--version", std::string(EPAFI_VERSION));
  app.require_subcommand(1);
  CommonOptions common;
  RunOptions run;
  PatchOptions patch;
  SolveOptions solve;
  std::string directory, kind, format = "vtk";

  auto* run_command = app.add_subcommand("run", "simulate headlessly");
  add_scene_flags(run_command, common);
  add_run_flags(run_command, run);
  run_command->add_option("-o,--out", run.out, "output folder (default out/<scene name>)");
  run_command->add_flag("--least-output", run.least_output, "no frames, no snapshot but the last");
  run_command->add_flag("--force", run.force, "use an output folder that is not empty");
  auto* resume_command = app.add_subcommand("resume", "continue a run from its last good checkpoint");
  resume_command->add_option("dir", directory, "output folder of the run")->required();
  add_run_flags(resume_command, run);
  auto* check_command =
      app.add_subcommand("check", "everything wrong with a scene, its time step, memory and time; writes nothing");
  add_scene_flags(check_command, common);
  auto* explain_command = app.add_subcommand("explain", "what the scene makes the engine do, and which line asked");
  add_scene_flags(explain_command, common);
  auto* list_command =
      app.add_subcommand("list", "shapes, laws, solvers, broad phases, schemes, measures, scenes, pairs");
  list_command->add_option("kind", kind, "one list only");
  NarrowOptions narrow;
  auto* narrow_command =
      app.add_subcommand("narrow", "distance or depth, normal and points of listed convex pairs, ns per query");
  narrow_command->add_option("corpus", narrow.corpus, "file of convex pairs (CXP1)")->required();
  narrow_command->add_option("--method", narrow.method, "auto, sat, gjk-epa");
  narrow_command->add_flag("--json", narrow.json, "JSON instead of CSV");
  narrow_command->add_option("-o,--out", narrow.out, "write to this file");
  auto* schema_command = app.add_subcommand("schema", "the JSON Schema of scene files");
  auto* new_command = app.add_subcommand("new", "a commented starter scene on stdout");
  new_command->add_option("kind", kind, "hopper, stack, impact, pile")->required();
  auto* solve_command =
      app.add_subcommand("solve", "solve friction-contact problems from files (FCLIB HDF5, Siconos .dat)");
  add_solve_flags(solve_command, solve);
  auto* export_command = app.add_subcommand("export", "snapshots of a run to VTK or CSV");
  export_command->add_option("dir", directory, "output folder of the run")->required();
  export_command->add_option("--format", format, "vtk or csv")->check(CLI::IsMember({"vtk", "csv"}));
  std::string page;
  auto* report_command = app.add_subcommand("report", "one HTML page of a finished run: balance, measures, pictures");
  report_command->add_option("dir", directory, "output folder of the run")->required();
  report_command->add_option("-o,--out", page, "the page (default DIR/report.html)");
  auto* reference_command =
      app.add_subcommand("reference", "writes the reference pages and the schema: everything the registry knows");
  reference_command->add_option("dir", directory, "folder of the pages")->required();
  reference_command->add_option("--messages", page, "folder of scenes that are wrong on purpose: a page of messages too");
  auto* man_command = app.add_subcommand("man", "the manual page (roff) on stdout: epafi man | man -l -");
  auto* completion_command = app.add_subcommand("completion", "completion for bash on stdout: source <(epafi completion)");
  auto* patch_command =
      app.add_subcommand("patch", "one wheel-rail or Hertzian contact in statics, by each chosen model");
  add_scene_flags(patch_command, common);
  patch_command->add_flag("--json", patch.json, "print the results as JSON on stdout");
  patch_command->add_flag("--geometry", patch.geometry,
                          "contact places, rolling radius difference and conicity as CSV instead");
  patch_command->add_option("--maps", patch.maps, "folder for maps of pressure, traction, slip (CSV and .vti)");
  StudyOptions study;
  SweepOptions sweep;
  BenchOptions bench;
  auto* chart_command = app.add_subcommand("chart", "speed against accuracy: every method of a study on one scene");
  add_study_flags(chart_command, study, "study");
  chart_command->add_flag("--json", study.json, "the points on stdout");
  add_atlas_flags(chart_command, study);
  auto* limits_command = app.add_subcommand("limits", "where methods fail: scans or bisects the parameters of a study");
  add_study_flags(limits_command, study, "study");
  limits_command->add_flag("--json", study.json, "the limits on stdout");
  add_atlas_flags(limits_command, study);
  limits_command->add_option("-j,--jobs", study.jobs, "cases at a time")->check(CLI::PositiveNumber);
  auto* sweep_command = app.add_subcommand("sweep", "the cases of a scene's [sweep]; finished ones are skipped");
  add_study_flags(sweep_command, study, "scene");
  sweep_command->add_option("-j,--jobs", study.jobs, "cases at a time")->check(CLI::PositiveNumber);
  sweep_command->add_option("-t,--threads", sweep.threads, "threads of each case")->check(CLI::PositiveNumber);
  sweep_command->add_flag("--list", sweep.list, "number, state and values of every case");
  sweep_command->add_flag("--collect", sweep.collect, "one CSV row per case on stdout");
  sweep_command->add_option("--case", sweep.one, "this case only, counted from 0")->check(CLI::NonNegativeNumber);
  auto* bench_command =
      app.add_subcommand("bench", "scaling over sizes and threads; each row has time, error and state hash");
  bench_command->add_option("scene", study.files, "scenes; all of the library with a [benchmark] where none is given");
  bench_command->add_option("--set", study.overrides, "override a value, KEY.PATH=VALUE (repeatable)")
      ->allow_extra_args(false);
  bench_command->add_option("--threads", bench.threads, "numbers of threads, as 1,2,4")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  bench_command->add_option("--repeats", bench.repeats, "runs of each row; the median is printed")
      ->check(CLI::PositiveNumber);
  bench_command->add_option("-o,--out", bench.out_file, "also write the rows to this file");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e, std::cout, std::cerr);
    return code == 0 ? exit_done : exit_usage;
  }
  return guarded([&] {
    if (*run_command) return command_run(common, run);
    if (*resume_command) return command_resume(directory, run);
    if (*check_command) return command_check(common);
    if (*explain_command) return command_explain(common);
    if (*list_command) return command_list(kind);
    if (*narrow_command) return command_narrow(narrow);
    if (*schema_command) return command_schema();
    if (*new_command) return command_new(kind);
    if (*report_command) return command_report(directory, page);
    if (*reference_command) return command_reference(directory, page);
    if (*man_command) return command_manual(described(app));
    if (*completion_command) return command_completion(described(app));
    if (*patch_command) return command_patch(common, patch);
    if (*solve_command) return command_solve(solve);
    if (*export_command) return command_export(directory, format);
    if (*chart_command) return command_chart(study);
    if (*limits_command) return command_limits(study);
    if (*sweep_command) return command_sweep(study, sweep);
    if (*bench_command) return command_bench(study, bench);
    return static_cast<int>(exit_usage);
  });
}
