#include <functional>
#include <iostream>

#include "engine/lanes/targets.h"
#include "scenes/cli/commands.h"
#include "scenes/cli/manual.h"
#include "scenes/cli/narrow.h"
#include "scenes/cli/program.h"
#include "scenes/cli/study_commands.h"
#include "scenes/cli/usage.h"
#include "scenes/cli/view_commands.h"
#include "scenes/cli/watch.h"
#include "scenes/version.h"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace {

/// The flags that several commands share.
void add_scene_flags(CLI::App* command, epafi::CommonOptions& o) {
  command->add_option("scene", o.scene, "scene file (TOML)")->required();
  command->add_option("--set", o.overrides, "override a value, KEY.PATH=VALUE (repeatable)")->allow_extra_args(false);
}

void add_run_flags(CLI::App* command, epafi::RunOptions& o) {
  command->add_option("-t,--threads", o.threads, "threads (default: all cores)")->check(epafi::whole_number(1));
  command->add_option("--until", o.until, "stop at this simulated time [s], with a checkpoint")
      ->check(epafi::at_least(0));
  command->add_option("--steps", o.steps, "stop after this many steps (resume: this many more), with a checkpoint")
      ->check(epafi::whole_number(0, 1'000'000'000'000'000));
  command->add_option("--time-limit", o.time_limit,
                      "stop after this wall time (90s, 3h50m) with a checkpoint, exit code 75");
  command->add_option("--cpu-limit", o.cpu_limit, "the same for the processor time of all threads");
  command->add_flag("-q,--quiet", o.quiet, "no progress");
  command->add_flag("-v,--verbose", o.verbose, "more about the set-up");
  command->add_flag("--strict", o.strict, "exit code 1 if the scene or the run has warnings");
  command->add_flag("--json", o.json, "print only the summary, as JSON, on stdout");
}

void add_solve_flags(CLI::App* command, epafi::SolveOptions& o) {
  command->add_option("problems", o.problems, "problem files")->required();
  command->add_option("-m,--method", o.methods, "solvers, by name; `all` for every one (default auto)")->delimiter(',');
  command->add_option("--tolerance", o.tolerance, "residual to reach (default 1e-6)")->check(epafi::at_least(0));
  command->add_option("--max-iterations", o.max_iterations, "iterations at most")->check(epafi::at_least(1));
  command->add_option("--time-limit", o.time_limit, "CPU time of each solve (1s, 0.5s, 2m; default 10s)");
  command->add_option(
      "--solution", o.solution,
      "write <problem>/reaction to this HDF5 file; with several methods that of the smallest residual, and "
      "<problem>/METHOD/reaction");
  command->add_option("-o,--out", o.out, "write the rows to this file")->check(epafi::file_name());
  command->add_flag("--json", o.json, "rows as JSON");
}

void add_study_flags(CLI::App* command, epafi::StudyOptions& o, const char* what) {
  command->add_option(what, o.files, "file (TOML)")->required();
  command->add_option("--set", o.overrides, "override a value, KEY.PATH=VALUE (repeatable)")->allow_extra_args(false);
  command->add_option("-o,--out", o.out, "output folder")->check(epafi::file_name());
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
        text.options.push_back({option->get_name(true, true), option->get_description(),
                                option->get_items_expected_max() > 0, option->get_positional()});
    program.commands.push_back(std::move(text));
  }
  return program;
}

void add_atlas_flags(CLI::App* command, epafi::StudyOptions& o) {
  command->get_option("study")->required(false);
  command->add_flag("--all", o.all, "write tables and pictures of all studies into the atlas; print changed rows");
  command->add_option("--budget", o.budget, "wall time of --all (default 30m)");
  command->add_option("--studies", o.studies, "folder of the studies (default scenes/library/studies)");
  command->add_option("--atlas", o.atlas, "folder of the atlas (default docs/atlas)");
}

/// What the commands read, and the one that was asked for.
struct Program {
  CLI::App app{"Epafi, a many-body contact engine", "epafi"};
  epafi::CommonOptions common;
  epafi::RunOptions run;
  epafi::PatchOptions patch;
  epafi::SolveOptions solve;
  epafi::NarrowOptions narrow;
  epafi::StudyOptions study;
  epafi::SweepOptions sweep;
  epafi::BenchOptions bench;
  epafi::ViewOptions view;
  epafi::RenderRequest render;
  std::vector<std::string> measures;
  std::string directory, next_scene, kind, page, format = "vtk";
  std::function<int()> chosen;

  CLI::App* add(const char* name, const char* description, std::function<int()> what) {
    CLI::App* command = app.add_subcommand(name, description);
    command->callback([this, what = std::move(what)] { chosen = what; });
    return command;
  }
};

void add_runs(Program& p) {
  auto* run = p.add("run", "simulate headlessly", [&p] { return epafi::command_run(p.common, p.run); });
  add_scene_flags(run, p.common);
  add_run_flags(run, p.run);
  run->add_option("-o,--out", p.run.out, "output folder (default out/<scene name>)")->check(epafi::file_name());
  run->add_flag("--least-output", p.run.least_output, "no frames, only the last snapshot");
  run->add_flag("--force", p.run.force, "use an output folder that is not empty");
  auto* resume = p.add("resume", "continue a run from its last good checkpoint", [&p] {
    return epafi::command_resume(p.directory, p.run, {p.common.overrides, p.next_scene});
  });
  resume->add_option("dir", p.directory, "output folder of the run")->required();
  resume->add_option("--set", p.common.overrides, "KEY.PATH=VALUE to change from here on")->allow_extra_args(false);
  resume->add_option("--scene", p.next_scene, "another scene file, which continues from the state of this run");
  add_run_flags(resume, p.run);
  add_scene_flags(p.add("check", "errors of a scene, its time step, memory and time; writes nothing",
                        [&p] { return epafi::command_check(p.common); }),
                  p.common);
  add_scene_flags(p.add("explain", "what a scene makes the engine do and store, and which line asks for it",
                        [&p] { return epafi::command_explain(p.common); }),
                  p.common);
}

void add_lists(Program& p) {
  auto* list = p.add("list", "shapes, laws, solvers, broad phases, schemes, measures, scenes, pairs",
                     [&p] { return epafi::command_list(p.kind); });
  list->add_option("kind", p.kind, "print this list only");
  auto* narrow = p.add("narrow", "distance or depth, normal and points of a file of convex pairs, ns per query",
                       [&p] { return epafi::command_narrow(p.narrow); });
  narrow->add_option("corpus", p.narrow.corpus, "file of convex pairs (CXP1)")->required();
  narrow->add_option("--method", p.narrow.method, "auto, sat, gjk-epa");
  narrow->add_flag("--json", p.narrow.json, "JSON instead of CSV");
  narrow->add_option("-o,--out", p.narrow.out, "write to this file")->check(epafi::file_name());
  p.add("schema", "the JSON Schema of scene files", [] { return epafi::command_schema(); });
  auto* starter = p.add("new", "a commented starter scene on stdout", [&p] { return epafi::command_new(p.kind); });
  starter->add_option("kind", p.kind, "hopper, stack, impact, pile");
  add_solve_flags(p.add("solve", "solve friction-contact problems from files (FCLIB HDF5, Siconos .dat)",
                        [&p] { return epafi::command_solve(p.solve); }),
                  p.solve);
}

void add_pages(Program& p) {
  auto* vtk = p.add("export", "snapshots of a run to VTK or CSV",
                    [&p] { return epafi::command_export(p.directory, p.format); });
  vtk->add_option("dir", p.directory, "output folder of the run")->required();
  vtk->add_option("--format", p.format, "vtk or csv")->check(CLI::IsMember({"vtk", "csv"}));
  auto* report = p.add("report", "one HTML page of a run, sweep or chart, finished or not: balance, measures, pictures",
                       [&p] { return epafi::command_report(p.directory, p.page); });
  report->add_option("dir", p.directory, "output folder of the run")->required();
  report->add_option("-o,--out", p.page, "the page (default DIR/report.html)")->check(epafi::file_name());
  auto* reference = p.add("reference", "write the reference pages and the schema",
                          [&p] { return epafi::command_reference(p.directory, p.page); });
  reference->add_option("dir", p.directory, "folder of the pages")->required();
  reference->add_option("--messages", p.page, "folder of wrong scenes: also write a page of messages");
  p.add("man", "the manual page (roff) on stdout: epafi man | man -l -",
        [&p] { return epafi::command_manual(described(p.app)); });
  p.add("completion", "completion for bash on stdout: source <(epafi completion)",
        [&p] { return epafi::command_completion(described(p.app)); });
}

void add_views(Program& p) {
  auto* view = p.add("view", "show a run, or a scene's first state, in a browser; --out writes one file",
                     [&p] { return epafi::command_view(p.view); });
  view->add_option("what", p.view.what, "output folder of a run, or a scene file")->required();
  view->add_option("--set", p.view.overrides, "override a value of the scene, KEY.PATH=VALUE (repeatable)")
      ->allow_extra_args(false);
  view->add_option("-o,--out", p.view.out, "write this self-contained page instead")->check(epafi::file_name());
  view->add_option("--port", p.view.port, "port of the local server (default 8047; 0: any free one)")
      ->check(epafi::whole_number(0, 65535));
  view->add_flag("--no-browser", p.view.no_browser, "only print the address");
  auto* render = p.add("render", "a picture (PNG) or film (MP4, WebM by ffmpeg) of a run, without a display",
                       [&p] { return epafi::command_render(p.render); });
  render->add_option("dir", p.render.directory, "output folder of a run")->required();
  render->add_option("-o,--out", p.render.out, "FILE.png, FILE.mp4 or FILE.webm (default DIR/picture.png)")
      ->check(epafi::file_name());
  render->add_option("--time", p.render.time, "time of the picture [s] (default: the last frame)")
      ->check(epafi::at_least(0.0));
  render->add_option("--every", p.render.every, "take every Nth frame in a film")->check(epafi::whole_number(1));
  render->add_option("--camera", p.render.camera, "scene, iso, front, back, left, right, top, bottom");
  render->add_option("--field", p.render.field, "what colours the bodies: speed, spin, force, size, id, material ...");
  render->add_option("--size", p.render.size, "pixels, as 1280x720");
  auto* watch =
      p.add("watch", "follow a run in the terminal: energies, contacts, residual and measures, with their history",
            [&p] { return epafi::command_watch(p.directory, p.measures); });
  watch->add_option("dir", p.directory, "output folder of the run")->required();
  watch->add_option("--measure", p.measures, "show only this measure beside the run's own values (repeatable)")
      ->allow_extra_args(false);
  render->add_flag("--contacts", p.render.contacts,
                   "draw contacts as ribbons, as wide as their force, and bodies pale");
}

void add_patch(Program& p) {
  auto* patch = p.add("patch", "one static wheel-rail or Hertzian contact by each chosen model",
                      [&p] { return epafi::command_patch(p.common, p.patch); });
  add_scene_flags(patch, p.common);
  patch->add_flag("--json", p.patch.json, "the results as JSON in place of CSV");
  patch->add_flag("--table", p.patch.table, "the results as a table for reading, in place of CSV");
  patch->add_option("-o,--out", p.patch.out, "write the results to this file")->check(epafi::file_name());
  patch->add_flag("--geometry", p.patch.geometry,
                  "contact places, rolling radius difference and conicity as CSV instead");
  patch->add_option("--maps", p.patch.maps, "folder for maps of pressure, traction, slip (CSV and .vti)");
}

void add_studies(Program& p) {
  auto* chart = p.add("chart", "speed against accuracy: every method of a study on one scene",
                      [&p] { return epafi::command_chart(p.study); });
  add_study_flags(chart, p.study, "study");
  chart->add_flag("--json", p.study.json, "the points as JSON in place of CSV");
  chart->add_option("--with", p.study.rows, "rows of other programs: CSV with the columns of chart.csv (repeatable)")
      ->allow_extra_args(false);
  add_atlas_flags(chart, p.study);
  auto* limits = p.add("limits", "where methods fail: scans or bisects the parameters of a study",
                       [&p] { return epafi::command_limits(p.study); });
  add_study_flags(limits, p.study, "study");
  limits->add_flag("--json", p.study.json, "the limits as JSON in place of CSV");
  add_atlas_flags(limits, p.study);
  limits->add_option("-j,--jobs", p.study.jobs, "cases at a time")->check(epafi::whole_number(1));
  auto* sweep = p.add("sweep", "the cases of a scene's [sweep]; finished ones are skipped",
                      [&p] { return epafi::command_sweep(p.study, p.sweep); });
  add_study_flags(sweep, p.study, "scene");
  sweep->add_option("-j,--jobs", p.study.jobs, "cases at a time")->check(epafi::whole_number(1));
  sweep->add_option("-t,--threads", p.sweep.threads, "threads of each case")->check(epafi::whole_number(1));
  sweep->add_flag("--list", p.sweep.list, "number, state and values of every case");
  sweep->add_flag("--collect", p.sweep.collect, "one CSV row per case on stdout");
  sweep->add_flag("--slurm", p.sweep.slurm,
                  "write the array job of the open cases, FOLDER/sweep.sbatch, and run nothing");
  sweep->add_option("--case", p.sweep.one, "this case only, counted from 0")->check(epafi::whole_number(0));
}

void add_bench(Program& p) {
  auto* bench = p.add("bench", "scaling over sizes and threads; each row has time, error and state hash",
                      [&p] { return epafi::command_bench(p.study, p.bench); });
  bench->add_option("scene", p.study.files, "scenes (default: all of the library with a [benchmark])");
  bench->add_option("--set", p.study.overrides, "override a value, KEY.PATH=VALUE (repeatable)")
      ->allow_extra_args(false);
  bench->add_option("--threads", p.bench.threads, "numbers of threads, as 1,2,4")
      ->delimiter(',')
      ->check(epafi::whole_number(1));
  bench->add_option("--repeats", p.bench.repeats, "runs of each row; the median is printed")
      ->check(epafi::whole_number(1));
  bench->add_flag(
      "--copies", p.bench.copies,
      "also N copies of the scene at once, one thread each: the most that N threads can gain on this machine");
  bench->add_option("-o,--out", p.bench.out_file, "also write the rows to this file")->check(epafi::file_name());
  bench->add_flag("--json", p.bench.json, "the rows as JSON in place of CSV");
}

}  // namespace

