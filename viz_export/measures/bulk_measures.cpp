#include "viz_export/measures/bulk_measures.h"

#include <algorithm>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {
/// Sum of forces times branch vectors [N m].
struct Moment {
  Mat3 sum = Mat3::Zero();
  Moment& operator+=(const Moment& o) {
    sum += o.sum;
    return *this;
  }
};
}  // namespace

void StressMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const ContactSet& c = view.contacts;
  const MeasureRegion region = region_.now(w);
  const Mat3 sum =
      block_sum<Moment>(std::min(c.size(), c.force.size()), [&](std::size_t k) -> Moment {
        if (c.force[k].isZero(0.0)) return {};
        const Vec3 point = c.point(k, w);
        if (!region.holds(MeasureRegion::in_cell(w, point))) return {};
        const Vec3 b = w.position[c.a[k]] + w.branch(c.a[k], c.b[k], c.feature[k]);  // the image that is touched
        const Vec3 from = w.is_movable(c.b[k]) ? b : point, to = w.is_movable(c.a[k]) ? w.position[c.a[k]] : point;
        return {c.force[k] * (to - from).transpose()};
      }).sum;
  const Mat3 stress = 0.5 / region.volume() * (sum + sum.transpose());
  values = {stress.trace() / 3.0, stress(0, 0), stress(1, 1), stress(2, 2), stress(0, 1), stress(0, 2), stress(1, 2)};
}

namespace {

/// Volume fraction of a sphere inside the box, by the cell centres of a 10 x 10 x 10 grid over the sphere.
double part_inside(const MeasureRegion& region, const Vec3& centre, double radius) {
  const Vec3 r = Vec3::Constant(radius);
  if (region.holds(centre - r) && region.holds(centre + r)) return 1.0;
  if (((centre + r).array() < region.low.array()).any() || ((centre - r).array() >= region.high.array()).any())
    return 0.0;
  int in = 0, all = 0;
  for (int i = 0; i < 1000; ++i) {
    const int layer = i / 100;
    const Vec3 x = Vec3(i % 10 - 4.5, i / 10 % 10 - 4.5, layer - 4.5) / 5.0;
    if (x.squaredNorm() > 1.0) continue;
    ++all;
    if (region.holds(centre + radius * x)) ++in;
  }
  return static_cast<double>(in) / all;
}

/// Calls f(x) for a point and its nearest images.
template <class F>
void each_image(const World& w, const Vec3& x, const F& f) {
  if (!w.cell) return f(x);
  const auto span = [&](std::size_t k) { return w.cell->repeats[k] ? 1 : 0; };
  for (int i = -span(0); i <= span(0); ++i)
    for (int j = -span(1); j <= span(1); ++j)
      for (int k = -span(2); k <= span(2); ++k) f(Vec3(x + w.cell->shift(image_code(i, j, k))));
}

}  // namespace

void SolidFractionMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const MeasureRegion region = region_.now(w);
  volumes_.find(w);
  const Sum3 sum = block_sum<Sum3>(w.size(), [&](std::size_t i) -> Sum3 {
    const auto s = static_cast<Slot>(i);
    if (!w.is_movable(s)) return {};
    const double own = volumes_.of(w.shape[s]);
    const double radius = std::cbrt(own * 0.238732414637843);  // 3/(4 pi)
    const Vec3 x = MeasureRegion::in_cell(w, w.position[s]);
    double volume = region.whole_cell ? own : 0.0;  // every body is in it once
    if (!region.whole_cell) each_image(w, x, [&](const Vec3& y) { volume += own * part_inside(region, y, radius); });
    return {volume, region.holds(x) ? 1.0 : 0.0};
  });
  values = {sum.a / region.volume(), sum.b};
}

ProfileMeasure::ProfileMeasure(MeasureSetup setup)
    : region_(setup.parameters), bins_(static_cast<int>(setup.parameters.integer("bins"))) {
  const std::string& axis = setup.parameters.text("axis");
  axis_ = axis == "x" ? 0 : axis == "y" ? 1 : 2;
}

std::vector<std::string> ProfileMeasure::components() const {
  std::vector<std::string> out;
  for (int k = 0; k < bins_; ++k)
    for (const char* name : {"velocity_x_", "velocity_y_", "velocity_z_", "density_"})
      out.push_back(name + std::to_string(k));
  return out;
}

void ProfileMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const auto n = static_cast<std::size_t>(bins_);
  std::vector<Vec3> momentum(n, Vec3::Zero());
  std::vector<double> mass(n, 0.0);
  const MeasureRegion region = region_.now(w);
  const double low = region.low[axis_], height = region.high[axis_] - low;
  for (Slot s = 0; s < w.size(); ++s) {
    const Vec3 x = MeasureRegion::in_cell(w, w.position[s]);
    if (!w.is_movable(s) || !region.holds(x)) continue;
    const auto k = std::min(n - 1, static_cast<std::size_t>((x[axis_] - low) / height * bins_));
    const double m = 1.0 / w.inverse_mass[s];
    mass[k] += m;
    momentum[k] += m * w.velocity[s];
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  values.clear();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 v = mass[k] > 0.0 ? Vec3(momentum[k] / mass[k]) : Vec3(nan, nan, nan);
    values.insert(values.end(), {v.x(), v.y(), v.z(), mass[k] * bins_ / region.volume()});
  }
}

}  // namespace epafi
