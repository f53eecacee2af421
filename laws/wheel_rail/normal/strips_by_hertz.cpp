// Virtual penetration with the share of the approach from Hertz instead of a constant: exact on a parabola, fast
// because strips do not interact.
//
// stripes (Ayasse, Chollet 2005): share and shape from the curvature at the rigid contact point, half-lengths from the
// curvature of each strip, smoothed over the patch. Fails where the curvature jumps within the patch.
// analyn (after Sichani, Enblom, Berg 2014): every strip is taken from the Hertz contact whose mean curvature is that
// from the rigid point to the strip, B = h / y^2, so that a wide flat part beyond a jump keeps its full width.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "laws/wheel_rail/normal/gap_at.h"
#include "laws/wheel_rail/normal/models.h"
#include "laws/wheel_rail/normal/strip_influence.h"

namespace epafi {
namespace {

using std::numbers::pi;
constexpr double most_left_open = 0.03;  // residual gap over the approach, beyond which the law is out of its range

/// Hertz solution at approach 1, as used by a strip: h(b) = share * approach at the lateral edge; a and p0 grow as
/// sqrt(approach).
struct UnitHertz {
  double share, a, p0;
};
UnitHertz unit_hertz(double A, double B, double modulus) {
  const HertzContact c = hertz_of_approach(A, B, modulus, 1.0);
  return {B * c.ellipse.b * c.ellipse.b, c.ellipse.a, c.max_pressure};
}

struct Line {
  double y, gap;
  UnitHertz hertz;
};

struct StripSum {
  double force = 0.0, peak = 0.0, area = 0.0, first = 0.0, moment_x = 0.0, moment_y = 0.0;
};

StripSum press(const std::vector<Line>& lines, double step, double approach) {
  StripSum s;
  for (const Line& l : lines) {
    const double rest = 1.0 - l.gap / (l.hertz.share * approach);
    if (!(rest > 0.0)) continue;
    const double root = std::sqrt(approach * rest), a = l.hertz.a * root, p = l.hertz.p0 * root;
    const double f = 0.5 * pi * a * p * step;
    s.force += f;
    s.peak = std::max(s.peak, p);
    s.area += 2.0 * a * step;
    s.first += f * l.y;
    s.moment_y += f * l.y * l.y;
    s.moment_x += 0.25 * f * a * a;
  }
  return s;
}

/// Residual gap under the pressures of `press`, over the approach.
double misfit(const std::vector<Line>& lines, double step, double approach, double modulus) {
  std::vector<PressedStrip> strips;
  for (const Line& l : lines) {
    const double rest = 1.0 - l.gap / (l.hertz.share * approach);
    if (!(rest > 0.0)) continue;
    const double root = std::sqrt(approach * rest);
    strips.push_back({l.y, l.gap, l.hertz.p0 * root, l.hertz.a * root, step});
  }
  return misfit_of(strips, approach, modulus);
}

/// Curvature across the track from the rigid point to each line, or of each line smoothed over half the patch of
/// `guess`.
std::vector<Line> lines_of(const ContactRegion& r, double modulus, bool mean_curvature, const HertzContact& guess,
                           double& step) {
  const double width = 0.5 * guess.ellipse.b, most = 4.0 * guess.approach;  // beyond: nothing touches
  const GapProfile& g = r.profile;
  const double flattest = 0.01 * r.curvature_x;
  std::vector<Line> out;
  if (g.size() == 0) {
    const UnitHertz h = unit_hertz(0.5 * r.curvature_x, 0.5 * r.curvature_y, modulus);
    const double half = 4e-3;
    step = half / 200.0;
    for (int k = -400; k < 400; ++k) {
      const double y = (k + 0.5) * step;
      out.push_back({y, 0.5 * r.curvature_y * y * y, h});
    }
    return out;
  }
  // at least 16 lines over half the patch: on the flange that is three samples wide
  const auto finer = static_cast<std::size_t>(std::clamp(std::ceil(16.0 * g.step / guess.ellipse.b), 1.0, 16.0));
  step = g.step / static_cast<double>(finer);
  const double B0 = 0.5 * std::max(flattest, r.curvature_y), near = 2.0 * g.step, w = std::max(g.step, width);
  const UnitHertz origin = unit_hertz(0.5 * r.curvature_x, B0, modulus);
  for (std::size_t k = 0; k < finer * (g.size() - 1); ++k) {
    const double y = g.start + static_cast<double>(k) * step;
    const GapAt at = gap_at(r, y);
    if (at.gap > most) {  // one such line separates two regions
      if (out.empty() || out.back().gap <= most) out.push_back({y, at.gap, {1.0, 0.0, 0.0}});
      continue;
    }
    double B = B0;
    if (mean_curvature && std::abs(y) > near)
      B = std::max(0.5 * flattest, at.gap / (y * y));
    else if (!mean_curvature && y - w >= g.start && y + w <= g.y(g.size() - 1))
      B = std::max(0.5 * flattest, 0.5 * (gap_at(r, y - w).gap - 2.0 * at.gap + gap_at(r, y + w).gap) / (w * w));
    UnitHertz h = unit_hertz(0.5 * at.curvature, B, modulus);
    if (!mean_curvature) h.share = origin.share;
    out.push_back({y, std::max(0.0, at.gap), h});
  }
  return out;
}

/// Number of separate overlaps of the undeformed surfaces: mean curvature may be used for one overlap only.
int overlaps(const std::vector<Line>& lines, double approach) {
  int runs = 0;
  bool inside = false;
  for (const Line& l : lines) {
    const bool now = l.gap < approach;
    runs += now && !inside;
    inside = now;
  }
  return runs;
}

std::vector<RegionPatch> solve(const NormalInput& in, bool mean_curvature) {
  const ContactRegion& r = in.regions.front();
  const double E = in.elastic.effective_modulus(), load = in.target.value;
  const double B = 0.5 * std::max(r.curvature_y, 0.02 * r.curvature_x);
  const HertzContact guess = in.target.by_force ? hertz_of_force(0.5 * r.curvature_x, B, E, load)
                                                : hertz_of_approach(0.5 * r.curvature_x, B, E, load);
  double step = 0.0;
  const std::vector<Line> lines = lines_of(r, E, mean_curvature, guess, step);
  double approach = load;
  if (in.target.by_force) {
    double low = 0.0, high = guess.approach;
    while (press(lines, step, high).force < load && high < 1e-2) high *= 2.0;
    for (int k = 0; k < 60 && high - low > 1e-13; ++k) {
      approach = 0.5 * (low + high);
      (press(lines, step, approach).force < load ? low : high) = approach;
    }
  }
  const StripSum s = press(lines, step, approach);
  RegionPatch out;
  NormalPatch& p = out.patch;
  p.normal_force = s.force;
  p.approach = approach;
  p.max_pressure = s.peak;
  p.area = s.area;
  if (s.force > 0.0) {
    const double centre = s.first / s.force, across = std::max(s.moment_y / s.force - centre * centre, 1e-16);
    p.centre_y = centre;
    p.ellipse = {std::sqrt(5.0 * s.moment_x / s.force), std::sqrt(5.0 * across)};
  }
  // Error estimate by the residual gap under the pressures.
  const double off = misfit(lines, step, approach, E);
  if (mean_curvature)
    check_conformal(r, p, p.reasons);
  else
    check_hertz_range(r, p, p.reasons);
  const bool one_patch = mean_curvature && overlaps(lines, approach) <= 1;  // includes the whole profile
  check_second_region(in, p, one_patch ? -r.profile.start : 0.0);
  p.error_estimate =
      std::max(error_of_gap_left(off) + 0.12 * askew(r, p.ellipse.b, p.ellipse.a), p.reasons.empty() ? 0.0 : 0.15);
  if (off > most_left_open)
    p.reasons.push_back("the pressures of the strips do not close the gap: " +
                        std::to_string(static_cast<int>(100.0 * off)) + " % of the approach is left");
  return {out};
}

}  // namespace

std::vector<RegionPatch> solve_stripes(const NormalInput& in) { return solve(in, false); }
std::vector<RegionPatch> solve_analyn(const NormalInput& in) { return solve(in, true); }

}  // namespace epafi