int epafi::program(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): give_up() names what nobody expected
#if defined(__GLIBC__)
  // Columns go back to the system when they go. Left alone, glibc learns from the first freed ones to keep larger and
  // larger pieces in its heap, where the next do not fit: 190 of 1620 bytes a sphere of 100 000.
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
#endif
  Program p;
  p.app.set_version_flag("--version", epafi::version_text());
  p.app.require_subcommand(1);
  for (const auto add : {add_runs, add_lists, add_pages, add_views, add_patch, add_studies, add_bench}) add(p);
  p.app.failure_message([](const CLI::App*, const CLI::Error& e) {
    return fmt::format("error: {}; epafi --help shows what there is\n", e.what());
  });
  if (const std::string help = epafi::asked_help(p.app, argc, argv); !help.empty()) {
    std::cout << help;
    return epafi::exit_done;
  }
  if (const std::string wrong = epafi::unknown_command(p.app, argc, argv); !wrong.empty()) {
    std::cerr << wrong;
    return epafi::exit_usage;
  }
  try {
    p.app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (const std::string wrong = epafi::unknown_option(p.app, argc, argv); !wrong.empty()) {
      std::cerr << wrong;
      return epafi::exit_usage;
    }
    const int code = p.app.exit(e, std::cout, std::cerr);
    return code == 0 ? epafi::exit_done : epafi::exit_usage;
  }
  return epafi::guarded([&p] {
    epafi::target();
    return p.chosen();
  });
}
