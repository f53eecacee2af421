#include "viz_export/output/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "engine/units/error.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/measures/measures_csv.h"
#include "viz_export/output/bodies_table.h"
#include "viz_export/vtk/frame_writer.h"

namespace epafi {

namespace {

void append_rows(std::string& out, const StoredSnapshot& snapshot) {
  for (const BodyRecord& b : snapshot.bodies) {
    fmt::format_to(std::back_inserter(out), "{:.17g},{},{},{},{:.17g},{:.17g},", snapshot.stamp.time,
                   snapshot.stamp.step, b.id, b.material, b.mass, b.radius);
    append_state(out, b);
    out += '\n';
  }
}

/// Writes a table whose parts `next` returns, until it returns "".
template <class Next>
void write_table(const std::filesystem::path& path, const std::string& header, Next&& next) {
  SideFile side(path);
  std::ofstream out(side.path(), std::ios::binary);
  out << header << '\n';
  for (std::string rows = next(); !rows.empty(); rows = next()) out << rows;
  out.close();
  if (!out) throw FileError(path.string() + ": cannot write (is the disk full?)");
  side.commit(false);
}

void write_snapshots_csv(const std::filesystem::path& path, const StoredRun& run) {
  std::size_t k = 0;
  write_table(path, std::string("time,step,id,material,mass,radius,") + state_columns, [&] {
    std::string rows;
    while (rows.empty() && k < run.snapshots()) append_rows(rows, run.snapshot(k++));
    return rows;
  });
}

/// Notes on what bodies.csv leaves out: it holds bodies only.
std::vector<std::string> notes_on_bodies(const StoredRun& run, const std::vector<BodyRecord>& bodies) {
  const auto is_free = [](const BodyRecord& b) { return !b.is_wall(); };
  const auto has_axes = [&](const BodyRecord& b) { return is_free(b) && b.surface != nullptr; };
  std::vector<std::string> notes;
  if (std::ranges::none_of(bodies, is_free)) return notes;
  notes.push_back(
      "bodies.csv holds bodies, not what contacts remember: in a run that starts from it springs of friction and "
      "rolling begin at zero; `epafi resume` keeps them");
  if (!run.has_axes_of_the_scene() && std::ranges::any_of(bodies, has_axes))
    notes.push_back(
        "run.h5 was written by an older version: its orientations are of principal axes, and bodies.csv reads back "
        "turned where those are not the axes of the shape");
  return notes;
}

struct Sample {
  const StoredMeasure* measure;
  std::size_t row;
};

/// A run continues measures.csv by cutting it at a time, so rows must be in order of time here too.
std::vector<Sample> samples_by_time(const std::vector<StoredMeasure>& measures) {
  std::vector<Sample> samples;
  for (const StoredMeasure& m : measures)
    for (std::size_t row = 0; row < m.times.size(); ++row) samples.push_back({&m, row});
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& p, const Sample& q) { return p.measure->times[p.row] < q.measure->times[q.row]; });
  return samples;
}

void write_measures_csv(const std::filesystem::path& path, const std::vector<StoredMeasure>& measures) {
  SideFile side(path);
  {
    MeasuresCsv csv(side.path());
    for (const Sample& s : samples_by_time(measures)) {
      const StoredMeasure& m = *s.measure;
      for (std::size_t c = 0; c < m.components.size(); ++c)
        csv.add(m.times[s.row], m.name, m.components[c], m.values[s.row * m.components.size() + c]);
    }
    csv.flush();
  }
  side.commit(false);
}

}  // namespace

ExportReport export_run(const std::filesystem::path& folder, ExportFormat format,
                        const std::vector<BodyRecord>& later) {
  if (!std::filesystem::exists(folder / "run.h5")) throw FileError(no_run_text(folder, "export"));
  const StoredRun run(folder / "run.h5");
  ExportReport report{run.snapshots(), 0, {}};
  if (format == ExportFormat::vtk) {
    FrameWriter frames(folder);
    for (std::size_t k = 0; k < run.snapshots(); ++k) {
      const StoredSnapshot snapshot = run.snapshot(k);
      frames.write_bodies(snapshot.stamp.time, snapshot.bodies);
    }
    return report;
  }
  write_snapshots_csv(folder / "snapshots.csv", run);
  if (run.snapshots() > 0) {
    const StoredSnapshot last = run.snapshot(run.snapshots() - 1);
    const std::vector<BodyRecord>& bodies = later.empty() ? last.bodies : later;
    write_whole_file(folder / "bodies.csv", {bodies_csv(run, bodies)});
    report.notes = notes_on_bodies(run, bodies);
  }
  const auto measures = run.measures();
  report.measures = measures.size();
  write_measures_csv(folder / "measures.csv", measures);
  return report;
}

}  // namespace epafi
