#include "viz_export/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "engine/error.h"
#include "viz_export/frame_writer.h"
#include "viz_export/measures_csv.h"
#include "viz_export/side_file.h"
#include "viz_export/stored_run.h"

namespace epafi {

namespace {

void append_rows(std::string& out, const StoredSnapshot& snapshot) {
  const auto put = [&](double value) { fmt::format_to(std::back_inserter(out), ",{:.17g}", value); };
  for (const BodyRecord& b : snapshot.bodies) {
    fmt::format_to(std::back_inserter(out), "{:.17g},{},{},{}", snapshot.stamp.time, snapshot.stamp.step, b.id,
                   b.material);
    put(b.mass), put(b.radius);
    for (const Vec3* v : {&b.pose.position, &b.velocity})
      for (double c : *v) put(c);
    const Quat& q = b.pose.orientation;
    for (double c : {q.w(), q.x(), q.y(), q.z()}) put(c);
    for (double c : b.angular_velocity) put(c);
    out += '\n';
  }
}

void write_snapshots_csv(const std::filesystem::path& path, const StoredRun& run) {
  SideFile side(path);
  std::ofstream out(side.path(), std::ios::binary);
  out << "time,step,id,material,mass,radius,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz\n";
  for (std::size_t k = 0; k < run.snapshots(); ++k) {
    std::string rows;
    append_rows(rows, run.snapshot(k));
    out << rows;
  }
  out.close();
  if (!out) throw FileError(path.string() + ": cannot write (is the disk full?)");
  side.commit(false);
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

ExportReport export_run(const std::filesystem::path& folder, ExportFormat format) {
  const StoredRun run(folder / "run.h5");
  ExportReport report{run.snapshots(), 0};
  if (format == ExportFormat::vtk) {
    FrameWriter frames(folder);
    for (std::size_t k = 0; k < run.snapshots(); ++k) {
      const StoredSnapshot snapshot = run.snapshot(k);
      frames.write(snapshot.stamp.time, snapshot.bodies, {});
    }
    return report;
  }
  write_snapshots_csv(folder / "snapshots.csv", run);
  const auto measures = run.measures();
  report.measures = measures.size();
  write_measures_csv(folder / "measures.csv", measures);
  return report;
}

}  // namespace epafi
