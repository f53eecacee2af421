#include "scenes/start_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/run_folder.h"
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
  if (!has_hash(*first.scene, header.scene_hash))
    throw SceneError("the scene '" + header.scene_path +
                     "' or a file that it names has changed since the run was started; restore it, or start anew with "
                     "`epafi run`");
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

std::string text_of(const CheckpointHeader& h) {
  std::vector<std::string> words{h.scene_path, h.scene_hash, h.record};
  words.insert(words.end(), h.overrides.begin(), h.overrides.end());
  std::string text;
  for (const std::string& word : words) text += word + '\0';  // no word has one
  return text;
}

std::unique_ptr<Assembly> part_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size(); at = text.find('\0', at) + 1)
    words.push_back(text.substr(at, text.find('\0', at) - at));
  CheckpointHeader header;
  header.scene_path = words.at(0);
  header.scene_hash = words.at(1);
  header.overrides.assign(words.begin() + 3, words.end());
  const RunRecord record = RunRecord::from_text(words.at(2));
  return assemble(scene_of(header, record), options_of(record));
}

namespace {

/// Text that names the runs to resume: unfinished ones, else all.
std::string which_to_resume(const std::vector<std::filesystem::path>& runs) {
  constexpr std::size_t most = 8;
  std::vector<std::string> open, done;
  for (const auto& run : runs) {
    const auto summary = run / "summary.json";
    const bool ended = std::filesystem::exists(summary) && read_json(summary).text("status") == "completed";
    (ended ? done : open).push_back("'" + run.string() + "'");
  }
  const std::vector<std::string>& named = open.empty() ? done : open;
  std::string text = open.empty() ? "all are complete: " : "not complete: ";
  for (std::size_t k = 0; k < std::min(most, named.size()); ++k) text += (k > 0 ? ", " : "") + named[k];
  return named.size() > most ? text + fmt::format(" and {} more", named.size() - most) : text;
}

}  // namespace

void check_is_run(const std::filesystem::path& run) {
  std::error_code failure;
  if (!std::filesystem::is_directory(run, failure) || std::filesystem::exists(run / "checkpoint.h5", failure)) return;
  const auto runs = runs_in(run, "checkpoint.h5");
  if (runs.empty())
    throw FileError(runs_in(run).empty() ? "there is no run in '" + run.string() + "': it has no checkpoint.h5"
                                         : no_run_text(run, "resume"));
  throw FileError(
      fmt::format("'{0}' is the folder of a sweep, with {1} runs; resume one of them ({2}), or finish the sweep "
                  "by `epafi sweep SCENE`; `epafi report {0}` makes a page of it",
                  run.string(), runs.size(), which_to_resume(runs)));
}

namespace {

std::shared_ptr<MadeRun> with_header(const std::filesystem::path& run) {
  check_is_run(run);
  const auto file = std::filesystem::is_directory(run) ? run / "checkpoint.h5" : run;
  if (!std::filesystem::exists(file))
    throw FileError("there is no run in '" + run.string() + "': it has no checkpoint.h5");
  auto made = std::make_shared<MadeRun>();
  made->header = read_checkpoint_header(file);
  made->record = RunRecord::from_text(made->header.record);
  return made;
}

void assemble_made(MadeRun& made) {
  AssembleOptions options = options_of(made.record);
  options.keep_fill_bodies = true;
  made.assembly = assemble(scene_of(made.header, made.record), options);
}

}  // namespace

std::shared_ptr<MadeRun> open_made_run(const std::filesystem::path& run) {
  auto made = with_header(run);
  assemble_made(*made);
  const auto file = std::filesystem::is_directory(run) ? run / "checkpoint.h5" : run;
  load_state(file, [&](StateVisitor& v) { made->assembly->simulation->visit(v); });
  made->hash = state_hash(made->assembly->simulation->world);
  return made;
}

