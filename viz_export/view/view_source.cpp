#include "viz_export/view/view_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "engine/state/hash.h"
#include "engine/units/error.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/measures/measure_rows.h"
#include "viz_export/vtk/pvd_file.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr int contacts_part = 2;  // of the files of one time in frames.pvd

/// Contact files by time; none where the run wrote no frames.
std::map<double, fs::path> contact_files(const fs::path& folder) {
  std::map<double, fs::path> out;
  if (!fs::exists(folder / "frames.pvd")) return out;
  PvdFile list(folder / "frames.pvd");
  list.keep_until(std::numeric_limits<double>::infinity());
  for (const auto& entry : list.entries())
    if (entry.part == contacts_part) out[entry.time] = folder / entry.file;
  return out;
}

bool has_contact_files(const fs::path& folder) {
  const std::vector<fs::path> files = files_with(folder / "frames", ".vtp");
  return std::ranges::any_of(files, [](const fs::path& f) { return f.filename().string().starts_with("contacts_"); });
}

/// Status of a run that ended early, from summary.json, as "interrupted"; "" for others or where unreadable.
std::string early_end(const fs::path& folder) {
  try {
    const std::string status =
        fs::exists(folder / "summary.json") ? read_json(folder / "summary.json").text("status") : "";
    return status == "interrupted" || status == "failed" ? status : "";
  } catch (const FileError&) {
    return {};  // a report says that it is damaged
  }
}

/// True for a measure with the components of energies.
bool tells_energies(const StoredMeasure& m) {
  const auto has = [&](const char* name) { return std::ranges::count(m.components, name) > 0; };
  return has("kinetic") && has("potential");
}

/// Adds rows of one time as one row of the measure; missing components are NaN.
void add_rows(const std::vector<MeasureRow>& rows, StoredMeasure& m) {
  const double before = m.times.empty() ? -std::numeric_limits<double>::infinity() : m.times.back();
  for (const MeasureRow& row : rows) {
    if (row.measure != m.name || !(row.time > before)) continue;
    const auto component = std::ranges::find(m.components, row.component);
    if (component == m.components.end()) continue;
    if (m.times.empty() || m.times.back() != row.time) {
      m.times.push_back(row.time);
      m.values.resize(m.values.size() + m.components.size(), std::numeric_limits<double>::quiet_NaN());
    }
    m.values[m.values.size() - m.components.size() + static_cast<std::size_t>(component - m.components.begin())] =
        row.value;
  }
}

/// Measures that every run has: energies, contacts, residual (progress.csv).
std::vector<StoredMeasure> own_measures(const fs::path& folder) {
  std::vector<StoredMeasure> out;
  const auto rows = measure_rows(folder / "progress.csv");
  for (const MeasureRow& row : rows) {
    auto at = std::ranges::find(out, row.measure, &StoredMeasure::name);
    if (at == out.end()) at = out.insert(at, {row.measure, row.measure == "energy" ? "energy" : "run", {}, {}, {}});
    if (std::ranges::count(at->components, row.component) == 0) at->components.push_back(row.component);
  }
  for (StoredMeasure& m : out) {
    add_rows(rows, m);
    m.name = "run";
  }
  return out;
}

/// Squares of half-spaces far from their body's origin, whose corners would coincide in single precision. The body is
/// shown as if it were at the middle of its square.
class FarSquares {
 public:
  void take(std::vector<BodyRecord>& bodies) {
    constexpr double far = 100;  // sizes
    for (BodyRecord& b : bodies) {
      if (b.surface == nullptr || !std::isinf(b.radius) || b.surface->points.size() != 4) continue;
      const auto& corners = b.surface->points;
      const Vec3 middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
      if (!(middle.norm() > far * (corners[2] - corners[0]).norm())) continue;
      Square& square = squares_[b.id];
      square = {middle, std::make_unique<Surface>(*b.surface)};
      for (Vec3& corner : square.surface->points) corner -= middle;
    }
    move(bodies);
  }
  void move(std::vector<BodyRecord>& bodies) const {
    if (squares_.empty()) return;
    for (BodyRecord& b : bodies) {
      const auto square = squares_.find(b.id);
      if (square == squares_.end() || b.surface == nullptr) continue;
      b.surface = square->second.surface.get();
      b.pose.position = b.pose.to_world(square->second.middle);
    }
  }

