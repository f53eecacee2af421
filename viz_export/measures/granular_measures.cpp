#include "viz_export/measures/granular_measures.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace epafi {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double normal_force(const ContactSet& c, std::size_t k) {
  return k < c.force.size() ? -c.force[k].dot(c.normal[k]) : 0.0;
}

}  // namespace

void HysteresisMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const ContactSet& c = view.contacts;
  double overlap = 0.0, force = 0.0;
  const auto in = [&](Slot s, std::size_t group) { return setup_.bodies[group].contains(w.id[s]); };
  for (std::size_t k = 0; k < c.size(); ++k) {
    if (-c.gap[k] <= overlap && normal_force(c, k) <= force) continue;
    if (!((in(c.a[k], 0) && in(c.b[k], 1)) || (in(c.a[k], 1) && in(c.b[k], 0)))) continue;
    overlap = std::max(0.0, -c.gap[k]);
    force = normal_force(c, k);
  }
  if (overlap_ == 0.0 && force_ == 0.0 && overlap > 0.0) area_ = 0.0;  // a new contact
  area_ += 0.5 * (force + force_) * (overlap - overlap_);
  overlap_ = overlap;
  force_ = force;
  values = {overlap, force, area_};
}

void HysteresisMeasure::visit(StateVisitor& visitor, const std::string& prefix) {
  visitor.value(prefix + "/overlap", overlap_);
  visitor.value(prefix + "/force", force_);
  visitor.value(prefix + "/area", area_);
}

namespace {

/// Largest compressive stress of a body and its direction.
struct MajorStress {
  double value = 0.0;
  Vec3 direction = Vec3::UnitZ();
};

std::vector<MajorStress> major_stresses(const World& w, const ContactSet& c, const ShapeStore& shapes) {
  std::vector<Mat3> moment(w.size(), Mat3::Zero());
  for (std::size_t k = 0; k < c.size() && k < c.force.size(); ++k) {
    moment[c.a[k]] -= c.force[k] * c.arm[k].transpose();
    moment[c.b[k]] += c.force[k] * c.arm_b(k, w).transpose();
  }
  std::vector<MajorStress> out(w.size());
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s) || moment[s].isZero(0.0)) continue;
    const double r = shapes.bounding_radius({w.shape[s]});
    Eigen::SelfAdjointEigenSolver<Mat3> axes(0.5 * (moment[s] + moment[s].transpose()));
    out[s] = {axes.eigenvalues()[2] / (4.18879020478639 * r * r * r), axes.eigenvectors().col(2)};
  }
  return out;
}

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

void ForceChains::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const ContactSet& c = view.contacts;
  const auto major = major_stresses(w, c, *shapes_);
  double mean = 0, bodies = 0, sum = 0, touching = 0, strong = 0;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) {
      mean += major[s].value;
      bodies += 1;
    }
  mean = bodies > 0 ? mean / bodies : 0;
  for (std::size_t k = 0; k < c.size(); ++k)
    if (normal_force(c, k) > 0) {
      sum += normal_force(c, k);
      touching += 1;
    }
  std::vector<std::uint32_t> parent(w.size());
  std::iota(parent.begin(), parent.end(), 0u);
  constexpr double cosine = 0.70710678118654752;  // 45 degrees
  for (std::size_t k = 0; k < c.size(); ++k) {
    if (!(normal_force(c, k) > 0)) continue;
    strong += normal_force(c, k) * touching > sum;
    const MajorStress &a = major[c.a[k]], &b = major[c.b[k]];
    if (!(a.value > mean && b.value > mean)) continue;
    const Vec3 line = w.branch(c.a[k], c.b[k], c.feature[k]).normalized();
    if (std::abs(line.dot(a.direction)) < cosine || std::abs(line.dot(b.direction)) < cosine) continue;
    const auto p = root_of(parent, c.a[k]), q = root_of(parent, c.b[k]);
    parent[std::max(p, q)] = std::min(p, q);
  }
  std::vector<std::uint32_t> size(w.size(), 0);
  for (std::uint32_t s = 0; s < w.size(); ++s) ++size[root_of(parent, s)];
  double chains = 0, members = 0, longest = 0;
  for (double n : size)
    if (n >= 3) {
      chains += 1;
      members += n;
      longest = std::max(longest, n);
    }
  values = {chains, members, longest, bodies > 0 ? members / bodies : 0.0, touching > 0 ? strong / touching : 0.0};
}

ReposeMeasure::ReposeMeasure(MeasureSetup setup)
    : centre_(setup.parameters.vec3("centre")),
      axis_(setup.parameters.text("axis")),
      bins_(setup.parameters.has("bins") ? static_cast<int>(setup.parameters.integer("bins")) : 0),
      shapes_(setup.shapes) {}

double ReposeMeasure::distance(const Vec3& x) const {
  const Vec3 d = x - centre_;
  return axis_ == "z" ? std::hypot(d.x(), d.y()) : std::abs(axis_ == "x" ? d.x() : d.y());
}

