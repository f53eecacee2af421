/// @file patch.cpp  `epafi patch CASE.toml`: one contact in statics by each chosen model.
#include <cstdio>

#include "scenes/cli/commands.h"
#include "scenes/cli/library.h"
#include "scenes/cli/print.h"
#include "scenes/patch/evaluate_patch.h"
#include "viz_export/files/side_file.h"

namespace epafi {

namespace {
/// Exit code: not done where the wheelset stands at none of the shifts.
int print_geometry(const PatchCase& patch) {
  const PatchGeometry geometry = patch_geometry(patch);
  print(geometry.csv);
  if (geometry.standing < geometry.shifts)
    std::fprintf(stderr,
                 "epafi: warning: at %d of %d shifts the wheelset does not stand on both rails: their cells are "
                 "empty\n",
                 geometry.shifts - geometry.standing, geometry.shifts);
  return geometry.standing > 0 ? exit_done : exit_bound;
}
}  // namespace

int command_patch(const CommonOptions& common, const PatchOptions& options) {
  const PatchReading reading = read_patch(existing_scene_file(common.scene), common.overrides);
  if (!reading.patch) throw SceneError(reading.problems);
  for (const auto& p : reading.problems) std::fprintf(stderr, "%s\n", p.to_string().c_str());
  if (options.geometry) {
    if (!reading.patch->profiles) throw SceneError("--geometry needs a case with a wheel_profile and a rail_profile");
    return print_geometry(*reading.patch);
  }
  const std::vector<PatchResult> results = evaluate_patch(*reading.patch, !options.maps.empty());
  const std::string text = options.json ? patch_json(results) : patch_table(results);
  if (!options.maps.empty()) write_patch_maps(options.maps, results, reading.patch->title);
  print(text);
  bool solved = true;
  for (const PatchResult& r : results) {
    if (r.solved()) continue;
    solved = false;
    const std::string why = r.reasons.empty() ? "no contact" : r.reasons.front();
    std::fprintf(stderr, "epafi: %s: not solved: %s\n", r.normal.c_str(), why.c_str());
  }
  return solved ? exit_done : exit_bound;
}

}  // namespace epafi