 private:
  struct Square {
    Vec3 middle;
    std::unique_ptr<Surface> surface;
  };
  std::map<std::uint32_t, Square> squares_;
};

class RunSource final : public ViewSource {
 public:
  explicit RunSource(const fs::path& folder)
      : folder_(folder),
        state_(run_state(folder)),
        run_(folder / "run.h5"),
        about_(about_from_text(run_.about())),
        bodies_(run_.bodies()) {
    squares_.take(bodies_);
    try {
      contacts_ = contact_files(folder);
    } catch (const FileError& e) {
      warn(fmt::format("{}: frames are shown without contacts", e.what()));
    }
    if (contacts_.empty() && state_.life == RunLife::over && has_contact_files(folder))
      warn((folder / "frames.pvd").string() +
           ": names no files of contacts, though frames/ holds some: frames are "
           "shown without contacts");
    look_for_contact_files();
    if (state_.life == RunLife::over) early_end_ = early_end(folder);
    for (const char* name : {"measures.csv", "progress.csv"}) {
      GarbledRows garbled;
      (void)measure_rows(folder / name, 0.0, &garbled);
      if (garbled.count > 0) warn(garbled.text(folder / name));
    }
    for (std::size_t k = 0; k < run_.snapshots(); ++k) times_.push_back(run_.time(k));
    residuals_ = look_for_residuals();
  }
  std::string title() const override { return run_.title(); }
  const RunAbout& about() const override { return about_; }
  const std::vector<double>& times() const override { return times_; }
  const std::vector<BodyRecord>& bodies() const override { return bodies_; }
  std::vector<StoredMeasure> measures() const override {
    std::vector<StoredMeasure> out = run_.measures();
    double known = std::numeric_limits<double>::infinity();
    for (const StoredMeasure& m : out) known = std::min(known, m.times.empty() ? -1.0 : m.times.back());
    if (state_.life != RunLife::over) {
      const auto rows = measure_rows(folder_ / "measures.csv", known);
      for (StoredMeasure& m : out) add_rows(rows, m);
    }
    const bool has_energies = std::ranges::any_of(out, tells_energies);
    for (StoredMeasure& m : own_measures(folder_))
      if (!has_energies || !tells_energies(m)) out.push_back(std::move(m));
    return out;
  }
  bool has_contacts() const override { return !contacts_.empty(); }
  bool has_residuals() const override { return residuals_; }
  bool is_running() const override { return state_.life == RunLife::running; }
  std::string identity() const override {
    Hash hash;
    for (const std::string& text : {run_.version(), run_.title(), run_.scene_text(), run_.overrides(), run_.about()})
      hash.add(text);
    return hash.hex();
  }
  std::vector<std::string> state_hashes() const override {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < times_.size(); ++k) out.push_back(run_.state_hash(k));
    return out;
  }
  std::string cut_text() const override {
    if (state_.life != RunLife::cut) return {};
    return fmt::format("the run was cut off after t = {:.6g} s: {}", last_time(), state_.cause);
  }
  std::string stop_text() const override {
    const std::string how = state_.life == RunLife::cut ? "cut off" : early_end_;
    if (how.empty()) return {};
    const std::string of = about_.duration > 0 ? fmt::format(" of {:.6g}", about_.duration) : "";
    return fmt::format("{} at {:.4g}{} s", how, last_time(), of);
  }
  std::vector<std::string> warnings() const override {
    const std::lock_guard lock(warnings_lock_);
    std::vector<std::string> out = warnings_;
    if (damaged_.size() == 1) out.push_back(*damaged_.begin() + ": this frame is shown without contacts");
    if (damaged_.size() > 1)
      out.push_back(
          fmt::format("{} files of contacts are damaged, their frames are shown without contacts; the first: {}",
                      damaged_.size(), *damaged_.begin()));
    return out;
  }
  double last_time() const override {
    double out = ViewSource::last_time();
    for (const char* name : {"measures.csv", "progress.csv"})
      for (const MeasureRow& row : measure_rows(folder_ / name, out)) out = std::max(out, row.time);
    return out;
  }

  ViewFrame frame(std::size_t k) const override {
    StoredSnapshot s = run_.snapshot(k);
    ViewFrame out{s.stamp.time, s.stamp.rotates, s.stamp.has_orientation, std::move(s.bodies), {}};
    squares_.move(out.bodies);
    const auto file = contacts_.find(out.time);
    if (file == contacts_.end() || !fs::exists(file->second)) return out;
    out.contacts = contacts_of(file->second).contacts;
    std::sort(out.contacts.begin(), out.contacts.end(),
              [](const StoredContact& p, const StoredContact& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
    return out;
  }

 private:
  /// Where all contact files are missing, forces are unknown rather than zero.
  void look_for_contact_files() {
    const auto missing = std::ranges::count_if(contacts_, [](const auto& f) { return !fs::exists(f.second); });
    if (missing == 0) return;
    const auto all = std::ssize(contacts_);
    warn(fmt::format("{}: {} of its {} files of contacts {} missing{}", (folder_ / "frames.pvd").string(), missing, all,
                     missing == 1 ? "is" : "are",
                     missing == all ? ": contacts are not stored in this folder, frames are shown without contacts"
                                    : ": their frames are shown without contacts"));
    if (missing == all) contacts_.clear();
  }
  /// True where the last frame with contacts has residuals.
  bool look_for_residuals() const {
    for (auto file = contacts_.rbegin(); file != contacts_.rend(); ++file) {
      if (!fs::exists(file->second)) continue;
      const ContactFile last = contacts_of(file->second);
      if (!last.contacts.empty()) return last.has_residual;
    }
    return false;
  }

  /// Contacts of a file; none where it is damaged, with one warning for all such files, since run.h5 still has the
  /// bodies.
  ContactFile contacts_of(const fs::path& file) const {
    try {
      return read_contacts(file);
    } catch (const FileError& e) {
      const std::lock_guard lock(warnings_lock_);
      damaged_.insert(e.what());
    }
    return {};
  }
  void warn(const std::string& text) const {
    const std::lock_guard lock(warnings_lock_);
    if (std::ranges::count(warnings_, text) == 0) warnings_.push_back(text);
  }

  mutable std::mutex warnings_lock_;
  mutable std::vector<std::string> warnings_;
  mutable std::set<std::string> damaged_;  ///< files of contacts, and what is wrong with them
  fs::path folder_;
  RunState state_;  ///< read before the files: what they hold is not older
  StoredRun run_;
  RunAbout about_;
  std::vector<BodyRecord> bodies_;
  FarSquares squares_;
  std::map<double, fs::path> contacts_;
  bool residuals_ = false;
  std::string early_end_;  ///< of a run that is over
  std::vector<double> times_;
};

class StillSource final : public ViewSource {
 public:
  StillSource(std::string title, RunAbout about, ViewFrame frame)
      : title_(std::move(title)), about_(std::move(about)), frame_(std::move(frame)), times_{frame_.time} {
    squares_.take(frame_.bodies);
    for (const BodyRecord& b : frame_.bodies) {
      bodies_.resize(std::max<std::size_t>(bodies_.size(), b.id + 1u));
      bodies_[b.id] = b;
    }
  }
  std::string title() const override { return title_; }
  const RunAbout& about() const override { return about_; }
  const std::vector<double>& times() const override { return times_; }
  const std::vector<BodyRecord>& bodies() const override { return bodies_; }
  std::vector<StoredMeasure> measures() const override { return {}; }
  bool has_contacts() const override { return false; }
  bool has_residuals() const override { return false; }
  bool is_running() const override { return false; }
  ViewFrame frame(std::size_t) const override { return frame_; }

 private:
  std::string title_;
  RunAbout about_;
  ViewFrame frame_;
  FarSquares squares_;
  std::vector<double> times_;
  std::vector<BodyRecord> bodies_;
};

}  // namespace

std::unique_ptr<ViewSource> open_run(const fs::path& folder, const std::string& command) {
  if (!fs::exists(folder / "run.h5")) throw FileError(no_run_text(folder, command));
  // A live run may be in the middle of a write: read again, for two seconds at most.
  constexpr int tries = 40;
  for (int k = 1;; ++k) {
    try {
      return std::make_unique<RunSource>(folder);
    } catch (const FileError&) {
      if (k == tries || run_state(folder).life != RunLife::running) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

std::unique_ptr<ViewSource> still_source(std::string title, RunAbout about, ViewFrame frame) {
  return std::make_unique<StillSource>(std::move(title), std::move(about), std::move(frame));
}

}  // namespace epafi
