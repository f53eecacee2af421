#include "viz_export/hdf5/run_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/run_layout.h"
#include "viz_export/output/output_thread.h"

namespace epafi {

namespace {

constexpr Hdf5Layout growing{.extendable = true, .chunk_rows = 512};
constexpr std::size_t most_buffered =
    1 << 16;  // values; 512 kB are lost at most in a crash, and written again on resume

std::string numbered(const char* group, std::size_t k) { return fmt::format("{}/{:06d}", group, k); }

/// Valid link name: HDF5 permits neither '/' nor '.' alone.
std::string link_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '|');
  return name.empty() || name == "." ? "_" : name;
}

template <class T, class F>
void append_column(Hdf5File& file, const std::string& name, std::size_t n, const F& f) {
  constexpr std::size_t piece = 65536;
  std::vector<T> values;
  for (std::size_t first = 0; first < n; first += piece) {
    values.resize(std::min(piece, n - first));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<T>(f(first + k));
    file.append<T>(name, values);
  }
}

/// Writes `width` doubles per body.
template <class F>
void write_rows(Hdf5File& file, const std::string& name, std::size_t width, std::size_t n, const F& row) {
  file.write_pieces<double>(name, n, width, [&](std::size_t first, std::size_t count, double* to) {
    for (std::size_t k = 0; k < count; ++k) row(first + k, to + width * k);
  });
}

void put(const Vec3& v, double* to) { std::copy_n(v.data(), 3, to); }

std::string joined(const std::vector<std::string>& words, char separator) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : std::string(1, separator)) + w;
  return out;
}

/// The number in the name of a group.
std::int32_t number_of(const std::filesystem::path& path, const std::string& name) {
  std::int32_t number = -1;
  const auto end = std::from_chars(name.data(), name.data() + name.size(), number);
  if (end.ec != std::errc{} || end.ptr != name.data() + name.size() || number < 0)
    throw FileError(path.string() + ": is damaged: group 'shapes/" + name + "' is not a number");
  return number;
}

void check_scene(const std::filesystem::path& path, const std::string& scene_hash) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  if (const std::uint64_t found = run_layout::check(file); found != run_layout::format)
    throw FileError(path.string() + ": cannot continue it: it has run format " + std::to_string(found) +
                    ", this program writes " + std::to_string(run_layout::format) +
                    "; resume it by the version that wrote it, or start the run anew");
  if (file.text_attribute("/", "scene_hash") != scene_hash)
    throw FileError(path.string() + ": cannot continue it: it belongs to another scene");
}

}  // namespace

RunFile::RunFile(std::filesystem::path path, const RunFileHeader& header)
    : path_(std::move(path)), origins_(header.shapes) {
  SideFile side(path_);
  Hdf5File file(side.path(), Hdf5File::Mode::create);
  file.set_attribute("/", "kind", std::string(run_layout::kind));
  file.set_attribute("/", "format", run_layout::format);
  file.set_attribute("/", "version", header.version);
  file.set_attribute("/", "scene_hash", header.scene_hash);
  file.set_attribute("/", "title", header.title);
  file.write_text("scene", header.scene_text);
  file.write_text("overrides", joined(header.overrides, '\n'));
  file.write_text("about", header.about);
  file.write<std::uint32_t>("bodies/shape", {}, growing);
  file.write<std::int32_t>("bodies/surface", {}, growing);
  file.write<std::uint16_t>("bodies/material", {}, growing);
  file.write<double>("bodies/mass", {}, growing);
  file.write<double>("bodies/radius", {}, growing);
  for (const char* group : {"shapes", "snapshots", "measures"}) file.make_group(group);
  file.close();
  side.commit(false);
}

RunFile::RunFile(std::filesystem::path path, const RunFileHeader& header, std::uint64_t step, double time)
    : path_(std::move(path)), origins_(header.shapes) {
  check_scene(path_, header.scene_hash);
  drop_after(step, time);
}

void RunFile::drop_after(std::uint64_t step, double time) {
  Hdf5File file(path_, Hdf5File::Mode::append);
  for (const std::string& name : file.children("snapshots")) {
    const std::string group = "snapshots/" + name;
    const std::uint64_t stored = file.count_attribute(group, "step");
    if (stored > step) {
      file.remove(group);
      continue;
    }
    ++snapshots_;
    last_step_ = static_cast<std::int64_t>(stored);
  }
  for (const std::string& name : file.children("measures")) {
    const auto times = file.read<double>("measures/" + name + "/time");
    const auto kept = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
    file.truncate("measures/" + name + "/time", kept);
    file.truncate("measures/" + name + "/value", kept);
  }
  for (const std::string& name : file.children("shapes"))
    surfaces_[static_cast<std::uint32_t>(file.count_attribute("shapes/" + name, "shape"))] = number_of(path_, name);
  shape_groups_ = static_cast<std::int32_t>(file.children("shapes").size());
  const auto rows = file.shape("bodies/shape");
  if (rows.empty()) throw FileError(path_.string() + ": is damaged: 'bodies/shape' is no column");
  const auto mass = file.read<double>("bodies/mass"), radius = file.read<double>("bodies/radius");
  if (mass.size() != rows[0] || radius.size() != rows[0])
    throw FileError(path_.string() + ": is damaged: the columns of 'bodies' differ in length");
  described_.resize(rows[0]);
  for (std::size_t id = 0; id < rows[0]; ++id) described_[id] = mass[id] != 0.0 || radius[id] != 0.0;
  file.close();
}

