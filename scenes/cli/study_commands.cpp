#include "scenes/cli/study_commands.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "engine/units/error.h"
#include "scenes/cli/commands.h"
#include "scenes/cli/library.h"
#include "scenes/cli/print.h"
#include "scenes/stop.h"
#include "scenes/study/atlas.h"
#include "scenes/study/bench.h"
#include "scenes/study/chart.h"
#include "scenes/study/chart_rows.h"
#include "scenes/study/limits.h"
#include "scenes/study/slurm_job.h"
#include "scenes/study/sweep.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/side_file.h"
#include "viz_export/files/study_mark.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

void say(const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }

std::function<void(const std::string&)> speaker(const StudyOptions& o) {
  return o.quiet ? std::function<void(const std::string&)>([](const std::string&) {}) : say;
}

/// The command as it would be typed again.
StudyMark mark_of(const char* command, const std::string& file, const StudyOptions& o, std::size_t cases) {
  StudyMark mark{command, fmt::format("epafi {} {}", command, file), cases};
  for (const std::string& set : o.overrides) mark.command += " --set '" + set + "'";
  if (!o.out.empty()) mark.command += " -o " + o.out;
  return mark;
}

fs::path folder_of(const StudyOptions& o, const std::string& file, const char* suffix) {
  return o.out.empty() ? fs::path("out") / (fs::path(file).stem().string() + suffix) : fs::path(o.out);
}

}  // namespace

namespace {
void require_study(const StudyOptions& o) {
  if (o.files.empty()) throw SceneError("name a study, or write --all for those of the library");
}

int command_atlas(const StudyOptions& o, bool charts) {
  const auto budget = parse_duration(o.budget);
  if (!budget) throw SceneError("--budget '" + o.budget + "' is no duration; write 90s, 30m or 3h50m");
  const fs::path work = o.out.empty() ? fs::path("out/atlas") : fs::path(o.out);
  AtlasOrder order{o.studies, o.atlas, work, *budget, o.jobs};
  for (const auto& file : o.files) order.only.push_back(fs::path(file).stem().string());
  return draw_atlas(order, charts, speaker(o)) ? exit_done : exit_time_limit;
}
}  // namespace

int command_chart(const StudyOptions& o) {
  if (o.all) return command_atlas(o, true);
  require_study(o);
  for (const auto& name : o.files) {
    const std::string file = existing_scene_file(name, "study");
    const Study study = read_study(file, o.overrides);
    const fs::path folder = folder_of(o, file, "-chart");
    fs::create_directories(folder);
    StudyMark mark = mark_of("chart", file, o, study.methods.size());
    write_study_mark(folder, mark);
    std::vector<ChartPoint> rows;
    for (const auto& more : o.rows) {
      const auto read = read_rows(study, more);
      rows.insert(rows.end(), read.begin(), read.end());
    }
    Chart chart = chart_of(study, folder, speaker(o));
    add_rows(chart, rows);
    write_whole_file(folder / "chart.csv", {chart_csv(chart)});
    write_whole_file(folder / "chart.json", {chart_json(chart)});
    const std::string recommended = recommended_scene(chart, folder);
    if (!recommended.empty()) write_whole_file(folder / "recommended.toml", {recommended});
    draw_chart(chart, folder);
    mark.finished = true;
    write_study_mark(folder, mark);
    print(o.json ? chart_json(chart) : chart_csv(chart));
    if (!o.json) std::fputs(chart_verdict(chart).c_str(), stderr);
    if (!o.quiet)
      say(fmt::format("chart.csv, chart.svg, chart.png in {}; each point is a run like\n  {}", folder.string(),
                      chart.command));
  }
  return exit_done;
}

int command_limits(const StudyOptions& o) {
  if (o.all) return command_atlas(o, false);
  require_study(o);
  for (const auto& name : o.files) {
    const std::string file = existing_scene_file(name, "study");
    const Study study = read_study(file, o.overrides);
    const fs::path folder = folder_of(o, file, "-limits");
    if (o.force) remove_cases(folder);
    fs::create_directories(folder);
    StudyMark mark = mark_of("limits", file, o, 0);
    write_study_mark(folder, mark);
    const LimitMap map = run_limits(study, folder, o.jobs, speaker(o));
    write_whole_file(folder / "limits.csv", {limits_csv(map)});
    draw_limits(map, folder);
    mark.finished = true;
    write_study_mark(folder, mark);
    print(o.json ? limits_json(map) : limits_csv(map));
    if (!o.json) std::fputs(limits_verdict(map).c_str(), stderr);
    if (!o.quiet) say(fmt::format("limits.csv and pictures in {}", folder.string()));
  }
  return exit_done;
}

