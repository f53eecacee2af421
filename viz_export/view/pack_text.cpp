/// @file pack_text.cpp  What the page reads before any frame: the manifest, bodies and meshes.
#include <algorithm>
#include <cmath>

#include "engine/units/error.h"
#include "viz_export/files/json_writer.h"
#include "viz_export/hdf5/deflate.h"
#include "viz_export/measures/measure_units.h"
#include "viz_export/measures/telling_rows.h"
#include "viz_export/view/pack.h"
#include "viz_export/view/planes.h"
#include "viz_export/view/render_run.h"

namespace epafi {
namespace {

constexpr std::size_t most_points = 1000;  // of a curve

void put_vector(JsonWriter& json, const char* name, const Vec3& v) {
  json.key(name).begin_array();
  for (int axis = 0; axis < 3; ++axis) json.value(v[axis]);
  json.end_array();
}

void put_pair(JsonWriter& json, const char* name, const std::array<double, 2>& v) {
  json.key(name).begin_array().value(v[0]).value(v[1]).end_array();
}

const char* kind_name(ViewField::Kind kind) {
  return kind == ViewField::Kind::moving ? "moving" : kind == ViewField::Kind::fixed ? "fixed" : "category";
}

void put_about(JsonWriter& json, const RunAbout& about) {
  json.key("materials").begin_array();
  for (const std::string& name : about.materials) json.value(name);
  json.end_array().key("groups").begin_array();
  for (const auto& g : about.groups)
    json.begin_object()
        .member("name", g.name)
        .member("first", std::uint64_t{g.first})
        .member("count", std::uint64_t{g.count})
        .end_object();
  json.end_array().key("springs").begin_array();
  for (const auto& s : about.springs) {
    json.begin_object().member("name", s.name).member("body", std::uint64_t{s.body});
    if (s.to) json.member("to", std::uint64_t{*s.to});
    put_vector(json, "attachment", s.attachment);
    json.end_object();
  }
  json.end_array();
}

void put_view(JsonWriter& json, const ViewSettings& view) {
  json.key("view").begin_object();
  if (!view.preset.empty()) json.member("preset", view.preset);
  if (view.from) put_vector(json, "from", *view.from);
  if (view.to) put_vector(json, "to", *view.to);
  json.member("angle", view.angle);
  if (!view.field.empty()) json.member("field", view.field);
  json.end_object();
}

/// Preset camera directions in world axes, and the upward direction.
void put_cameras(JsonWriter& json, const Vec3& up) {
  put_vector(json, "up", up);
  json.key("presets").begin_object();
  for (const auto& [name, direction] : camera_presets()) put_vector(json, name.c_str(), upright(up) * direction);
  json.end_object();
  put_vector(json, "level", upright(up) * Vec3::UnitY());
}

/// Walls that the page shows opaque while the camera is above them.
void put_grounds(JsonWriter& json, const Overview& overview) {
  json.key("grounds").begin_array();
  for (const std::uint32_t id : overview.grounds) json.value(std::uint64_t{id});
  json.end_array();
  if (!overview.grounds.empty()) json.member("ground_top", overview.ground_top);
}

/// Values of each component with their times; long series are thinned, keeping their shape.
void put_measures(JsonWriter& json, const std::vector<StoredMeasure>& measures) {
  json.key("measures").begin_array();
  for (const StoredMeasure& m : measures) {
    const std::size_t n = m.times.size(), width = m.components.size();
    json.begin_object().member("name", m.name).key("times").begin_array();
    for (std::size_t k = 0; k < n && n <= most_points; ++k) json.value(m.times[k]);
    json.end_array().key("components").begin_array();
    for (std::size_t c = 0; c < width; ++c) {
      const MeasureUnit unit = measure_unit(m.kind, m.components[c]);
      const std::vector<std::size_t> rows = telling_rows(m, c, most_points);
      json.begin_object().member("name", m.components[c]).member("quantity", unit.quantity).member("unit", unit.unit);
      if (n > most_points) {  // each has its own
        json.key("times").begin_array();
        for (const std::size_t k : rows) json.value(m.times[k]);
        json.end_array();
      }
      json.key("values").begin_array();
      for (const std::size_t k : rows) json.value(m.values[k * width + c]);
      json.end_array().end_object();
    }
    json.end_array().end_object();
  }
  json.end_array();
}

template <class T>
void put_raw(std::string& out, const T* values, std::size_t count) {
  out.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  out.resize((out.size() + 3) / 4 * 4);
}

void put_mesh(std::string& out, const ViewMesh& mesh) {
  put_number(out, static_cast<std::uint32_t>(mesh.points.size()));
  put_number(out, static_cast<std::uint32_t>(mesh.corners.size()));
  for (const auto& p : mesh.points) put_raw(out, p.data(), 3);
  put_raw(out, mesh.corners.data(), mesh.corners.size());
  std::vector<std::int8_t> normals;
  for (const auto& n : mesh.normals)
    for (int axis = 0; axis < 3; ++axis) normals.push_back(static_cast<std::int8_t>(std::lround(127 * n[axis])));
  put_raw(out, normals.data(), normals.size());
}

}  // namespace

std::string Packer::manifest(const std::vector<std::string>& columns, const std::vector<std::string>& notes,
                             const std::string& identity) const {
  JsonWriter json;
  json.begin_object().member("title", source_.title()).member("running", source_.is_running());
  if (!identity.empty()) json.member("identity", identity);
  const std::string cut = source_.cut_text(), stop = source_.stop_text();
  if (!cut.empty() || !stop.empty()) json.member("cut", cut.empty() ? "the run has ended early: " + stop : cut);
  json.member("chunk_frames", std::uint64_t{chunk_frames}).member("bodies", std::uint64_t{source_.bodies().size()});
  json.key("times").begin_array();
  for (const std::size_t k : shown_) json.value(source_.times()[k]);
  json.end_array().key("columns").begin_array();
  for (const std::string& name : columns) json.value(name == "strong" ? "contact" : name);
  json.end_array().key("fields").begin_array();
  for (const ViewField& f : fields_) {
    json.begin_object().member("name", f.name).member("label", f.label).member("unit", f.unit);
    json.member("kind", kind_name(f.kind));
    if (f.whole) json.member("whole", true);
    if (is_resting(overview_, source_.about().view, f.name)) json.member("resting", true);
    if (const auto range = colour_range(overview_, source_.about().view, f.name)) put_pair(json, "range", *range);
    if (const auto at = overview_.extremes.find(f.name); at != overview_.extremes.end())
      put_pair(json, "extremes", at->second);
    json.end_object();
  }
  json.end_array().key("box").begin_object();
  put_vector(json, "min", overview_.box.min);
  put_vector(json, "max", overview_.box.max);
  json.end_object().member("strongest", static_cast<double>(overview_.strongest));
  json.member("strongest_of_all", static_cast<double>(overview_.strongest_of_all));
  put_cameras(json, upwards(source_.about()));
  put_grounds(json, overview_);
  put_about(json, source_.about());
  put_view(json, source_.about().view);
  put_measures(json, source_.measures());
  json.key("notes").begin_array();
  for (const auto& list : {view_notes(source_, "", ""), notes, source_.warnings()})
    for (const std::string& note : list) json.value(note);
  return json.end_array().end_object().text();
}

std::string Packer::bodies() const {
  const auto& all = source_.bodies();
  MeshStore meshes(all);
  std::vector<float> radius, scale;
  std::vector<std::int32_t> mesh;
  std::vector<std::uint16_t> material, wall;
  for (const BodyRecord& b : all) {
    const MeshStore::Copy copy = meshes.of(b.surface);
    radius.push_back(std::isfinite(b.radius) ? static_cast<float>(b.radius) : 0.0f);
    mesh.push_back(copy.mesh);
    scale.push_back(static_cast<float>(copy.scale));
    material.push_back(b.material);
    wall.push_back(b.is_wall() ? 1 : 0);
  }
  std::string out;
  put_number(out, static_cast<std::uint32_t>(all.size()));
  put_raw(out, radius.data(), radius.size());
  put_raw(out, mesh.data(), mesh.size());
  put_raw(out, scale.data(), scale.size());
  put_raw(out, material.data(), material.size());
  put_raw(out, wall.data(), wall.size());
  put_number(out, static_cast<std::uint32_t>(meshes.all().size()));
  for (const ViewMesh& m : meshes.all()) put_mesh(out, m);
  std::string stream = deflated(out, 6);
  if (stream.empty()) throw FileError("zlib ran out of memory");
  return stream;
}

}  // namespace epafi