/// Radius of the heap: smallest distance that contains 97 % of the mass; stray bodies lie beyond.
double ReposeMeasure::reach(const World& w) const {
  constexpr double heap_share = 0.97;
  std::vector<std::pair<double, double>> masses;  // distance, mass
  double total = 0.0, within = 0.0;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) masses.emplace_back(distance(w.position[s]), 1.0 / w.inverse_mass[s]);
  for (const auto& [d, mass] : masses) total += mass;
  std::sort(masses.begin(), masses.end());
  for (const auto& [d, mass] : masses) {
    within += mass;
    if (within >= (1.0 - 1e-9) * heap_share * total) return d;
  }
  return nan;
}

double ReposeMeasure::mean_diameter(const World& w) const {
  double diameters = 0.0, bodies = 0.0;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) {
      bodies += 1.0;
      diameters += 2.0 * shapes_->bounding_radius({w.shape[s]});
    }
  return diameters / bodies;
}

/// Index of the sector along a ring; for a ridge, whose ends also slope, each layer is one sector.
long ReposeMeasure::field(const Vec3& x, double ring_middle, double width) const {
  if (axis_ != "z") return 0;
  constexpr double most = 1e9;
  const Vec3 d = x - centre_;
  const double fields = std::clamp(std::round(2.0 * std::numbers::pi * ring_middle / width), 1.0, most);
  const double turn = std::atan2(d.y(), d.x()) / (2.0 * std::numbers::pi) + 0.5;
  return std::lround(std::floor(turn * fields));
}

std::vector<ReposeMeasure::Ring> ReposeMeasure::surface(const World& w, double far) const {
  constexpr double most = 1e5;
  const double width = mean_diameter(w);
  const double rings = bins_ > 0 ? bins_ : std::clamp(std::ceil(far / width), 1.0, most);
  std::map<std::pair<std::size_t, long>, Top> tops;
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s)) continue;
    const double d = distance(w.position[s]);
    if (!(d <= far)) continue;
    const double z = w.position[s].z() + shapes_->bounding_radius({w.shape[s]}) - centre_.z();
    const double ring = std::min(rings - 1.0, std::floor(d / far * rings));
    const long place = field(w.position[s], (ring + 0.5) * far / rings, width);
    Top& top = tops.try_emplace({static_cast<std::size_t>(ring), place}).first->second;
    if (z > top.height) top = {d, z};
  }
  std::vector<Ring> out(static_cast<std::size_t>(rings));
  for (const auto& [place, top] : tops) {
    Ring& ring = out[place.first];
    ring.fields += 1.0;
    ring.at += (top.at - ring.at) / ring.fields;
    ring.height += (top.height - ring.height) / ring.fields;
    ring.highest = std::max(ring.highest, top.height);
  }
  return out;
}

void ReposeMeasure::sample(const StepView& view, std::vector<double>& values) {
  const double far = reach(view.world);
  if (!(far > 0.0)) return void(values = {nan, nan, far});
  const std::vector<Ring> rings = surface(view.world, far);
  double highest = -infinity, height = -infinity;
  for (const Ring& ring : rings) {
    highest = std::max(highest, ring.highest);
    if (ring.fields > 0.0) height = std::max(height, ring.height);
  }
  // weight 1 from 0.4 to 0.8, 0 at 0.2 and 1: with a sharp limit, small changes would add or drop a ring
  const auto weight = [&](const Ring& ring) {
    const double share = ring.height / height;
    return ring.fields * std::clamp((1.0 - share) / 0.2, 0.0, 1.0) * std::clamp((share - 0.2) / 0.2, 0.0, 1.0);
  };
  double lines = 0, n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0;
  for (const Ring& ring : rings) {
    const double w = ring.fields > 0.0 ? weight(ring) : 0.0;
    if (!(w > 0.0)) continue;
    lines += 1;
    n += w;
    sx += w * ring.at;
    sz += w * ring.height;
    sxx += w * ring.at * ring.at;
    sxz += w * ring.at * ring.height;
  }
  const double slope = lines >= 2 ? (n * sxz - sx * sz) / (n * sxx - sx * sx) : nan;
  values = {std::atan(-slope) * 57.29577951308232, highest, far};
}

void MixingMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  struct Count {
    double first = 0, both = 0;
  };
  std::map<std::tuple<long, long, long>, Count> cells;
  double first = 0, both = 0;
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t k = 0; k < setup_.bodies[g].size(); ++k) {
      const Slot s = w.slot_of(setup_.bodies[g][k]);
      if (s == no_slot || !w.position[s].allFinite()) continue;
      const Vec3 u = w.position[s] / edge_;
      Count& cell =
          cells[{std::lround(std::floor(u.x())), std::lround(std::floor(u.y())), std::lround(std::floor(u.z()))}];
      cell.first += g == 0;
      cell.both += 1;
      first += g == 0;
      both += 1;
    }
  if (both == 0) return void(values = {nan, nan});
  // variance of the share over the cells, weighted by their number of bodies
  const double p = first / both;
  double variance = 0;
  for (const auto& [place, cell] : cells)
    variance += cell.both * (cell.first / cell.both - p) * (cell.first / cell.both - p);
  variance /= both;
  const double apart = p * (1 - p), mixed = apart * static_cast<double>(cells.size()) / both;
  values = {apart > mixed ? (apart - variance) / (apart - mixed) : nan, p};
}

}  // namespace epafi
