#include "viz_export/view/fields.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace epafi {
namespace {

using FieldKind = ViewField::Kind;

/// Of a closed surface, by the divergence theorem; of a sphere without one [m^3].
double volume_of(const BodyRecord& b) {
  if (b.surface == nullptr) return 4.0 / 3.0 * std::numbers::pi * b.radius * b.radius * b.radius;
  const Surface& s = *b.surface;
  double six_volumes = 0;
  std::size_t begin = 0;
  for (const std::int32_t offset : s.offsets) {
    const auto point = [&](std::size_t k) -> const Vec3& {
      return s.points[static_cast<std::size_t>(s.connectivity[k])];
    };
    for (std::size_t k = begin + 1; k + 1 < static_cast<std::size_t>(offset); ++k)
      six_volumes += point(begin).dot(point(k).cross(point(k + 1)));
    begin = static_cast<std::size_t>(offset);
  }
  return std::abs(six_volumes) / 6.0;
}

/// Sums over the contacts of each body of the frame.
struct ContactSums {
  std::vector<float> count, force, pressure;
};

/// pressure: sum over contacts of half the branch times the normal force, over three volumes (Love 1927, isotropic
/// part).
ContactSums contact_sums(const ViewFrame& frame) {
  const std::size_t n = frame.bodies.size();
  ContactSums out{std::vector<float>(n), std::vector<float>(n), std::vector<float>(n)};
  const auto row_of = [&](std::uint32_t id) {
    const auto at = std::lower_bound(frame.bodies.begin(), frame.bodies.end(), id,
                                     [](const BodyRecord& b, std::uint32_t wanted) { return b.id < wanted; });
    return at != frame.bodies.end() && at->id == id ? static_cast<std::size_t>(at - frame.bodies.begin()) : n;
  };
  for (const StoredContact& c : frame.contacts) {
    const std::size_t a = row_of(c.a), b = row_of(c.b);
    const bool with_wall = (a < n && frame.bodies[a].is_wall()) || (b < n && frame.bodies[b].is_wall());
    const float arm = (c.to - c.from).norm() * (with_wall ? 1.0f : 0.5f);
    for (const std::size_t row : {a, b}) {
      if (row >= n) continue;
      out.count[row] += 1;
      out.force[row] += std::abs(c.normal_force);
      out.pressure[row] += arm * c.normal_force;
    }
  }
  std::map<const Surface*, double> volumes;
  for (std::size_t k = 0; k < n; ++k) {
    const BodyRecord& b = frame.bodies[k];
    if (out.count[k] == 0) continue;
    double volume = b.surface == nullptr ? volume_of(b) : 0;
    if (b.surface != nullptr) {
      const auto [known, is_new] = volumes.emplace(b.surface, 0.0);
      if (is_new) known->second = volume_of(b);
      volume = known->second;
    }
    out.pressure[k] = b.is_wall() || !(volume > 0) ? 0 : static_cast<float>(out.pressure[k] / (3 * volume));
  }
  return out;
}

template <class F>
std::vector<float> each(const ViewFrame& frame, const F& of) {
  std::vector<float> out;
  out.reserve(frame.bodies.size());
  for (const BodyRecord& b : frame.bodies) out.push_back(static_cast<float>(of(b)));
  return out;
}

}  // namespace

std::vector<std::string> view_field_names() {
  return {"speed", "spin", "force", "pressure", "contacts", "height", "size", "id", "material", "body"};
}

std::vector<ViewField> view_fields(const ViewSource& source) {
  std::vector<ViewField> out{{"speed", "speed", "m/s", FieldKind::moving}};
  const bool rotates = !source.times().empty() && source.frame(0).rotates;
  if (rotates) out.push_back({"spin", "angular speed", "rad/s", FieldKind::moving});
  if (source.has_contacts()) {
    out.push_back({"force", "contact force", "N", FieldKind::moving});
    out.push_back({"pressure", "pressure (contact stress)", "Pa", FieldKind::moving});
    out.push_back({"contacts", "number of contacts", "", FieldKind::moving});
  }
  out.push_back({"height", "height z", "m", FieldKind::fixed});
  out.push_back({"size", "bounding radius", "m", FieldKind::fixed});
  out.push_back({"id", "body number", "", FieldKind::fixed});
  out.push_back({"material", "material", "", FieldKind::category});
  out.push_back({"body", "body", "", FieldKind::category});
  return out;
}

std::size_t group_of(const RunAbout& about, std::uint32_t id) {
  for (std::size_t g = 0; g < about.groups.size(); ++g)
    if (id >= about.groups[g].first && id - about.groups[g].first < about.groups[g].count) return g;
  return about.groups.size();
}

std::vector<float> field_values(const std::string& field, const ViewFrame& frame, const RunAbout& about) {
  if (field == "speed") return each(frame, [](const BodyRecord& b) { return b.velocity.norm(); });
  if (field == "spin") return each(frame, [](const BodyRecord& b) { return b.angular_velocity.norm(); });
  if (field == "height") return each(frame, [](const BodyRecord& b) { return b.pose.position.z(); });
  if (field == "size") return each(frame, [](const BodyRecord& b) { return b.radius; });
  if (field == "id") return each(frame, [](const BodyRecord& b) { return b.id; });
  if (field == "material") return each(frame, [](const BodyRecord& b) { return b.material; });
  if (field == "body") return each(frame, [&](const BodyRecord& b) { return group_of(about, b.id); });
  ContactSums sums = contact_sums(frame);
  if (field == "force") return std::move(sums.force);
  return field == "pressure" ? std::move(sums.pressure) : std::move(sums.count);
}

}  // namespace epafi
