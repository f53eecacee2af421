#include "viz_export/view/overview.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

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

constexpr std::size_t few_values = 50;  // to leave out any of them would mislead

/// The value exceeded by at most this share of the values, for few values the largest; reorders them.
template <class T>
T upper_end(std::vector<T>& values, double share_above) {
  const double last = static_cast<double>(values.size() - 1);
  const double place = values.size() < few_values ? last : std::ceil((1 - share_above) * last);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The quantile of the values at `share`; reorders them.
double quantile(std::vector<double>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

bool is_finite(const Vec3& p) { return std::isfinite(p.x() + p.y() + p.z()); }

/// Stride of the bodies that represent a large run; a margin covers the others.
std::size_t stride_of(const ViewFrame& frame) { return 1 + frame.bodies.size() / 20000; }

ViewBox box_of(const BodyRecord& b) {
  ViewBox out;
  if (b.surface == nullptr)
    out.include(b.pose.position, b.radius);
  else
    for (const Vec3& p : b.surface->points) out.include(b.pose.to_world(p));
  return out;
}

/// Extends the box by walls that are not much larger than the free bodies; planes have no extent.
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

/// Positions of free bodies over the run. The box of a picture excludes strays, since one body that leaves a heap would
/// shrink all others to points: it covers the start and the middle half.
class FreeBox {
 public:
  void add(const ViewFrame& frame) {
    const std::size_t stride = stride_of(frame), first = places_.size();
    for (std::size_t k = 0; k < frame.bodies.size(); k += stride) {
      const BodyRecord& b = frame.bodies[k];
      const bool counts = !b.is_wall() && is_finite(b.pose.position) && std::isfinite(b.radius);
      if (counts) places_.push_back({b.pose.position, b.radius, b.id});
      if (!b.is_wall()) ids_.insert(b.id);
    }
    if (first == 0) began_ = places_.size();
  }
  /// walls: the frame whose walls bound the positions of bodies.
  ViewBox box(const ViewFrame& walls) const {
    if (ids_.size() < few_bodies) return box_of_few(walls);
    ViewBox kept = middle(0, places_.size(), 0.01);
    const Vec3 reach = 0.25 * (kept.max - kept.min);
    if (const ViewBox start = middle(0, began_, 0.01); is_blown_up(kept, start))
      kept = start;
    else
      kept = {kept.min - reach, kept.max + reach};
    ViewBox out;
    for (const Place& p : places_)
      if (kept.holds(p.centre)) out.include(p.centre, p.radius);
    return out;
  }

  double mean_radius() const {
    double sum = 0;
    for (const Place& p : places_) sum += p.radius;
    return places_.empty() ? 0.0 : sum / static_cast<double>(places_.size());
  }

 private:
  struct Place {
    Vec3 centre;
    double radius;
    std::uint32_t id;
  };
  static constexpr std::size_t few_bodies = 100;

  /// Box of the positions [from, to), without this share at each side.
  ViewBox middle(std::size_t from, std::size_t to, double share) const {
    ViewBox out;
    if (from == to) return out;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (std::size_t k = from; k < to; ++k) values.push_back(places_[k].centre[axis]);
      out.min[axis] = quantile(values, share);
      out.max[axis] = quantile(values, 1 - share);
    }
    return out;
  }

  /// True where most bodies are too far apart to be visible, and were not at the start. False for one body.
  bool is_blown_up(const ViewBox& all, const ViewBox& start) const {
    constexpr double unseen = 3000, much = 20;  // radii to a picture; sizes of the start
    return ids_.size() > 1 && all.diagonal() > unseen * mean_radius() &&
           all.diagonal() > much * (start.diagonal() + mean_radius());
  }

  /// Box for few bodies: whole bodies are excluded as strays, since parts of their paths would still stretch the box.
  ViewBox box_of_few(const ViewFrame& walls) const {
    ViewBox start, half = middle(0, places_.size(), 0.25), out;
    for (std::size_t k = 0; k < began_; ++k) start.include(places_[k].centre, places_[k].radius);
    ViewBox kept = start;
    if (!half.is_empty() && !is_blown_up(half, start)) kept.include(half);
    if (kept.is_empty()) return kept;
    include_walls(walls, kept);
    const Vec3 reach = Vec3::Constant(2 * kept.diagonal());
    const ViewBox near{kept.min - reach, kept.max + reach};
    std::set<std::uint32_t> strays;
    for (const Place& p : places_)
      if (ids_.size() > 1 && !near.holds(p.centre)) strays.insert(p.id);
    for (const Place& p : places_)
      if (!strays.contains(p.id) || kept.holds(p.centre)) out.include(p.centre, p.radius);
    return out;
  }

  std::vector<Place> places_;
  std::set<std::uint32_t> ids_;
  std::size_t began_ = 0;  ///< so many of the places are of the first frame that has any
};

/// Speed [m/s] below which a body counts as at rest: a fraction of the speed of a fall through the picture. Without
/// gravity, a speed invisible over the whole run; unknown for one frame.
double speed_at_rest(const ViewSource& source, const ViewBox& box) {
  constexpr double share = 1e-6, of_the_picture = 1e-12;
  if (box.is_empty()) return 0.0;
  const double fall = share * std::sqrt(source.about().gravity.norm() * box.diagonal());
  const double duration = source.times().empty() ? 0.0 : source.times().back() - source.times().front();
  return std::max(fall, duration > 0 ? of_the_picture * box.diagonal() / duration : 0.0);
}

double largest_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [](double m, double v) { return std::max(m, std::abs(v)); });
}

