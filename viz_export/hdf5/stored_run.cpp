#include "viz_export/hdf5/stored_run.h"

#include <fstream>
#include <sstream>

#include "viz_export/hdf5/damaged_run.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/run_layout.h"
#include "viz_export/view/settings.h"

namespace epafi {

namespace {

/// Reports an error in an existing, readable file as damage.
template <class Read>
auto read_undamaged(const std::filesystem::path& path, const Read& read) {
  try {
    return read();
  } catch (const FileError& e) {
    if (!std::filesystem::is_regular_file(path) || !std::ifstream(path).is_open()) throw;
    throw DamagedRun(path, e.what());
  }
}

}  // namespace

struct StoredRun::Impl {
  explicit Impl(const std::filesystem::path& path)
      : file(read_undamaged(path, [&] { return Hdf5File(path, Hdf5File::Mode::read); })) {}
  Hdf5File file;
  std::vector<std::string> snapshots;
  std::vector<Surface> surfaces;
  std::vector<std::uint32_t> shape;
  std::vector<std::int32_t> surface;
  std::vector<std::uint16_t> material;
  std::vector<double> mass, radius;
  RunAbout about;
  struct Name {
    std::string shape;
    double size = 1.0;
  };
  std::vector<Name> names;  ///< of surfaces
  std::uint64_t format = 0;

  [[noreturn]] void refuse(const std::string& what) const {
    throw FileError(file.path().string() + ": is damaged: " + what);
  }

  void read_surface(const std::string& group_name) {
    Surface s;
    const auto points = file.read<double>(group_name + "/points");
    s.connectivity = file.read<std::int32_t>(group_name + "/connectivity");
    s.offsets = file.read<std::int32_t>(group_name + "/offsets");
    if (points.size() % 3 != 0) refuse("'" + group_name + "/points' is not a list of triples");
    for (std::size_t k = 0; k < points.size(); k += 3) s.points.emplace_back(points[k], points[k + 1], points[k + 2]);
    for (std::int32_t c : s.connectivity)
      if (c < 0 || static_cast<std::size_t>(c) >= s.points.size())
        refuse("'" + group_name + "' names a point that is not there");
    std::int32_t last = 0;
    for (std::int32_t o : s.offsets) {
      if (o < last || static_cast<std::size_t>(o) > s.connectivity.size())
        refuse("'" + group_name + "' has a wrong offset");
      last = o;
    }
    s.curved = file.has_attribute(group_name, "curved");
    surfaces.push_back(std::move(s));
    Name& name = names.emplace_back();
    if (file.has_attribute(group_name, "name")) name.shape = file.text_attribute(group_name, "name");
    if (file.has_attribute(group_name, "size")) name.size = file.number_attribute(group_name, "size");
  }

  void read_bodies() {
    shape = file.read<std::uint32_t>("bodies/shape");
    surface = file.read<std::int32_t>("bodies/surface");
    material = file.read<std::uint16_t>("bodies/material");
    mass = file.read<double>("bodies/mass");
    radius = file.read<double>("bodies/radius");
    for (std::size_t n : {surface.size(), material.size(), mass.size(), radius.size()})
      if (n != shape.size()) refuse("the columns of 'bodies' differ in length");
    for (std::int32_t s : surface)
      if (s < -1 || s >= static_cast<std::int32_t>(surfaces.size())) refuse("a body has a surface that is not there");
  }

  /// Record of a body, without position and velocity.
  BodyRecord body(std::uint32_t id) const {
    BodyRecord b;
    b.id = id;
    b.shape = shape[id];
    b.material = material[id];
    b.mass = mass[id];
    b.radius = radius[id];
    b.surface = surface[id] < 0 ? nullptr : &surfaces[static_cast<std::size_t>(surface[id])];
    return b;
  }

  StoredSnapshot read_snapshot(std::size_t k) const;
  std::vector<StoredMeasure> read_measures() const;

