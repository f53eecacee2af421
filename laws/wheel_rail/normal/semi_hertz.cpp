// Semi-Hertzian contact: each strip carries a half ellipse of pressure along the track; across it strips interact by
// their exact influence. Each strip has two unknowns, pressure and length, and two conditions in its middle: the
// surfaces touch, and have the same curvature along the track. The shape of the patch, which virtual penetration
// assumes, is part of the solution; the patch may be non-elliptic and in several parts. Error of the peak on
// S1002/UIC60 with 25 to 50 strips: below 0.3 %, 1 % where two pressure peaks separate (right wheel, 0.2 to 0.5 mm), 2
// % at the jump.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/railway/elliptic_integrals.h"
#include "laws/factors.h"
#include "laws/wheel_rail/normal/gap_at.h"
#include "laws/wheel_rail/normal/models.h"
#include "laws/wheel_rail/normal/strip_influence.h"

namespace epafi {
namespace {

using std::numbers::pi;
constexpr double start_depth = 0.55;   // share of an overlap from which lengths start (Kik, Piotrowski 1996)
constexpr int most_strip_rounds = 80;  // 10 to 20 on the tread, 30 on the flange under 200 kN

/// Strips across the patch and their solution.
struct Strips {
  double width = 0.0;
  std::vector<double> y, gap, curvature, centre;  ///< given
  std::vector<double> p, a;                       ///< peak pressure [Pa] and half-length [m]
  std::vector<double> bent;                       ///< curvature along the track that the pressures give [1/m]
  double approach = 0.0;
  Separation apart;                ///< distances between separate regions
  std::vector<std::size_t> group;  ///< the region of each strip
  std::vector<double> shares;      ///< factors of the influence between two regions
  double share(std::size_t i, std::size_t j) const { return shares[group[i] * apart.groups() + group[j]]; }
  void separate(const Separation& regions) {
    apart = regions;
    for (const double at : y) group.push_back(apart.group(at));
    for (std::size_t a = 0; a < apart.groups(); ++a)
      for (std::size_t b = 0; b < apart.groups(); ++b) shares.push_back(apart.share(a, b));
  }
};

/// Ranges of y where the undeformed surfaces overlap at this approach.
std::vector<OverlapRange> overlaps_at(const ContactRegion& r, double approach) {
  if (r.profile.size() > 0) return overlaps_of(r.profile, approach);
  const double half = std::sqrt(2.0 * approach / r.curvature_y);
  return {{-half, half}};
}

Strips cut(const ContactRegion& r, double low, double high, int count) {
  Strips s;
  s.width = (high - low) / count;
  for (int k = 0; k < count; ++k) {
    const double y = low + (k + 0.5) * s.width;
    const GapAt g = gap_at(r, y);
    s.y.push_back(y);
    s.gap.push_back(g.gap);
    s.curvature.push_back(g.curvature);
    s.centre.push_back(g.centre);
  }
  s.p.assign(s.y.size(), 0.0);
  s.a.assign(s.y.size(), 0.0);
  s.bent.assign(s.y.size(), 0.0);
  return s;
}

/// Axes of the ellipse with the second moments of the pressure.
Ellipse moments(const Strips& s) {
  double n = 0.0, ny = 0.0, nyy = 0.0, nxx = 0.0;
  for (std::size_t j = 0; j < s.y.size(); ++j) {
    const double w = s.p[j] * s.a[j];
    n += w;
    ny += w * s.y[j];
    nyy += w * (s.y[j] * s.y[j] + s.width * s.width / 12.0);
    nxx += 0.25 * w * s.a[j] * s.a[j];
  }
  ny /= n;
  return {std::sqrt(5.0 * nxx / n), std::sqrt(5.0 * (nyy / n - ny * ny))};
}

/// Displacement and curvature along the track in the middle of each active strip, by the pressure of each of them.
struct Influences {
  Eigen::MatrixXd displacement, bend;
};
void set_influences(const Strips& s, const std::vector<std::size_t>& active, double modulus, Influences& out) {
  const auto n = static_cast<Eigen::Index>(active.size());
  out.displacement.resize(n, n);
  out.bend.resize(n, n);
  const std::size_t middle = s.y.size();
  const bool one = s.apart.whole();
  std::vector<char> asked(middle, 0);  // distances that occur: 30 of 60 where two regions lie apart
  for (std::size_t i = 0; i < active.size(); ++i)
    for (std::size_t j = i; j < active.size(); ++j) asked[active[j] - active[i]] = 1;
  std::vector<double> displacement(2 * middle + 1), bend(displacement);  // by the strip's number less the loaded one's
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::size_t J = active[static_cast<std::size_t>(j)];
    const double a = s.a[J], u = a / (pi * modulus), k = 1.0 / (pi * modulus * a), w = s.width / a;
    const std::size_t farthest = std::max(J - active.front(), active.back() - J);
    StripInfluence last = strip_influence(-0.5 * w);
    for (std::size_t m = 0; m <= farthest; ++m) {
      if (!asked[m]) continue;
      if (m > 0 && !asked[m - 1]) last = strip_influence((static_cast<double>(m) - 0.5) * w);
      const StripInfluence edge = strip_influence((static_cast<double>(m) + 0.5) * w);
      displacement[middle - m] = displacement[middle + m] = u * (edge.displacement - last.displacement);
      bend[middle - m] = bend[middle + m] = k * (edge.bend - last.bend);
      last = edge;
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t I = active[static_cast<std::size_t>(i)], m = middle + I - J;
      out.displacement(i, j) = displacement[m];
      out.bend(i, j) = bend[m];
    }
    for (Eigen::Index i = 0; !one && i < n; ++i) {
      const double share = s.share(active[static_cast<std::size_t>(i)], J);
      out.displacement(i, j) *= share;
      out.bend(i, j) *= share;
    }
  }
}

/// Solves for the pressures on the active strips at their present lengths, with the approach given or such that the
/// force is met, and for the curvature that they cause.
void solve_pressures(Strips& s, const std::vector<std::size_t>& active, const Influences& by,
                     const NormalTarget& target) {
  const auto n = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd rhs(n, 2);
  for (Eigen::Index j = 0; j < n; ++j) {
    rhs(j, 0) = 1.0;
    rhs(j, 1) = s.gap[active[static_cast<std::size_t>(j)]];
  }
  const Eigen::MatrixXd x = solve_lu(by.displacement, rhs);
  double n1 = 0.0, ng = 0.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double length = 0.5 * pi * s.a[active[static_cast<std::size_t>(j)]] * s.width;
    n1 += length * x(j, 0);
    ng += length * x(j, 1);
  }
  s.approach = target.by_force ? (target.value + ng) / n1 : target.value;
  const Eigen::VectorXd p = (s.approach * x.col(0) - x.col(1)).cwiseMax(0.0), bent = by.bend * p;
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::size_t J = active[static_cast<std::size_t>(j)];
    s.p[J] = p[j];
    s.bent[J] = bent[j];
  }
}

