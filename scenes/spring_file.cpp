#include "scenes/spring_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>

#include "engine/units/error.h"
#include "scenes/railway/rolling.h"
#include "scenes/start_run.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/view/settings.h"

namespace epafi {

namespace {

std::string vector_text(const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()); }

/// Quoted for TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "\"";
}

/// Names of bodies in a scene that reads bodies.csv: rows are the free bodies by number, counted per group.
class RowNames {
 public:
  explicit RowNames(const Assembly& a) : assembly_(a) {
    const World& world = a.simulation->world;
    for (const GroupSpec& group : a.scene.groups) {
      std::size_t rows = 0;
      for (std::size_t k = group.first; k < group.first + group.count; ++k) {
        const Slot s = world.slot_of(a.id_of(k));
        if (s == no_slot || !world.is_movable(s) || group.name.empty()) continue;
        names_[a.id_of(k)] = fmt::format("{}[{}]", group.name, rows++);
      }
      if (rows == 1 && group.count > 0) single(group);
    }
  }
  std::string of(BodyId id) const {
    const auto found = names_.find(id);
    return found != names_.end() ? found->second : body_name(assembly_, id);
  }

 private:
  /// A group of one body has its name without an index.
  void single(const GroupSpec& group) {
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      if (const auto found = names_.find(assembly_.id_of(k)); found != names_.end()) found->second = group.name;
  }

  const Assembly& assembly_;
  std::map<BodyId, std::string> names_;
};

}  // namespace

std::string springs_text(const Assembly& a) {
  const std::vector<SpringElement> elements = springs_of(a);
  const std::vector<Vec3> loads = spring_loads(a);
  const RowNames names(a);
  const World& world = a.simulation->world;
  std::string out;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const SpringElement& e = elements[k];
    const SpringSpec& written = a.scene.springs[k];
    if (world.slot_of(e.body) == no_slot || (e.to && world.slot_of(*e.to) == no_slot)) continue;
    out += fmt::format("[[spring]]\nname = {}\nbody = {}\n", quoted(e.name), quoted(names.of(e.body)));
    if (e.to) out += fmt::format("to = {}\n", quoted(names.of(*e.to)));
    if (!e.to && e.speed != 0.0) out += fmt::format("speed = {:.17g}\n", e.speed);
    out +=
        fmt::format("attachment = {}\nstiffness = {}\ndamping = {}\npreload = {}\n\n", vector_text(written.attachment),
                    vector_text(e.stiffness), vector_text(e.damping), vector_text(loads[k]));
  }
  return out;
}

std::string export_springs(const std::filesystem::path& folder) {
  const StoredRun run(folder / "run.h5");
  if (run.snapshots() == 0 || about_from_text(run.about()).springs.empty()) return "";
  const double snapshot = run.time(run.snapshots() - 1);
  std::shared_ptr<MadeRun> made;
  try {
    made = open_made_run(folder);
  } catch (const std::exception& trouble) {
    return fmt::format("springs.toml is not written: {}", trouble.what());
  }
  const Assembly& a = *made->assembly;
  const double time = a.simulation->world.time;
  if (time < snapshot - 0.5 * a.time_step.value)
    return fmt::format(
        "springs.toml is not written: the checkpoint is of {:.6g} s, bodies.csv of {:.6g} s; `epafi resume` the run",
        time, snapshot);
  const std::filesystem::path path = folder / "springs.toml";
  SideFile side(path);
  std::ofstream out(side.path(), std::ios::binary);
  out << "# springs as they are at " << fmt::format("{:.17g}", time)
      << " s: include = [\"springs.toml\"] in a scene whose [[bodies]] reads bodies.csv\n"
      << springs_text(a);
  out.close();
  if (!out) throw FileError(path.string() + ": cannot write (is the disk full?)");
  side.commit(false);
  return "springs.toml holds the springs, for include = [\"springs.toml\"] beside [[bodies]] of bodies.csv";
}

}  // namespace epafi
