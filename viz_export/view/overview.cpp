#include "viz_export/view/overview.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "viz_export/view/grounds.h"

namespace epafi {
namespace {

constexpr std::size_t most_frames = 24;

std::vector<std::size_t> spread(std::size_t n, std::size_t wanted) {
  std::vector<std::size_t> out;
  const std::size_t count = std::min(n, wanted);
  for (std::size_t k = 0; k < count; ++k) out.push_back(count > 1 ? k * (n - 1) / (count - 1) : 0);
  return out;
}

/// The value below which a share of them lies; sorts a part.
double quantile(std::vector<double>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

bool is_finite(const Vec3& p) { return std::isfinite(p.x() + p.y() + p.z()); }

/// Every so many bodies stand for all of a large run; what is left out between them is within a margin.
std::size_t stride_of(const ViewFrame& frame) { return 1 + frame.bodies.size() / 20000; }

/// Centres of free bodies without strays: beyond 1.5 times the extent of 98 % nobody counts, of more than 50 places.
class FreeBox {
 public:
  void add(const ViewFrame& frame) {
    const std::size_t stride = stride_of(frame);
    for (std::size_t k = 0; k < frame.bodies.size(); k += stride) {
      const BodyRecord& b = frame.bodies[k];
      if (b.is_wall() || !is_finite(b.pose.position) || !std::isfinite(b.radius)) continue;
      for (int axis = 0; axis < 3; ++axis) places_[axis].push_back(b.pose.position[axis]);
      radii_.push_back(b.radius);
    }
  }
  ViewBox box() {
    ViewBox out;
    if (radii_.empty()) return out;
    ViewBox kept;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values = places_[axis];
      const bool few = values.size() <= 50;
      const double low = quantile(values, few ? 0.0 : 0.01), high = quantile(values, few ? 1.0 : 0.99);
      const double reach = 0.25 * (high - low);
      kept.min[axis] = low - reach;
      kept.max[axis] = high + reach;
    }
    for (std::size_t k = 0; k < radii_.size(); ++k) {
      const Vec3 p(places_[0][k], places_[1][k], places_[2][k]);
      if ((p.array() >= kept.min.array()).all() && (p.array() <= kept.max.array()).all()) out.include(p, radii_[k]);
    }
    return out;
  }

  double mean_radius() const {
    double sum = 0;
    for (const double r : radii_) sum += r;
    return radii_.empty() ? 0.0 : sum / static_cast<double>(radii_.size());
  }

 private:
  std::vector<double> places_[3], radii_;
};

ViewBox box_of(const BodyRecord& b) {
  ViewBox out;
  if (b.surface == nullptr)
    out.include(b.pose.position, b.radius);
  else
    for (const Vec3& p : b.surface->points) out.include(b.pose.to_world(p));
  return out;
}

/// The walls that do not dwarf the free bodies belong to the picture; planes have no extent of their own.
void include_walls(const ViewFrame& frame, ViewBox& box) {
  const bool alone = box.is_empty();
  const double size = alone ? 0 : box.diagonal();
  for (const BodyRecord& b : frame.bodies) {
    if (!b.is_wall() || !std::isfinite(b.radius)) continue;
    const ViewBox wall = box_of(b);
    if (wall.is_empty() || !is_finite(wall.min) || !is_finite(wall.max)) continue;
    ViewBox both = box;
    both.include(wall);
    if (alone || both.diagonal() < 2.2 * size) box = both;
  }
}

/// What a body at rest has by rounding alone stays below this [m/s]: a part of the speed of a fall through the picture.
/// Without gravity nothing is known.
double speed_at_rest(const RunAbout& about, const ViewBox& box) {
  constexpr double share = 1e-6;
  return box.is_empty() ? 0.0 : share * std::sqrt(about.gravity.norm() * box.diagonal());
}

double largest_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [](double m, double v) { return std::max(m, std::abs(v)); });
}

/// The least end of the colours of a moving field.
double floor_of(const std::string& field, double speed, double radius) {
  if (field == "speed") return speed;
  if (field == "spin") return radius > 0 ? speed / radius : 0.0;
  return field == "residual" ? 1e-12 : 0.0;
}

/// From the first positive value on, 98 % of the values, `floor` at least; whole numbers as they are. One value where
/// the ends differ by no more than `same`: rounding. values: not empty.
std::array<double, 2> range_of(const ViewField& field, std::vector<double>& values, double floor, double same) {
  const bool from_zero = field.kind == ViewField::Kind::moving;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  double low = from_zero ? 0.0 : *least, high = *most;
  if (from_zero && field.name != "contacts") high = std::max(quantile(values, 0.98), 0.05 * high);
  if (from_zero) high = std::max(high, floor);
  if (!(high - low > same)) high = low;
  return {low, high};
}

}  // namespace