/// Overlap that remains outside the active strips [m].
double overlap_left(const Strips& s, const std::vector<std::size_t>& active, std::size_t i, double modulus) {
  double u = 0.0;
  for (const std::size_t j : active) {
    const double d = s.y[i] - s.y[j], a = s.a[j];
    u +=
        s.share(i, j) * s.p[j] * a / (pi * modulus) *
        (strip_influence((d + 0.5 * s.width) / a).displacement - strip_influence((d - 0.5 * s.width) / a).displacement);
  }
  return s.approach - s.gap[i] - u;
}

/// Anderson (1965) mixing for fixed points of x -> x + f: the next x is the combination of the last ones with the
/// smallest f. Takes 1/3 of the iterations of plain relaxation. Entries may join and leave (x = 0); the history of the
/// others stays valid.
class Mixing {
 public:
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& f) {
    if (known_ == 0) {
      dx_.setZero(x.size(), most);
      df_.setZero(x.size(), most);
    }
    Eigen::VectorXd out = x + share * f;
    if (known_ > 0) {
      const Eigen::Index column = (known_ - 1) % most, columns = std::min<Eigen::Index>(known_, most);
      dx_.col(column) = x - x_;
      df_.col(column) = f - f_;
      for (Eigen::Index k = 0; k < x.size(); ++k)
        if ((x[k] > 0.0) != (x_[k] > 0.0)) {
          dx_.row(k).setZero();
          df_.row(k).setZero();
        }
      const auto F = df_.leftCols(columns);
      const Eigen::MatrixXd M = transposed_product(F, F);
      out -= (dx_.leftCols(columns) + share * F) *
             solve_ldlt(M + 1e-12 * M.trace() * Eigen::MatrixXd::Identity(columns, columns), F.transpose() * f);
    }
    x_ = x;
    f_ = f;
    ++known_;
    return out;
  }

 private:
  static constexpr Eigen::Index most = 4;
  static constexpr double share = 0.6;
  Eigen::MatrixXd dx_, df_;
  Eigen::VectorXd x_, f_;
  Eigen::Index known_ = 0;
};

