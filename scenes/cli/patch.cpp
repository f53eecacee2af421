/// @file patch.cpp  `epafi patch CASE.toml`: one contact in statics by each chosen model.
#include <algorithm>
#include <cstdio>

#include "scenes/cli/commands.h"
#include "scenes/cli/library.h"
#include "scenes/cli/print.h"
#include "scenes/patch/evaluate_patch.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/side_file.h"

namespace epafi {

namespace {
void print_rows(const std::string& text, const std::string& out) {
  if (out.empty())
    print(text);
  else
    write_whole_file(out, {text});
}

/// Returns the exit code: a failure where the wheelset has contact at none of the shifts.
int print_geometry(const PatchCase& patch, const std::string& out) {
  const PatchGeometry geometry = patch_geometry(patch);
  print_rows(geometry.csv, out);
  if (geometry.standing < geometry.shifts)
    std::fprintf(stderr,
                 "epafi: warning: at %d of %d shifts the wheelset does not stand on both rails: their cells are "
                 "empty\n",
                 geometry.shifts - geometry.standing, geometry.shifts);
  return geometry.standing > 0 ? exit_done : exit_bound;
}

/// Prints, once per text, deviations from the case and the reasons of pairs of models without a solution. True if all
/// have one.
bool say_what_differs(const std::vector<PatchResult>& results) {
  bool solved = true;
  std::vector<std::string> said;
  const auto say_once = [&](const std::string& line) {
    if (std::ranges::count(said, line) > 0) return;
    said.push_back(line);
    std::fprintf(stderr, "epafi: %s\n", line.c_str());
  };
  for (const PatchResult& r : results) {
    for (const std::string& note : r.notes) say_once("note: " + r.normal + ": " + note);
    if (r.solved()) continue;
    solved = false;
    say_once(r.normal + ": not solved: " + (r.reasons.empty() ? "no contact" : r.reasons.front()));
  }
  return solved;
}

}  // namespace

int command_patch(const CommonOptions& common, const PatchOptions& options) {
  const std::string file = existing_scene_file(common.scene);
  require_not_the_input(options.out, file);
  const PatchReading reading = read_patch(file, common.overrides);
  if (!reading.patch) throw SceneError(reading.problems);
  for (const auto& p : reading.problems) std::fprintf(stderr, "%s\n", p.to_string().c_str());
  if (options.geometry) {
    if (!reading.patch->profiles) throw SceneError("--geometry needs a case with a wheel_profile and a rail_profile");
    return print_geometry(*reading.patch, options.out);
  }
  const std::vector<PatchResult> results = evaluate_patch(*reading.patch, !options.maps.empty());
  if (!options.maps.empty()) write_patch_maps(options.maps, results, reading.patch->title);
  print_rows(options.json    ? patch_json(results)
             : options.table ? patch_table(results)
                             : patch_csv(results),
             options.out);
  return say_what_differs(results) ? exit_done : exit_bound;
}

}  // namespace epafi