namespace {

bool is_at(double time, double wanted) { return std::abs(time - wanted) <= 1e-6 * std::max(1e-9, wanted) + 1e-12; }

/// The snapshot at a time, within 1/100 of the interval between two, since snapshots are taken at whole steps. why:
/// reason for the time where the user did not choose it.
std::size_t snapshot_at(const StoredRun& stored, double time, const std::string& why = "") {
  std::string times;
  for (std::size_t k = 0; k < stored.snapshots(); ++k) {
    const double t = stored.time(k);
    double between = k > 0 ? t - stored.time(k - 1) : infinity;
    if (k + 1 < stored.snapshots()) between = std::min(between, stored.time(k + 1) - t);
    if (is_at(t, time) || (between < infinity && std::abs(t - time) <= 0.01 * between)) return k;
    times += fmt::format("{}{:.6g}", times.empty() ? "" : ", ", t);
  }
  throw SceneError(fmt::format("{}the run has no snapshot of {:.6g} s; there are {} s", why, time, times));
}

/// Cuts the record at a time: events that began later have not begun.
void cut_record(RunRecord& record, double time) {
  if (record.stages.empty()) return;
  std::size_t k = 0;
  while (k + 1 < record.stages.size() && time > record.stages[k].until && !is_at(record.stages[k].until, time)) ++k;
  if (k + 1 == record.stages.size()) return;
  if (k < record.scenes)
    throw SceneError(
        fmt::format("at {:.6g} s the run had another scene, which `epafi resume --scene` has replaced at "
                    "{:.6g} s; start from a later time",
                    time, record.stages[record.scenes].from));
  record.stages.resize(k + 1);
  record.stage = k - record.scenes;
  record.time_step.reset();
}

/// Sets bodies to their stored state; removes those that are not in the snapshot.
void place_as_stored(Assembly& a, const StoredRun& stored, const StoredSnapshot& snapshot) {
  World& w = a.simulation->world;
  std::vector<char> there(w.ids_given(), 0);
  for (const BodyRecord& b : snapshot.bodies)
    if (b.id < there.size()) there[b.id] = 1;
  for (const PourBodies* source : a.sources)
    for (const WaitingBody& waiting : source->setup().bodies)
      if (there[static_cast<std::size_t>(waiting.id)] != 0) w.add(waiting.body, waiting.id);
  std::vector<BodyId> absent;
  for (Slot s = 0; s < w.size(); ++s)
    if (there[static_cast<std::size_t>(w.id[s])] == 0) absent.push_back(w.id[s]);
  if (!absent.empty()) w.remove(absent);
  for (const BodyRecord& b : snapshot.bodies) {
    const Slot s = b.id < w.ids_given() ? w.slot_of(static_cast<BodyId>(b.id)) : no_slot;
    if (s == no_slot) throw SceneError(fmt::format("body {} of that time is not in the scene", b.id));
    w.position[s] = b.pose.position;
    w.velocity[s] = b.velocity;
    if (w.has_orientation() && snapshot.stamp.has_orientation) {
      const ShapeOrigin* origin = a.origins.of(w.shape[s]);
      const bool turned = origin != nullptr && origin->is_turned() && stored.has_axes_of_the_scene();
      w.orientation[s] = b.pose.orientation;
      if (turned) w.orientation[s] = w.orientation[s] * origin->to_author;
    }
    if (w.rotates()) w.set_angular_velocity(s, b.angular_velocity);
    if (w.cell) w.wraps[s].setZero();
  }
}

/// Motions began at the position of the body at the start of their stage.
void begin_drives(Assembly& a, const RunRecord& record, const StoredRun& stored) {
  for (auto& event : a.simulation->events) {
    auto* drive = dynamic_cast<DriveBody*>(event.get());
    const auto known = drive ? std::ranges::find(a.drives, drive->body(), &Assembly::Drive::body) : a.drives.end();
    if (known == a.drives.end() || known->since.stage == 0) continue;
    const double from = record.stages[record.scenes + known->since.stage].from;
    const std::string why = fmt::format("what drives '{}' began then, and ", body_name(a, drive->body()));
    for (const BodyRecord& b : stored.snapshot(snapshot_at(stored, from, why)).bodies)
      if (static_cast<BodyId>(b.id) == drive->body()) drive->begin_at(b.pose.position);
  }
}

}  // namespace

std::shared_ptr<MadeRun> open_made_run_at(const std::filesystem::path& folder, double time) {
  const StoredRun stored(folder / "run.h5");
  const StoredSnapshot snapshot = stored.snapshot(snapshot_at(stored, time));
  time = snapshot.stamp.time;
  auto made = with_header(folder);
  cut_record(made->record, time);
  assemble_made(*made);
  const auto& cell = made->assembly->scene.cell;
  if (cell && cell->deforms && !is_at(time, made->header.time))
    throw SceneError("the cell of the run deforms and its shape at that time is not stored; start from the last state");
  World& w = made->assembly->simulation->world;
  const auto file = folder / "checkpoint.h5";
  if (is_at(time, made->header.time)) load_state(file, [&](StateVisitor& v) { made->assembly->simulation->visit(v); });
  place_as_stored(*made->assembly, stored, snapshot);
  begin_drives(*made->assembly, made->record, stored);
  w.time = snapshot.stamp.time;
  w.clock = made->record.stages.empty() ? w.time : w.time - made->record.stages.back().from;
  made->hash = snapshot.stamp.state_hash;
  return made;
}

}  // namespace epafi