/// Updates lengths towards equal curvatures of surface and gap along the track: a strip whose surface is curved more is
/// too short. Returns the largest change over the largest length, and 1 while any length doubles: mixing may move a
/// length towards 0, where changes are small but the pressure is unbounded.
double relax_lengths(Strips& s, const std::vector<std::size_t>& active, Mixing& mixing) {
  constexpr double most = 2.0;   // factor of a length in one iteration
  constexpr double apart = 1.5;  // factor between mixing and plain relaxation
  double longest = 0.0;
  bool growing = false;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(s.a.size())), f = x;
  for (const std::size_t j : active) {
    const auto k = static_cast<Eigen::Index>(j);
    // between two pressure peaks no length may meet the curvature: limit it to the undeformed overlap
    const double longest_here = std::sqrt(2.0 * std::max(0.0, s.approach - s.gap[j]) / s.curvature[j]);
    x[k] = s.a[j];
    f[k] = std::min(x[k] * std::clamp(s.bent[j] / s.curvature[j], 1.0 / most, most), longest_here) - x[k];
    growing = growing || f[k] > 0.5 * x[k];
    longest = std::max(longest, x[k] + f[k]);
  }
  const Eigen::VectorXd next = mixing.next(x, f);
  for (const std::size_t j : active) {
    const auto k = static_cast<Eigen::Index>(j);
    const double plain = x[k] + f[k];
    s.a[j] = std::clamp(std::clamp(next[k], plain / apart, plain * apart), x[k] / most, x[k] * most);
  }
  return growing ? 1.0 : f.lpNorm<Eigen::Infinity>() / longest;
}

/// Iterates pressures at given lengths, lengths at given pressures, and the set of active strips. True when lengths
/// converge to `tolerance` times the longest (3e-3: the peak to 1e-4) and the approach to 1/100 of that. Strips below
/// `shortest` times the longest become inactive.
bool settle_once(Strips& s, double modulus, const NormalTarget& target, double tolerance, double shortest) {
  double last_approach = 0.0;
  Mixing mixing;
  Influences by;
  std::vector<std::size_t> active, outside;
  std::vector<int> times_left(s.y.size(), 0);
  for (int round = 0; round < most_strip_rounds; ++round) {
    active.clear();
    outside.clear();
    for (std::size_t j = 0; j < s.y.size(); ++j) (s.a[j] > 0.0 ? active : outside).push_back(j);
    if (active.empty()) return false;
    set_influences(s, active, modulus, by);
    solve_pressures(s, active, by, target);
    const double least = shortest * *std::max_element(s.a.begin(), s.a.end());
    const std::size_t left = std::erase_if(active, [&](std::size_t j) {
      if (s.p[j] > 0.0 && s.a[j] > least) return false;
      s.p[j] = 0.0;
      s.a[j] = 0.0;
      ++times_left[j];
      return true;
    });
    if (active.empty()) return false;
    const double change = relax_lengths(s, active, mixing);
    if (left > 0) continue;
    // overlapping strips become active: at once beside the patch and in regions without active strips, others after
    // convergence; a strip that has left twice is the edge of the patch
    const bool settled = change < tolerance && std::abs(s.approach - last_approach) < 0.1 * tolerance * s.approach;
    std::size_t joined = 0;
    for (const std::size_t j : outside) {
      const bool beside = (j > 0 && s.p[j - 1] > 0.0) || (j + 1 < s.p.size() && s.p[j + 1] > 0.0);
      if (times_left[j] > 1 || !(beside || settled || round == 0) || s.gap[j] >= s.approach) continue;
      const double left_open = overlap_left(s, active, j, modulus);
      if (left_open > 0.0) {
        s.a[j] = std::sqrt(start_depth * 2.0 * left_open / s.curvature[j]);
        ++joined;
      }
    }
    if (joined == 0 && settled) return true;
    last_approach = s.approach;
  }
  return false;
}

/// True where a strip has shrunk so far that its pressure is spurious: 35 GPa beside 0.3 where two pressure peaks are
/// about to merge. Pressure / (length * curvature) is similar on all strips of a patch (equal on an ellipse).
bool has_spike(const Strips& s) {
  std::vector<double> steepness;
  for (std::size_t j = 0; j < s.p.size(); ++j)
    if (s.p[j] > 0.0) steepness.push_back(s.p[j] / (s.a[j] * s.curvature[j]));
  if (steepness.empty()) return false;
  const auto middle = steepness.begin() + static_cast<std::ptrdiff_t>(steepness.size() / 2);
  std::nth_element(steepness.begin(), middle, steepness.end());
  return *std::max_element(steepness.begin(), steepness.end()) > 20.0 * *middle;
}