namespace {
/// The script, into the folder of the cases and on stdout.
int write_slurm_job(const StudyOptions& o, const SweepOptions& s, const SweepPlan& sweep, const fs::path& folder) {
  const std::string text = slurm_script(sweep, {fs::read_symlink("/proc/self/exe").string(), folder, s.threads});
  if (text.empty()) {
    say("every case is finished: there is nothing to send");
    return exit_done;
  }
  fs::create_directories(folder);
  write_whole_file(folder / "sweep.sbatch", {text});
  if (!o.quiet) say(fmt::format("written; send it with\n  bash {}", (folder / "sweep.sbatch").string()));
  print(text);
  return exit_done;
}
}  // namespace

int command_sweep(const StudyOptions& o, const SweepOptions& s) {
  const std::string scene = existing_scene_file(o.files.front());
  const fs::path folder = folder_of(o, scene, "-sweep");
  const SweepPlan sweep = plan_sweep(scene, o.overrides, folder);
  if (s.slurm) return write_slurm_job(o, s, sweep, folder);
  if (s.list) {
    print(list_sweep(sweep));
    return exit_done;
  }
  if (s.collect) {
    print(collect_sweep(sweep));
    return exit_done;
  }
  std::vector<Case> todo;
  std::vector<std::size_t> number;
  if (s.one >= static_cast<int>(sweep.cases.size()))
    throw SceneError(fmt::format("--case {}: the sweep has cases 0 to {}", s.one, sweep.cases.size() - 1));
  for (std::size_t k = 0; k < sweep.cases.size(); ++k) {
    if (s.one >= 0 && static_cast<std::size_t>(s.one) != k) continue;
    if (!o.force && finished_case(sweep.cases[k], sweep.hashes[k])) continue;
    todo.push_back(sweep.cases[k]);
    number.push_back(k);
  }
  fs::create_directories(folder);
  const StudyMark mark = mark_of("sweep", scene, o, sweep.cases.size());
  write_study_mark(folder, mark);
  int worst = exit_done;
  const auto report = speaker(o);
  report(fmt::format("{} of {} cases to run", todo.size(), sweep.cases.size()));
  const bool whole = run_cases(
      scene, todo, {"/proc/self/exe", s.threads, 0.0, false}, o.jobs, [&](std::size_t k, const CaseResult& r) {
        (r.completed() ? report : say)(  // trouble in any case
            fmt::format("case {}: {}{}{}", number[k], r.status, r.trouble.empty() ? "" : ": ", r.trouble));
        if (!r.completed()) worst = r.status == "bound_violated" && worst == exit_done ? exit_bound : exit_failed;
      });
  if (whole && s.one < 0)
    report(fmt::format("cases in {}; one table of all: epafi sweep {} -o {} --collect", folder.string(),
                       o.files.front(), folder.string()));
  return whole ? worst : exit_interrupt;
}

int command_bench(const StudyOptions& o, const BenchOptions& b) {
  for (const auto& name : o.files) require_not_the_input(b.out_file, scene_file(name));
  std::string csv = bench_header();
  std::vector<BenchRow> rows;
  if (!b.json) print(csv);
  const auto print_now = [&](const std::string& text) {
    print(text);
    flush_printed();
  };
  const auto take = [&](const BenchRow& row) {
    rows.push_back(row);
    csv += bench_csv(row);
    if (!b.json) print_now(bench_csv(row));
  };
  const auto remark = [&](const std::string& lines) { b.json ? say(lines) : print_now(lines); };
  for (const auto& name : o.files.empty() ? library_benchmarks() : o.files) {
    const std::string scene = existing_scene_file(name);
    const fs::path folder = fs::temp_directory_path() / fmt::format("epafi-bench-{}", getpid());
    run_bench({scene, o.overrides, b.threads, b.repeats, folder, b.copies}, take, remark);
    fs::remove_all(folder);
  }
  const std::string json = b.json ? bench_json(rows) : std::string();
  if (b.json) print(json);
  if (!b.out_file.empty()) write_whole_file(b.out_file, {b.json ? json : csv});
  return exit_done;
}

}  // namespace epafi
