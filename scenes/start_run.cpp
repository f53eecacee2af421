#include "scenes/start_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "scenes/version.h"
#include "viz_export/hdf5/stored_run.h"

namespace epafi {

Scene scene_of(const CheckpointHeader& header, const RunRecord& record) {
  if (!std::filesystem::exists(header.scene_path))
    throw FileError("the scene '" + header.scene_path +
                    "' that the run was started from is not there; put it back as it was");
  ReadOptions options;
  options.start_run = record.start_run;
  ReadResult first = read_scene(header.scene_path, header.overrides, full_registry(), options);
  if (!first.scene) throw SceneError(first.problems);
  if (scene_hash(*first.scene) != header.scene_hash)
    throw SceneError("the scene '" + header.scene_path +
                     "' has changed since the run was started; restore it, or start anew with `epafi run`");
  if (record.stage == 0 && record.inserted.empty()) return std::move(*first.scene);
  options.stage = record.stage;
  options.inserted = record.inserted;
  ReadResult now = read_scene(header.scene_path, header.overrides, full_registry(), options);
  if (!now.scene) throw SceneError(now.problems);
  return std::move(*now.scene);
}

AssembleOptions options_of(const RunRecord& record) {
  AssembleOptions options;
  options.clocks = record.clocks();
  options.time_step = record.time_step;
  options.fill_bodies = record.fills;
  return options;
}

std::shared_ptr<MadeRun> open_made_run(const std::filesystem::path& run) {
  const auto file = std::filesystem::is_directory(run) ? run / "checkpoint.h5" : run;
  if (!std::filesystem::exists(file))
    throw FileError("there is no run in '" + run.string() + "': it has no checkpoint.h5");
  auto made = std::make_shared<MadeRun>();
  made->header = read_checkpoint_header(file);
  if (made->header.version != version())
    throw FileError(file.string() + ": was written by version " + made->header.version + ", this is " + version() +
                    "; make the run again");
  made->record = RunRecord::from_text(made->header.record);
  AssembleOptions options = options_of(made->record);
  options.keep_fill_bodies = true;
  made->assembly = assemble(scene_of(made->header, made->record), options);
  load_state(file, [&](StateVisitor& v) { made->assembly->simulation->visit(v); });
  made->hash = state_hash(made->assembly->simulation->world);
  return made;
}

void put_back(MadeRun& run, const std::filesystem::path& folder, double time) {
  const StoredRun stored(folder / "run.h5");
  std::string times;
  for (std::size_t k = 0; k < stored.snapshots(); ++k) {
    const StoredSnapshot snapshot = stored.snapshot(k);
    const double t = snapshot.stamp.time;
    if (std::abs(t - time) > 1e-6 * std::max(1e-9, time) + 1e-12) {
      times += fmt::format("{}{:.6g}", times.empty() ? "" : ", ", t);
      continue;
    }
    World& w = run.assembly->simulation->world;
    std::vector<BodyId> later;
    std::vector<char> there(w.ids_given(), 0);
    for (const BodyRecord& b : snapshot.bodies) {
      const Slot s = b.id < w.ids_given() ? w.slot_of(static_cast<BodyId>(b.id)) : no_slot;
      if (s == no_slot)
        throw SceneError(fmt::format("body {} of that time was taken out later; start from the last state", b.id));
      there[b.id] = 1;
      w.position[s] = b.pose.position;
      w.velocity[s] = b.velocity;
      if (w.has_orientation() && snapshot.stamp.has_orientation) w.orientation[s] = b.pose.orientation;
      if (w.rotates()) w.set_angular_velocity(s, b.angular_velocity);
      if (w.cell) w.wraps[s].setZero();
    }
    for (Slot s = 0; s < w.size(); ++s)
      if (there[static_cast<std::size_t>(w.id[s])] == 0) later.push_back(w.id[s]);
    if (!later.empty()) w.remove(later);
    run.hash = snapshot.stamp.state_hash;
    return;
  }
  throw SceneError(fmt::format("the run has no snapshot of {:.6g} s; there are {} s", time, times));
}

}  // namespace epafi