/// As settle_once; where that fails or leaves a pressure spike, once more without short strips. Small patches need
/// these, but between two pressure peaks they prevent convergence (a centred wheel at 8.4 kN, some steps of a wheelset
/// under 1/1000 of its load).
bool settle(Strips& s, double modulus, const NormalTarget& target, double tolerance) {
  const Strips start = s;
  if (settle_once(s, modulus, target, tolerance, 0.0) && !has_spike(s)) return true;
  s = start;
  return settle_once(s, modulus, target, tolerance, 0.05) && !has_spike(s);
}

NormalPatch patch_of(const Strips& s, std::size_t along) {
  NormalPatch p;
  double longest = 0.0, left = 1e9, right = -1e9;
  for (std::size_t j = 0; j < s.y.size(); ++j) {
    if (!(s.p[j] > 0.0)) continue;
    longest = std::max(longest, s.a[j]);
    left = std::min(left, s.centre[j] - s.a[j]);
    right = std::max(right, s.centre[j] + s.a[j]);
    p.area += 2.0 * s.a[j] * s.width;
    double peak = s.p[j] * s.p[j];  // p^2 is a parabola near the peak
    if (j > 0 && j + 1 < s.p.size()) {
      const double b = s.p[j - 1] * s.p[j - 1], f = s.p[j + 1] * s.p[j + 1], bend = 2.0 * peak - b - f;
      if (peak >= b && peak >= f && bend > 0.0) peak += std::min(0.04 * peak, (f - b) * (f - b) / (8.0 * bend));
    }
    p.max_pressure = std::max(p.max_pressure, std::sqrt(peak));
  }
  p.grid = {along, s.y.size(), (right - left) / static_cast<double>(along), s.width};
  p.pressure.assign(p.grid.size(), 0.0);
  const double cx = 0.5 * (left + right), cy = 0.5 * (s.y.front() + s.y.back());
  for (std::size_t j = 0; j < s.y.size(); ++j) {
    for (std::size_t i = 0; i < along; ++i) {
      const double x = cx + p.grid.x(i) - s.centre[j], t = s.a[j] > 0.0 ? x / s.a[j] : 2.0;
      if (std::abs(t) < 1.0) p.pressure[j * along + i] = s.p[j] * std::sqrt(1.0 - t * t);
    }
  }
  set_equivalent_ellipse(p);
  p.grid_x = cx;
  p.grid_y = cy;
  p.centre_x += cx;
  p.centre_y += cy;
  double force = 0.0;
  for (std::size_t j = 0; j < s.y.size(); ++j) force += 0.5 * pi * s.a[j] * s.p[j] * s.width;
  p.normal_force = force;
  p.ellipse = moments(s);
  p.approach = s.approach;
  return p;
}

/// Relative error of the peak: 1 % for half ellipses along the track, 2 % more where two pressure peaks separate, and a
/// term for strip centres that shift along the track with y (2.5 to 3.2 % on the flange, at a slope of 0.16).
double error_of(const Strips& s) {
  std::vector<double> behind(s.y.size());  // highest peak from each strip on
  double top = 0.0, before = 0.0, valley = 1.0, longest = 0.0, low = 1e9, high = -1e9;
  for (std::size_t j = s.y.size(); j-- > 0;) behind[j] = top = std::max(top, s.p[j]);
  for (std::size_t j = 0; j < s.y.size(); ++j) {
    if (!(s.p[j] > 0.0)) continue;
    before = std::max(before, s.p[j]);
    valley = std::min(valley, s.p[j] / std::min(before, behind[j]));
    longest = std::max(longest, s.a[j]);
    low = std::min(low, s.centre[j]);
    high = std::max(high, s.centre[j]);
  }
  return 0.01 + 0.02 * (1.0 - valley) + 0.2 * (high - low) / (2.0 * longest);
}