void RunFile::append_bodies(Hdf5File& file, const BodyList& bodies) {
  describe_late(file, bodies);
  // rows by id: bodies that come later, or came and went between two snapshots, have zero mass and radius
  const std::size_t n = bodies.size(), before = described_.size();
  const std::size_t known = n == 0 ? before : std::max<std::size_t>(before, bodies.id(n - 1) + 1u);
  const std::size_t fresh = known - before;
  if (fresh == 0) return;
  constexpr std::uint32_t nobody = ~std::uint32_t{0};
  std::vector<std::uint32_t> rows(fresh, nobody);  // place in `bodies`
  for (std::size_t k = n; k-- > 0;) {
    const std::uint32_t id = bodies.id(k);
    if (id < before) break;
    rows[id - before] = static_cast<std::uint32_t>(k);
  }
  for (const std::uint32_t k : rows) {
    if (k != nobody) add_surface(file, bodies[k]);
    described_.push_back(k != nobody);
  }
  const auto record = [&](std::size_t row) { return rows[row] == nobody ? BodyRecord{} : bodies[rows[row]]; };
  append_column<std::uint32_t>(file, "bodies/shape", fresh, [&](std::size_t k) { return record(k).shape; });
  append_column<std::int32_t>(file, "bodies/surface", fresh, [&](std::size_t k) {
    const BodyRecord b = record(k);
    return b.surface == nullptr ? -1 : surfaces_.at(b.shape);
  });
  append_column<std::uint16_t>(file, "bodies/material", fresh, [&](std::size_t k) { return record(k).material; });
  append_column<double>(file, "bodies/mass", fresh, [&](std::size_t k) { return record(k).mass; });
  append_column<double>(file, "bodies/radius", fresh, [&](std::size_t k) { return record(k).radius; });
}

/// Fills rows that exist without data: bodies of a source have low ids but come late.
void RunFile::describe_late(Hdf5File& file, const BodyList& bodies) {
  std::vector<std::size_t> late;  // places in `bodies`, ascending ids
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (const std::uint32_t id = bodies.id(k); id < described_.size() && !described_[id]) late.push_back(k);
  for (std::size_t begin = 0, end = 0; begin < late.size(); begin = end) {
    std::vector<BodyRecord> run;  // of consecutive ids
    for (; end < late.size() && bodies.id(late[end]) == bodies.id(late[begin]) + (end - begin); ++end) {
      run.push_back(bodies[late[end]]);
      add_surface(file, run.back());
      described_[run.back().id] = true;
    }
    const auto column = [&]<class T>(const char* name, T of) {
      std::vector<decltype(of(run[0]))> values;
      for (const BodyRecord& b : run) values.push_back(of(b));
      file.overwrite<decltype(of(run[0]))>(name, run[0].id, values);
    };
    column("bodies/shape", [](const BodyRecord& b) { return b.shape; });
    column("bodies/surface", [&](const BodyRecord& b) { return b.surface ? surfaces_.at(b.shape) : -1; });
    column("bodies/material", [](const BodyRecord& b) { return b.material; });
    column("bodies/mass", [](const BodyRecord& b) { return b.mass; });
    column("bodies/radius", [](const BodyRecord& b) { return b.radius; });
  }
}

void RunFile::add_surface(Hdf5File& file, const BodyRecord& b) {
  if (b.surface == nullptr || surfaces_.count(b.shape) != 0) return;
  const std::int32_t number = shape_groups_++;
  const std::string group = numbered("shapes", static_cast<std::size_t>(number));
  const ShapeOrigin* origin = origins_.of(b.shape);
  const bool turned = origin != nullptr && origin->is_turned();
  write_rows(file, group + "/points", 3, b.surface->points.size(), [&](std::size_t k, double* to) {
    const Vec3& x = b.surface->points[k];
    put(turned ? Vec3(origin->to_author * x) : x, to);
  });
  file.write<std::int32_t>(group + "/connectivity", b.surface->connectivity);
  file.write<std::int32_t>(group + "/offsets", b.surface->offsets);
  file.set_attribute(group, "shape", std::uint64_t{b.shape});
  if (b.surface->curved) file.set_attribute(group, "curved", std::uint64_t{1});
  if (origin != nullptr) {
    file.set_attribute(group, "name", origin->shape());
    file.set_attribute(group, "size", origin->size);
  }
  surfaces_[b.shape] = number;
}