/// Smallest upper end of the colour range of a field of motion.
double floor_of(const std::string& field, double speed, double radius) {
  if (field == "speed") return speed;
  if (field == "spin") return radius > 0 ? speed / radius : 0.0;
  return field == "residual" ? 1e-12 : 0.0;
}

/// Values of a field with the positions of their bodies.
struct FieldValues {
  std::vector<double> all;
  std::vector<Eigen::Vector3f> places;
  std::vector<std::uint32_t> ids;
  void add(double value, const BodyRecord& body) {
    all.push_back(value);
    places.push_back(body.pose.position.cast<float>());
    ids.push_back(body.id);
  }
};

/// Values of a field that are visible in the picture.
struct SeenValues {
  std::vector<double> values;
  std::vector<double> staying;  ///< those of bodies that stay in the picture; all where none does
};

/// Values of bodies inside the picture, since those outside would dominate the colour range. All values where none is
/// inside.
SeenValues seen_in(const ViewBox& box, const FieldValues& known) {
  const Vec3 margin = Vec3::Constant(1e-6 * (box.diagonal() + box.min.norm()));  // of single precision
  const ViewBox wider{box.min - margin, box.max + margin};
  std::vector<bool> inside(known.all.size());
  std::set<std::uint32_t> leaving;
  for (std::size_t k = 0; k < known.all.size(); ++k) {
    inside[k] = wider.holds(known.places[k].cast<double>());
    if (!inside[k]) leaving.insert(known.ids[k]);
  }
  SeenValues out;
  for (std::size_t k = 0; k < known.all.size(); ++k) {
    if (!inside[k]) continue;
    out.values.push_back(known.all[k]);
    if (!leaving.contains(known.ids[k])) out.staying.push_back(known.all[k]);
  }
  if (out.values.empty()) out.values = known.all;
  if (out.staying.empty()) out.staying = out.values;
  return out;
}

/// Colour range. Fields of motion: from 0 to the value that 2 % exceed (for few values the largest); others: from
/// smallest to largest. A single value where the ends differ by at most `same`, by rounding. resting: set where the
/// range of a field of motion ends below `floor`. seen: not empty.
std::array<double, 2> range_of(const ViewField& field, SeenValues& seen, double floor, double same, bool& resting) {
  std::vector<double>& values = seen.values;
  const bool from_zero = field.kind == ViewField::Kind::moving;
  const auto [least_at, most_at] = std::minmax_element(values.begin(), values.end());
  const double least = *least_at, most = *most_at;  // of the unsorted values
  double low = from_zero ? 0.0 : least, high = most;
  if (from_zero && field.name != "contacts")
    high =
        std::max(upper_end(values.size() < few_values ? seen.staying : values, 0.02), 0.05 * largest_of(seen.staying));
  resting = from_zero && most > 0 && high <= floor;
  if (resting) high = floor;
  if (!(high - low > same)) high = low;
  return {low, high};
}

