#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "scenes/cli/commands.h"
#include "scenes/cli/narrow.h"

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
  command->add_option("--time-limit", o.time_limit, "stop after this wall time (90s, 3h50m) with a checkpoint, exit code 75");
  command->add_flag("-q,--quiet", o.quiet, "no progress");
  command->add_flag("-v,--verbose", o.verbose, "more about the set-up");
  command->add_flag("--json", o.json, "print the summary on stdout, nothing else there");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace epafi;
  CLI::App app{"Epafi, a many-body contact engine", "epafi"};
  app.set_version_flag("--version", std::string(EPAFI_VERSION));
  app.require_subcommand(1);
  CommonOptions common;
  RunOptions run;
  std::string directory, kind, format = "vtk";

  auto* run_command = app.add_subcommand("run", "simulate headlessly");
  add_scene_flags(run_command, common);
  add_run_flags(run_command, run);
  run_command->add_option("-o,--out", run.out, "output folder (default out/<scene name>)");
  run_command->add_flag("--force", run.force, "use an output folder that is not empty");
  auto* resume_command = app.add_subcommand("resume", "continue a run from its last good checkpoint");
  resume_command->add_option("dir", directory, "output folder of the run")->required();
  add_run_flags(resume_command, run);
  auto* check_command = app.add_subcommand("check", "everything wrong with a scene, its time step, memory and time; writes nothing");
  add_scene_flags(check_command, common);
  auto* explain_command = app.add_subcommand("explain", "what the scene makes the engine do, and which line asked");
  add_scene_flags(explain_command, common);
  auto* list_command = app.add_subcommand("list", "shapes, laws, solvers, broad phases, schemes, measures, scenes, pairs");
  list_command->add_option("kind", kind, "one list only");
  NarrowOptions narrow;
  auto* narrow_command = app.add_subcommand("narrow", "distance or depth, normal and points of listed convex pairs, ns per query");
  narrow_command->add_option("corpus", narrow.corpus, "file of convex pairs (CXP1)")->required();
  narrow_command->add_option("--method", narrow.method, "auto, sat, gjk-epa");
  narrow_command->add_flag("--json", narrow.json, "JSON instead of CSV");
  narrow_command->add_option("-o,--out", narrow.out, "write to this file");
  auto* schema_command = app.add_subcommand("schema", "the JSON Schema of scene files");
  auto* new_command = app.add_subcommand("new", "a commented starter scene on stdout");
  new_command->add_option("kind", kind, "hopper, stack, impact, pile")->required();
  auto* export_command = app.add_subcommand("export", "snapshots of a run to VTK or CSV");
  export_command->add_option("dir", directory, "output folder of the run")->required();
  export_command->add_option("--format", format, "vtk or csv")->check(CLI::IsMember({"vtk", "csv"}));

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
    if (*export_command) return command_export(directory, format);
    return static_cast<int>(exit_usage);
  });
}
