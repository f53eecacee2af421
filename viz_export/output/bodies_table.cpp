#include "viz_export/output/bodies_table.h"

#include <fmt/format.h>

#include <iterator>
#include <map>
#include <optional>

#include "engine/units/error.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/run_layout.h"

namespace epafi {

void append_state(std::string& out, const BodyRecord& b) {
  const Quat& q = b.pose.orientation;
  const Vec3 &x = b.pose.position, &v = b.velocity, &w = b.angular_velocity;
  const double values[] = {x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), q.w(), q.x(), q.y(), q.z(), w.x(), w.y(), w.z()};
  const char* comma = "";
  for (const double value : values) {
    fmt::format_to(std::back_inserter(out), "{}{:.17g}", comma, value);
    comma = ",";
  }
}

namespace {

/// Quotes a cell with a comma or a quote; quotes inside are doubled.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// Columns of numbers, of equal length.
struct BodyColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;

  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  void add(const std::string& name, std::vector<double> column) {
    if (!values.empty() && column.size() != rows())
      throw FileError(fmt::format("'{}' has {} values, '{}' {}", name, column.size(), names[0], rows()));
    names.push_back(name);
    values.push_back(std::move(column));
  }
};

/// Names of the columns of a dataset of vectors; empty where it does not describe bodies.
std::vector<std::string> parts_of(const std::string& name) {
  static const std::map<std::string, std::vector<std::string>> parts{{"position", {"x", "y", "z"}},
                                                                     {"velocity", {"vx", "vy", "vz"}},
                                                                     {"angular_velocity", {"wx", "wy", "wz"}},
                                                                     {"orientation", {"qw", "qx", "qy", "qz"}}};
  const auto found = parts.find(name);
  return found == parts.end() ? std::vector<std::string>{} : found->second;
}

/// Extent of a dataset; none for a group.
std::optional<std::vector<std::size_t>> extent_of(const Hdf5File& file, const std::string& name) {
  try {
    return file.shape(name);
  } catch (const FileError&) {
    return std::nullopt;
  }
}

BodyColumns columns_of(const Hdf5File& file) {
  BodyColumns out;
  for (const std::string& name : file.children("/")) {
    const auto extent = extent_of(file, name);
    if (!extent) continue;
    const std::vector<std::string> parts = parts_of(name);
    if (extent->size() == 1) out.add(name, file.read<double>(name));
    if (parts.empty() || extent->size() != 2 || (*extent)[1] != parts.size()) continue;
    const std::vector<double> all = file.read<double>(name);
    for (std::size_t c = 0; c < parts.size(); ++c) {
      std::vector<double> column;
      for (std::size_t k = c; k < all.size(); k += parts.size()) column.push_back(all[k]);
      out.add(parts[c], std::move(column));
    }
  }
  if (out.names.empty()) throw FileError("it has no datasets of numbers, one a column, such as x, y, z and radius");
  return out;
}

}  // namespace

std::string bodies_csv(const StoredRun& run, const std::vector<BodyRecord>& bodies) {
  std::vector<StoredWords> words;
  bool sized = false, material = true, group = false;
  for (const BodyRecord& b : bodies) {
    words.push_back(run.words(b));
    if (b.is_wall()) continue;
    sized = sized || b.surface != nullptr;
    material = material && !words.back().material.empty();
    group = group || !words.back().group.empty();
  }
  std::string out = std::string(state_columns) + ",radius" + (sized ? ",shape,size" : "") +
                    (material ? ",material" : "") + (group ? ",group\n" : "\n");
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyRecord& b = bodies[k];
    if (b.is_wall()) continue;
    append_state(out, b);
    const bool is_sphere = b.surface == nullptr;
    out += is_sphere ? fmt::format(",{:.17g}", b.radius) : ",";
    if (sized) out += is_sphere ? ",," : fmt::format(",{},{:.17g}", csv_cell(words[k].shape), words[k].size);
    if (material) out += "," + csv_cell(words[k].material);
    if (group) out += "," + csv_cell(words[k].group);
    out += '\n';
  }
  return out;
}

std::string bodies_csv(const std::filesystem::path& hdf5) {
  std::optional<BodyColumns> columns;
  {
    const Hdf5File file(hdf5, Hdf5File::Mode::read);
    const bool is_run = file.has_attribute("/", "kind") && file.text_attribute("/", "kind") == run_layout::kind;
    if (!is_run) columns = columns_of(file);
  }
  if (!columns) {
    const StoredRun run(hdf5);
    if (run.snapshots() == 0) throw FileError("the run has no snapshot");
    return bodies_csv(run, run.snapshot(run.snapshots() - 1).bodies);
  }
  std::string out = fmt::format("{}\n", fmt::join(columns->names, ","));
  for (std::size_t row = 0; row < columns->rows(); ++row)
    for (std::size_t c = 0; c < columns->values.size(); ++c)
      out += fmt::format("{}{:.17g}{}", c == 0 ? "" : ",", columns->values[c][row],
                         c + 1 == columns->values.size() ? "\n" : "");
  return out;
}

}  // namespace epafi