  std::vector<double> rows(const std::string& name, std::size_t width, std::size_t n) const {
    auto values = file.read<double>(name);
    if (values.size() != width * n) refuse("'" + name + "' has not one row per body");
    return values;
  }
};

StoredRun::StoredRun(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {
  Hdf5File& file = impl_->file;
  impl_->format = run_layout::check(file);
  read_undamaged(path, [&] {
    impl_->snapshots = file.children("snapshots");
    for (const std::string& name : file.children("shapes")) impl_->read_surface("shapes/" + name);
    impl_->read_bodies();
    impl_->about = about_from_text(about());
  });
}

StoredRun::~StoredRun() = default;

std::size_t StoredRun::snapshots() const { return impl_->snapshots.size(); }

StoredSnapshot StoredRun::snapshot(std::size_t k) const {
  return read_undamaged(impl_->file.path(), [&] { return impl_->read_snapshot(k); });
}

StoredSnapshot StoredRun::Impl::read_snapshot(std::size_t k) const {
  const std::string group = "snapshots/" + snapshots.at(k);
  StoredSnapshot out;
  out.stamp = {file.count_attribute(group, "step"),
               file.number_attribute(group, "time"),
               file.text_attribute(group, "state_hash"),
               file.has(group + "/angular_velocity"),
               file.has(group + "/orientation"),
               file.has_attribute(group, "stage") ? file.text_attribute(group, "stage") : std::string()};
  const auto id = file.read<std::uint32_t>(group + "/id");
  const std::size_t n = id.size();
  const auto x = rows(group + "/position", 3, n), v = rows(group + "/velocity", 3, n);
  const auto energy = rows(group + "/kinetic_energy", 1, n);
  std::vector<double> q, w;
  if (out.stamp.has_orientation) q = rows(group + "/orientation", 4, n);
  if (out.stamp.rotates) w = rows(group + "/angular_velocity", 3, n);
  out.bodies.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    BodyRecord& b = out.bodies[i];
    if (id[i] >= shape.size()) refuse("'" + group + "' holds a body that is not in 'bodies'");
    b = body(id[i]);
    b.kinetic_energy = energy[i];
    b.pose.position = Vec3(&x[3 * i]);
    b.velocity = Vec3(&v[3 * i]);
    if (out.stamp.has_orientation) b.pose.orientation = Quat(q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]);
    if (out.stamp.rotates) b.angular_velocity = Vec3(&w[3 * i]);
  }
  return out;
}

double StoredRun::time(std::size_t k) const {
  return read_undamaged(impl_->file.path(),
                        [&] { return impl_->file.number_attribute("snapshots/" + impl_->snapshots.at(k), "time"); });
}

std::string StoredRun::state_hash(std::size_t k) const {
  return read_undamaged(impl_->file.path(), [&] {
    return impl_->file.text_attribute("snapshots/" + impl_->snapshots.at(k), "state_hash");
  });
}

std::vector<BodyRecord> StoredRun::bodies() const {
  std::vector<BodyRecord> out;
  for (std::uint32_t id = 0; id < impl_->shape.size(); ++id) out.push_back(impl_->body(id));
  return out;
}

std::vector<StoredMeasure> StoredRun::measures() const {
  return read_undamaged(impl_->file.path(), [&] { return impl_->read_measures(); });
}

std::vector<StoredMeasure> StoredRun::Impl::read_measures() const {
  std::vector<StoredMeasure> out;
  for (const std::string& name : file.children("measures")) {
    const std::string group = "measures/" + name;
    StoredMeasure m;
    m.name = file.text_attribute(group, "name");
    if (file.has_attribute(group, "kind")) m.kind = file.text_attribute(group, "kind");
    std::istringstream words(file.text_attribute(group, "components"));
    for (std::string word; std::getline(words, word, ',');) m.components.push_back(word);
    m.times = file.read<double>(group + "/time");
    m.values = rows(group + "/value", m.components.size(), m.times.size());
    out.push_back(std::move(m));
  }
  return out;
}

StoredWords StoredRun::words(const BodyRecord& b) const {
  StoredWords out;
  const std::int32_t surface = b.id < impl_->surface.size() ? impl_->surface[b.id] : -1;
  if (surface >= 0) {
    const Impl::Name& name = impl_->names[static_cast<std::size_t>(surface)];
    out.shape = name.shape;
    out.size = name.size;
  }
  const RunAbout& about = impl_->about;
  if (b.material < about.materials.size()) out.material = about.materials[b.material];
  for (const auto& group : about.groups)
    if (b.id >= group.first && b.id - group.first < group.count) out.group = group.name;
  return out;
}

bool StoredRun::has_axes_of_the_scene() const { return impl_->format > 1; }
std::string StoredRun::version() const { return impl_->file.text_attribute("/", "version"); }
std::string StoredRun::title() const { return impl_->file.text_attribute("/", "title"); }
std::string StoredRun::about() const { return impl_->file.has("about") ? impl_->file.read_text("about") : ""; }
std::string StoredRun::scene_text() const { return impl_->file.read_text("scene"); }
std::string StoredRun::overrides() const { return impl_->file.read_text("overrides"); }

std::string damage_of(const std::filesystem::path& path) {
  try {
    {
      const Hdf5File file(path, Hdf5File::Mode::read);
      const bool ours = file.text_attribute("/", "kind") == run_layout::kind;
      const std::uint64_t found = file.count_attribute("/", "format");
      if (!ours || found < run_layout::oldest_format || found > run_layout::format) return "";
    }
    const StoredRun run(path);
    for (std::size_t k = 0; k < run.snapshots(); ++k) (void)run.snapshot(k);
    (void)run.measures();
  } catch (const DamagedRun& e) {
    return e.damage;
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

}  // namespace epafi