/// Adds the finite values of a sample of bodies, with walls where these count.
void add_values(const ViewFrame& frame, const std::vector<float>& all, bool walls, FieldValues& to) {
  for (std::size_t b = 0; b < all.size(); b += stride_of(frame))
    if (std::isfinite(all[b]) && (walls || !frame.bodies[b].is_wall())) to.add(all[b], frame.bodies[b]);
}

}  // namespace

Overview look_over(const ViewSource& source) {
  Overview out;
  const std::vector<ViewField> fields = view_fields(source);
  std::map<std::string, FieldValues> values;
  std::vector<float> forces;
  FreeBox free;
  Grounds grounds(upwards(source.about()));
  const std::vector<std::size_t> shown = spread(source.times().size(), most_frames);
  for (const std::size_t k : shown) {
    const ViewFrame frame = source.frame(k);
    free.add(frame);
    grounds.add(frame);
    const FrameFields fields_of(frame, source.about());
    for (const ViewField& field : fields)
      if (field.kind != ViewField::Kind::category)
        add_values(frame, fields_of(field.name), field.name == "id", values[field.name]);
    for (const StoredContact& c : frame.contacts) {
      if (std::isfinite(c.normal_force)) forces.push_back(std::abs(c.normal_force));
      out.worst_residual = std::max(out.worst_residual, static_cast<double>(c.residual));
    }
  }
  for (const ViewField& field : fields) {
    const auto& all = values[field.name].all;
    if (all.empty()) continue;
    const auto [least, most] = std::minmax_element(all.begin(), all.end());
    out.extremes[field.name] = {*least, *most};
  }
  if (!forces.empty()) out.strongest_of_all = *std::max_element(forces.begin(), forces.end());
  if (!forces.empty()) out.strongest = upper_end(forces, 0.01);
  const ViewFrame last = shown.empty() ? ViewFrame{} : source.frame(shown.back());
  out.box = free.box(last);
  include_walls(last, out.box);
  if (out.box.is_empty()) out.box.include(Vec3::Zero(), 1.0);
  const double still = speed_at_rest(source, out.box), radius = free.mean_radius();
  for (const ViewField& field : fields) {
    SeenValues seen = seen_in(out.box, values[field.name]);
    if (field.name == "id") seen.values = values[field.name].all;  // of walls too, wherever they are
    if (seen.values.empty()) continue;
    const double same = field.name == "height" ? finest_step * out.box.diagonal() : 1e-6 * largest_of(seen.values);
    const bool moves = field.kind == ViewField::Kind::moving;
    const double floor = floor_of(field.name, still, radius);
    bool resting = false;
    out.range[field.name] = range_of(field, seen, floor, moves || field.whole ? 0.0 : same, resting);
    if (resting) out.resting.insert(field.name);
  }
  out.grounds = grounds.ids();
  out.ground_top = grounds.top();
  out.frames_looked_at = shown.size();
  return out;
}

namespace {

/// Adds frames of `at` in the middle of the widest gaps of `out` until there are `wanted`.
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

bool is_resting(const Overview& overview, const ViewSettings& settings, const std::string& field) {
  const std::string chosen = settings.field.empty() ? "speed" : settings.field;
  return overview.resting.contains(field) && !(settings.range && field == chosen);
}

std::optional<std::array<double, 2>> colour_range(const Overview& overview, const ViewSettings& settings,
                                                  const std::string& field) {
  const std::string chosen = settings.field.empty() ? "speed" : settings.field;
  const auto found = overview.range.find(field);
  if (found == overview.range.end()) return std::nullopt;
  return settings.range && field == chosen ? *settings.range : found->second;
}

}  // namespace epafi