/// Writes orientations of the shapes as given in the scene; the engine's refer to principal axes.
void RunFile::write_orientations(Hdf5File& file, const std::string& group, const BodyList& bodies) {
  write_rows(file, group + "/orientation", 4, bodies.size(), [&](std::size_t k, double* to) {
    Quat q = bodies.pose(k).orientation;
    const ShapeOrigin* origin = bodies.is_sphere(k) ? nullptr : origins_.of(bodies.shape(k));
    if (origin != nullptr && origin->is_turned()) q = q * origin->to_author.conjugate();
    to[0] = q.w();
    to[1] = q.x();
    to[2] = q.y();
    to[3] = q.z();
  });
}

std::optional<RunFile::Snapshot> RunFile::begin_snapshot(SnapshotStamp stamp) {
  if (static_cast<std::int64_t>(stamp.step) <= last_step_) return std::nullopt;
  last_step_ = static_cast<std::int64_t>(stamp.step);
  return Snapshot{std::move(stamp), take_measures()};
}

void RunFile::add_snapshot(const SnapshotStamp& stamp, const BodyList& bodies) {
  if (const auto snapshot = begin_snapshot(stamp)) write(*snapshot, bodies);
}

void RunFile::write(const Snapshot& snapshot, const BodyList& bodies) {
  const SnapshotStamp& stamp = snapshot.stamp;
  Hdf5File file(path_, Hdf5File::Mode::append);
  append_measures(file, snapshot.measures);
  append_bodies(file, bodies);
  const std::string group = numbered("snapshots", snapshots_);
  const std::size_t n = bodies.size();
  file.write_pieces<std::uint32_t>(group + "/id", n, 1, [&](std::size_t first, std::size_t count, std::uint32_t* to) {
    for (std::size_t k = 0; k < count; ++k) to[k] = bodies.id(first + k);
  });
  write_rows(file, group + "/position", 3, n, [&](std::size_t k, double* to) { put(bodies.position(k), to); });
  write_rows(file, group + "/velocity", 3, n, [&](std::size_t k, double* to) { put(bodies.velocity(k), to); });
  if (stamp.has_orientation) write_orientations(file, group, bodies);
  if (stamp.rotates)
    write_rows(file, group + "/angular_velocity", 3, n,
               [&](std::size_t k, double* to) { put(bodies.angular_velocity(k), to); });
  write_rows(file, group + "/kinetic_energy", 1, n, [&](std::size_t k, double* to) { *to = bodies.kinetic_energy(k); });
  file.set_attribute(group, "step", stamp.step);
  file.set_attribute(group, "time", stamp.time);
  file.set_attribute(group, "state_hash", stamp.state_hash);
  if (!stamp.stage.empty()) file.set_attribute(group, "stage", stamp.stage);
  file.close();
  ++snapshots_;
}

std::size_t RunFile::define_measure(const std::string& name, const std::vector<std::string>& components,
                                    const std::string& kind) {
  const std::string group = "measures/" + link_name(name);
  measures_.push_back({group, components.size(), {}, {}});
  Hdf5File file(path_, Hdf5File::Mode::append);
  if (!file.has(group)) {
    file.write<double>(group + "/time", {}, growing);
    file.write<double>(group + "/value", {}, {.columns = components.size(), .extendable = true, .chunk_rows = 512});
    file.set_attribute(group, "name", name);
    file.set_attribute(group, "kind", kind);
    file.set_attribute(group, "components", joined(components, ','));
  } else if (file.text_attribute(group, "components") != joined(components, ',')) {
    throw FileError(path_.string() + ": measure '" + name + "' has other components than this scene's");
  }
  file.close();
  return measures_.size() - 1;
}

void RunFile::add_measure(std::size_t measure, double time, const std::vector<double>& values) {
  Measure& m = measures_.at(measure);
  EPAFI_REQUIRE(values.size() == m.components, "one value per component");
  m.times.push_back(time);
  m.values.insert(m.values.end(), values.begin(), values.end());
  buffered_ += 1 + values.size();
  if (buffered_ < most_buffered) return;
  if (beside_ == nullptr) return append_measures(take_measures());
  beside_->add([this, rows = take_measures()] { append_measures(rows); });
}

std::vector<RunFile::Rows> RunFile::take_measures() {
  std::vector<Rows> out;
  for (std::size_t k = 0; k < measures_.size(); ++k) {
    Measure& m = measures_[k];
    if (!m.times.empty()) out.push_back({k, std::exchange(m.times, {}), std::exchange(m.values, {})});
  }
  buffered_ = 0;
  return out;
}

void RunFile::append_measures(const std::vector<Rows>& rows) {
  Hdf5File file(path_, Hdf5File::Mode::append);
  append_measures(file, rows);
  file.close();
}

void RunFile::append_measures(Hdf5File& file, const std::vector<Rows>& rows) {
  for (const Rows& r : rows) {
    file.append<double>(measures_[r.measure].group + "/time", r.times);
    file.append<double>(measures_[r.measure].group + "/value", r.values);
  }
}

void RunFile::flush() {
  append_measures(take_measures());
  sync_to_disk(path_);
}

}  // namespace epafi