/// Equal strips from the first region to the last, enough for the narrowest region: with 7 instead of 16 across the
/// gauge corner its peak is 2 % off. Strips between the regions cost nothing.
int strips_of_regions(const std::vector<OverlapRange>& ranges, bool fine) {
  double widest = 0.0;
  for (const OverlapRange& o : ranges) widest = std::max(widest, o.high - o.low);
  double narrowest = widest;
  for (const OverlapRange& o : ranges)
    if (o.high - o.low > 0.2 * widest) narrowest = std::min(narrowest, o.high - o.low);
  return std::min(fine ? static_cast<int>(StripStart::most) : 32,
                  static_cast<int>((fine ? 16.0 : 8.0) * (ranges.back().high - ranges.front().low) / narrowest));
}

/// Strips over the overlap at this approach, which contains the patch with a margin; their number is proportional to
/// its width over that of the ellipse by the curvature at the rigid point.
bool solve_strips(const NormalInput& in, double approach, bool fine, Strips& s) {
  const ContactRegion& r = in.regions.front();
  const std::vector<OverlapRange> ranges = overlaps_at(r, approach);
  if (ranges.empty()) return false;
  const double low = ranges.front().low, high = ranges.back().high;
  const double b = std::sqrt(approach / (0.5 * std::max(r.curvature_y, 0.05 * r.curvature_x)));
  int wished = std::clamp(static_cast<int>((fine ? 16.0 : 6.0) * (high - low) / b), fine ? 28 : 12, fine ? 40 : 20);
  if (ranges.size() > 1) wished = strips_of_regions(ranges, fine);
  // multiples of 4: coarser grids exist
  s = cut(r, low, high, in.strips > 0 && fine ? in.strips : (wished + 3) / 4 * 4);
  s.separate(Separation(ranges, in.influence));
  const auto whole = [&](std::size_t j) {
    return std::sqrt(2.0 * std::max(0.0, approach - s.gap[j]) / s.curvature[j]);
  };
  StripStart* start = in.start;
  const double strips = static_cast<double>(s.y.size());
  for (std::size_t j = 0; j < s.y.size(); ++j) {
    const double depth = start_depth * approach - s.gap[j];
    if (depth > 0.0) s.a[j] = std::sqrt(2.0 * depth / s.curvature[j]);
    if (start && start->count > 0) {  // a strip at the edge may be inactive at first: it joins by its overlap
      const double share = start->at((static_cast<double>(j) + 0.5) / strips);
      s.a[j] = share > 0.05 ? share * whole(j) : 0.0;
    }
  }
  const bool settled = settle(s, in.elastic.effective_modulus(), in.target, fine ? in.settle : 1e-2);
  if (start && s.y.size() <= StripStart::most) {
    start->count = settled ? s.y.size() : 0;
    for (std::size_t j = 0; j < s.y.size(); ++j) start->share[j] = whole(j) > 0.0 ? s.a[j] / whole(j) : 0.0;
  }
  return settled;
}

}  // namespace

double estimate_approach(const NormalInput& in) {
  if (!in.target.by_force) return in.target.value;
  const ContactRegion& r = in.regions.front();
  const double B = std::max(0.5 * r.curvature_y, 0.05 * r.curvature_x);
  const double guess =
      in.approach > 0.0
          ? in.approach
          : hertz_of_force(0.5 * r.curvature_x, B, in.elastic.effective_modulus(), in.target.value).approach;
  Strips s;
  solve_strips(in, guess, false, s);
  return s.approach > 0.0 ? s.approach : guess;
}

std::vector<RegionPatch> solve_semi_hertz(const NormalInput& in) {
  const ContactRegion& r = in.regions.front();
  RegionPatch out;
  Strips s;
  const bool settled = solve_strips(in, in.approach > 0.0 ? in.approach : estimate_approach(in), true, s);
  if (std::none_of(s.p.begin(), s.p.end(), [](double p) { return p > 0.0; })) {
    out.patch.reasons.push_back("nothing overlaps: the approach is below what the samples of the gap leave open");
    out.patch.error_estimate = 1.0;
    return {out};
  }
  out.patch = patch_of(s, static_cast<std::size_t>(in.along));
  out.patch.error_estimate = settled ? error_of(s) : 0.1;
  if (!settled)
    out.patch.reasons.push_back("the strips did not settle within " + std::to_string(most_strip_rounds) + " rounds");
  const double steepest = std::max(std::abs(r.wheel_curvature), std::abs(r.rail_curvature));
  if (r.wheel_curvature * r.rail_curvature < 0.0 && out.patch.ellipse.b * steepest > 0.1)
    out.patch.reasons.push_back(
        "conformal contact: the surface turns by more than 0.1 rad over half the patch, the bodies are no half-spaces");
  return {out};
}

}  // namespace epafi