Overview look_over(const ViewSource& source) {
  Overview out;
  const std::vector<ViewField> fields = view_fields(source);
  std::map<std::string, std::vector<double>> values;
  std::vector<float> forces;
  FreeBox free;
  Grounds grounds(upwards(source.about()));
  const std::vector<std::size_t> shown = spread(source.times().size(), most_frames);
  for (const std::size_t k : shown) {
    const ViewFrame frame = source.frame(k);
    free.add(frame);
    grounds.add(frame);
    const FrameFields fields_of(frame, source.about());
    for (const ViewField& field : fields) {
      if (field.kind == ViewField::Kind::category) continue;
      const std::vector<float> all = fields_of(field.name);
      for (std::size_t b = 0; b < all.size(); b += stride_of(frame)) {
        const bool counts = std::isfinite(all[b]) && (!frame.bodies[b].is_wall() || field.name == "id");
        if (counts) values[field.name].push_back(all[b]);
      }
    }
    for (const StoredContact& c : frame.contacts) {
      forces.push_back(std::abs(c.normal_force));
      out.worst_residual = std::max(out.worst_residual, static_cast<double>(c.residual));
    }
  }
  for (const ViewField& field : fields) {
    auto& all = values[field.name];
    for (const double v : all) out.largest[field.name] = std::max(out.largest[field.name], v);
  }
  if (!forces.empty()) {
    const auto place = forces.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(forces.size() - 1));
    std::nth_element(forces.begin(), place, forces.end());
    out.strongest = *place;
  }
  out.box = free.box();
  if (!shown.empty()) include_walls(source.frame(shown.back()), out.box);
  if (out.box.is_empty()) out.box.include(Vec3::Zero(), 1.0);
  const double still = speed_at_rest(source.about(), out.box), radius = free.mean_radius();
  for (const ViewField& field : fields) {
    if (values[field.name].empty()) continue;
    const double same =
        field.name == "height" ? finest_step * out.box.diagonal() : 1e-6 * largest_of(values[field.name]);
    const bool moves = field.kind == ViewField::Kind::moving;
    out.range[field.name] =
        range_of(field, values[field.name], floor_of(field.name, still, radius), moves || field.whole ? 0.0 : same);
  }
  out.grounds = grounds.ids();
  out.ground_top = grounds.top();
  out.frames_looked_at = shown.size();
  return out;
}

namespace {

/// Frames of `at` into the middle of the widest gaps of `out`, until there are as many as wanted.
void fill_gaps(const std::vector<std::size_t>& at, std::size_t wanted, std::vector<std::size_t>& out) {
  const auto place = [&](std::size_t frame) { return std::lower_bound(at.begin(), at.end(), frame) - at.begin(); };
  while (out.size() < wanted && out.size() < at.size()) {
    std::size_t widest = 0;
    std::ptrdiff_t most = 0;
    for (std::size_t k = 0; k + 1 < out.size(); ++k) {
      const std::ptrdiff_t gap = place(out[k + 1]) - place(out[k]);
      if (gap <= most) continue;
      most = gap;
      widest = k;
    }
    const auto middle = static_cast<std::size_t>(place(out[widest]) + most / 2);
    out.insert(out.begin() + static_cast<std::ptrdiff_t>(widest) + 1, at[middle]);
  }
}

}  // namespace

std::vector<std::size_t> telling_frames(const ViewSource& source, std::size_t wanted) {
  const std::size_t n = source.times().size();
  std::vector<std::size_t> at = spread(n, 60);
  const auto is_empty = [&](std::size_t k) {
    const ViewFrame frame = source.frame(k);
    return std::all_of(frame.bodies.begin(), frame.bodies.end(), [](const BodyRecord& b) { return b.is_wall(); });
  };
  while (at.size() > 1 && is_empty(at.front())) at.erase(at.begin());  // before the first body is poured
  if (at.size() <= wanted) return at;
  std::vector<double> change{0.0};  // summed up to each frame of `at`
  std::map<std::uint32_t, Vec3> before;
  for (std::size_t k = 0; k < at.size(); ++k) {
    double moved = 0, size = 0;
    std::size_t stayed = 0;
    std::map<std::uint32_t, Vec3> now;
    for (const BodyRecord& b : source.frame(at[k]).bodies) {
      if (!is_finite(b.pose.position)) continue;
      now.emplace(b.id, b.pose.position);
      if (std::isfinite(b.radius)) size = std::max(size, b.is_wall() ? 0.0 : 2 * b.radius);
      const auto was = before.find(b.id);
      if (was == before.end()) continue;
      moved += (b.pose.position - was->second).norm();
      ++stayed;
    }
    moved += size * static_cast<double>(now.size() + before.size() - 2 * stayed);  // that came or went: their size
    if (k > 0) change.push_back(change.back() + moved);
    before = std::move(now);
  }
  std::vector<std::size_t> out{at.front()};
  for (std::size_t part = 1; part + 1 < wanted; ++part) {
    const double share = change.back() * static_cast<double>(part) / static_cast<double>(wanted - 1);
    const auto k = static_cast<std::size_t>(std::lower_bound(change.begin(), change.end(), share) - change.begin());
    if (k < at.size()) out.push_back(at[k]);
  }
  out.push_back(at.back());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  if (change.back() > 0) fill_gaps(at, wanted, out);
  return out;
}

std::optional<std::array<double, 2>> colour_range(const Overview& overview, const ViewSettings& settings,
                                                  const std::string& field) {
  const std::string chosen = settings.field.empty() ? "speed" : settings.field;
  const auto found = overview.range.find(field);
  if (found == overview.range.end()) return std::nullopt;
  return settings.range && field == chosen ? *settings.range : found->second;
}

}  // namespace epafi
