#include "viz_export/view/fields.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "viz_export/view/camera.h"

namespace epafi {
namespace {

using FieldKind = ViewField::Kind;

/// Volume of a closed surface by the divergence theorem, or of a sphere without one [m^3].
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

/// Row of each id; `rows.size()` and above: missing.
class RowsByID {
 public:
  explicit RowsByID(const ViewFrame& frame) : none_(static_cast<std::uint32_t>(frame.bodies.size())) {
    rows_.resize(frame.bodies.empty() ? 0 : std::size_t{frame.bodies.back().id} + 1, none_);
    for (std::uint32_t k = 0; k < none_; ++k) rows_[frame.bodies[k].id] = k;
  }
  std::size_t operator()(std::uint32_t id) const { return id < rows_.size() ? rows_[id] : none_; }

 private:
  std::uint32_t none_;
  std::vector<std::uint32_t> rows_;
};

/// Stress: sum of arm times force over the contacts, divided by the volume.
void divide_by_volumes(const ViewFrame& frame, ContactSums& sums) {
  std::map<const Surface*, double> volumes;
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const BodyRecord& b = frame.bodies[k];
    if (sums.count[k] == 0) continue;
    double volume = b.surface == nullptr ? volume_of(b) : 0;
    if (b.surface != nullptr) {
      const auto [known, is_new] = volumes.emplace(b.surface, 0.0);
      if (is_new) known->second = volume_of(b);
      volume = known->second;
    }
    if (b.is_wall() || !(volume > 0))
      sums.stress[k].setZero();
    else
      sums.stress[k] /= volume;
  }
}

/// Von Mises stress sqrt(3/2 s:s), s the deviator of the symmetric part.
double von_mises(const Mat3& stress) {
  const Mat3 even = 0.5 * (stress + stress.transpose());
  const Mat3 s = even - even.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * s.norm();
}

std::string height_label(const Vec3& up) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(up[axis]) > 1 - 1e-9) return std::string("height ") + (up[axis] < 0 ? "-" : "") + "xyz"[axis];
  return "height against gravity";
}

template <class F>
std::vector<float> each(const ViewFrame& frame, const F& of) {
  std::vector<float> out;
  out.reserve(frame.bodies.size());
  for (const BodyRecord& b : frame.bodies) out.push_back(static_cast<float>(of(b)));
  return out;
}

template <class F>
std::vector<float> each(const std::vector<Mat3>& stress, const F& of) {
  std::vector<float> out;
  out.reserve(stress.size());
  for (const Mat3& s : stress) out.push_back(static_cast<float>(of(s)));
  return out;
}

}  // namespace

ContactSums contact_sums(const ViewFrame& frame) {
  const std::size_t n = frame.bodies.size();
  ContactSums out{std::vector<float>(n), std::vector<float>(n), std::vector<float>(n),
                  std::vector<Mat3>(n, Mat3::Zero())};
  const RowsByID row_of(frame);
  const auto reach = [&](std::size_t row) {
    return row < n && !frame.bodies[row].is_wall() ? frame.bodies[row].radius : 0;
  };
  for (const StoredContact& c : frame.contacts) {
    const std::size_t a = row_of(c.a), b = row_of(c.b);
    const Vec3 branch = (c.to - c.from).cast<double>();
    const double both = reach(a) + reach(b);
    const double share = both > 0 && std::isfinite(both) ? reach(a) / both : 0.5;
    for (const std::size_t row : {a, b}) {
      if (row >= n) continue;
      out.count[row] += 1;
      out.force[row] += std::abs(c.normal_force);
      out.residual[row] += c.residual * c.residual;
      out.stress[row] += (row == a ? share : 1 - share) * branch * c.force.cast<double>().transpose();
    }
  }
  for (float& r : out.residual) r = std::sqrt(r);
  divide_by_volumes(frame, out);
  return out;
}

std::vector<std::string> view_field_names() {
  return {"speed",    "spin",   "force", "pressure", "stress",   "contacts",
          "residual", "height", "size",  "id",       "material", "body"};
}

std::vector<ViewField> view_fields(const ViewSource& source) {
  std::vector<ViewField> out{{"speed", "speed", "m/s", FieldKind::moving}};
  const bool rotates = !source.times().empty() && source.frame(0).rotates;
  if (rotates) out.push_back({"spin", "angular speed", "rad/s", FieldKind::moving});
  if (source.has_contacts()) {
    out.push_back({"force", "contact force", "N", FieldKind::moving});
    out.push_back({"pressure", "pressure (mean stress)", "Pa", FieldKind::moving});
    out.push_back({"stress", "von Mises stress", "Pa", FieldKind::moving});
    out.push_back({"contacts", "number of contacts", "", FieldKind::moving, true});
  }
  if (source.has_residuals()) out.push_back({"residual", "residual", "", FieldKind::moving});
  out.push_back({"height", height_label(upwards(source.about())), "m", FieldKind::fixed});
  out.push_back({"size", "bounding radius", "m", FieldKind::fixed});
  out.push_back({"id", "body number", "", FieldKind::fixed, true});
  out.push_back({"material", "material", "", FieldKind::category});
  out.push_back({"body", "body", "", FieldKind::category});
  return out;
}

std::size_t group_of(const RunAbout& about, std::uint32_t id) {
  for (std::size_t g = 0; g < about.groups.size(); ++g)
    if (id >= about.groups[g].first && id - about.groups[g].first < about.groups[g].count) return g;
  return about.groups.size();
}

FrameFields::FrameFields(const ViewFrame& frame, const RunAbout& about)
    : frame_(frame), about_(about), up_(upwards(about)) {}

const ContactSums& FrameFields::sums() const {
  if (!sums_) sums_ = contact_sums(frame_);
  return *sums_;
}

std::vector<float> FrameFields::operator()(const std::string& field) const {
  if (field == "speed") return each(frame_, [](const BodyRecord& b) { return b.velocity.norm(); });
  if (field == "spin") return each(frame_, [](const BodyRecord& b) { return b.angular_velocity.norm(); });
  if (field == "height") return each(frame_, [&](const BodyRecord& b) { return up_.dot(b.pose.position); });
  if (field == "size") return each(frame_, [](const BodyRecord& b) { return b.radius; });
  if (field == "id") return each(frame_, [](const BodyRecord& b) { return b.id; });
  if (field == "material") return each(frame_, [](const BodyRecord& b) { return b.material; });
  if (field == "body") return each(frame_, [&](const BodyRecord& b) { return group_of(about_, b.id); });
  if (field == "force") return sums().force;
  if (field == "residual") return sums().residual;
  if (field == "pressure") return each(sums().stress, [](const Mat3& s) { return -s.trace() / 3; });
  if (field == "stress") return each(sums().stress, von_mises);
  return sums().count;
}

}  // namespace epafi
