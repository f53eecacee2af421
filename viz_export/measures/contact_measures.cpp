#include "viz_export/measures/contact_measures.h"

#include <limits>

#include "engine/parallel_order.h"

namespace epafi {

ContactMeasure::ContactMeasure(MeasureSetup setup) : setup_(std::move(setup)) {
  for (std::size_t g = 0; g < 2; ++g)
    for (BodyId b : setup_.bodies[g]) {
      const auto id = static_cast<std::size_t>(b);
      if (side_.size() <= id) side_.resize(id + 1, 0);
      side_[id] = static_cast<char>(side_[id] | (g == 0 ? 1 : 2));
    }
}

void ContactMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const ContactSet& c = view.contacts;
  const auto side = [&](Slot s) {
    const auto id = static_cast<std::size_t>(w.id[s]);
    return id < side_.size() ? side_[id] : char{0};
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  values = {0, 0, 0, 0, nan, nan, nan, 0};
  double deepest = 0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const char a = side(c.a[k]), b = side(c.b[k]);
    if (!((a & 1 && b & 2) || (a & 2 && b & 1)) || k >= c.force.size()) continue;
    const double normal_force = -c.force[k].dot(c.normal[k]);
    if (c.gap[k] >= 0 && normal_force == 0) continue;
    values[1] += normal_force, values[2] += (c.force[k] + normal_force * c.normal[k]).norm(), values[7] += 1;
    if (values[7] > 1 && -c.gap[k] <= deepest) continue;
    deepest = -c.gap[k];
    Vec3 slip = w.velocity[c.b[k]] - w.velocity[c.a[k]];
    if (w.rotates()) slip += w.angular_velocity[c.b[k]].cross(c.arm_b(k, w)) - w.angular_velocity[c.a[k]].cross(c.arm[k]);
    slip -= slip.dot(c.normal[k]) * c.normal[k];
    const Vec3 p = c.point(k, w);
    values[0] = std::max(0.0, deepest), values[3] = slip.norm(), values[4] = p.x(), values[5] = p.y(), values[6] = p.z();
  }
}

namespace {

/// The bodies that each touches, once: those of body s are list[begin[s]] to list[begin[s + 1]].
struct Neighbours {
  std::vector<std::uint32_t> begin;
  std::vector<Slot> list;
  Neighbours(std::size_t bodies, const GapPieces& gaps) {
    const auto acts = [](const ContactSet& c, std::size_t k) {
      return c.gap[k] < 0 || (k < c.force.size() && c.force[k].squaredNorm() > 0);
    };
    const auto is_first = [&](const ContactSet& c, std::size_t k) {  // of its pair
      for (std::size_t j = k; j-- > 0 && c.a[j] == c.a[k] && c.b[j] == c.b[k];)
        if (acts(c, j)) return false;
      return true;
    };
    const auto each = [&](std::size_t first, std::size_t last, const auto& f) {
      for (std::size_t piece = first; piece < last; ++piece)
        gaps.read(piece, [&](const ContactSet& c, std::size_t from, std::size_t to) {
          for (std::size_t k = from; k < to; ++k)
            if (acts(c, k) && is_first(c, k)) f(c.a[k], c.b[k]), f(c.b[k], c.a[k]);
        });
    };
    parallel_group(
        gaps.size(), bodies, begin, each, [&](std::size_t count) { list.resize(count); },
        [&](std::uint32_t place, Slot other) { list[place] = other; }, 4);
  }
};

}  // namespace

void Coordination::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const Neighbours touched(w.size(), view.gaps());
  std::vector<char> in(w.size(), 0);
  std::vector<int> degree(w.size(), 0);
  std::vector<Slot> leaving;
  double bodies = 0, sum = 0;
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s)) continue;
    degree[s] = static_cast<int>(touched.begin[s + 1] - touched.begin[s]);
    in[s] = 1, bodies += 1, sum += degree[s];
    if (degree[s] < least_) leaving.push_back(s);
  }
  values = {bodies > 0 ? sum / bodies : 0.0, 0.0, 0.0};
  while (!leaving.empty()) {  // whoever loses its last needed neighbour leaves after it
    const Slot s = leaving.back();
    leaving.pop_back(), in[s] = 0;
    for (std::uint32_t k = touched.begin[s]; k < touched.begin[s + 1]; ++k)
      if (const Slot other = touched.list[k]; in[other] && degree[other]-- == least_) leaving.push_back(other);
  }
  double kept = 0, kept_sum = 0;
  for (Slot s = 0; s < w.size(); ++s) kept += in[s], kept_sum += in[s] ? degree[s] : 0;
  values[1] = kept > 0 ? kept_sum / kept : 0.0, values[2] = bodies - kept;
}

}  // namespace epafi
