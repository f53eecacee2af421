// Profiles from their published definitions, lengths in mm as there.
#include <algorithm>
#include <cmath>

#include "detection/profiles/profile.h"

namespace epafi {
namespace {

constexpr double mm = 1e-3;

double polynomial(const double* c, int n, double s) {
  double sum = 0.0;
  for (int k = n; k-- > 0;) sum = sum * s + c[k];
  return sum;
}

/// S1002, h = 28, e = 32.5, zones A to H (EN 13715, UIC 510-2): z over s, both in mm, flange at s < 0.
double s1002(double s) {
  static const double G[] = {0.0,
                             -3.358537058e-2,
                             1.565681624e-3,
                             -2.810427944e-5,
                             5.844240864e-8,
                             -1.562379023e-8,
                             5.309217349e-15,
                             -5.957839843e-12,
                             2.646656573e-13};
  static const double F[] = {-4.320221063e3,  -1.038384026e3,  -1.065501873e2,  -6.051367875,
                             -2.054332446e-1, -4.169739389e-3, -4.687195829e-5, -2.252755540e-7};
  const auto arc = [s](double centre, double height, double radius, double sign) {
    return height + sign * std::sqrt(radius * radius - (s - centre) * (s - centre));
  };
  if (s > 32.15796) return 1.364323640 - 0.066666667 * s;  // H
  if (s >= -26.0) return polynomial(G, 9, s);
  if (s > -35.0) return polynomial(F, 8, s);
  if (s > -38.426669071) return arc(-26.210665, 16.446, 13.0, -1.0);         // E
  if (s > -39.764473993) return -93.576667419 - 2.747477419 * s;             // D
  if (s > -49.662510381) return arc(-58.558326413, 8.834924130, 20.0, 1.0);  // C
  if (s > -62.764705882) return arc(-55.0, 16.0, 12.0, 1.0);                 // B
  return arc(-49.5, 9.519259302, 20.5, 1.0);                                 // A
}

ProfilePoints make_s1002() {
  ProfilePoints p;
  std::vector<double> s{-38.426669071, -39.764473993, -49.662510381, -62.764705882, 32.15796};  // joints are knots
  for (int k = -699; k <= 600; ++k) s.push_back(0.1 * k);
  std::sort(s.begin(), s.end());
  for (const double x : s) {
    // a joint a hair from a point of the lattice would make the spline stiff there
    if (!p.y.empty() && x * mm - p.y.back() < 0.01 * mm) continue;
    p.y.push_back(x * mm);
    p.z.push_back(s1002(x) * mm);
  }
  return p;
}

/// Rail head upright: arcs of 300, 80, 13 mm with tangent joints at y1 and y2, then a flank of 1:20 (EN 13674-1
/// drawing).
ProfilePoints make_rail(double y1, double y2) {
  const double top = std::asin(y1 / 300.0);
  const double cy = (300.0 - 80.0) * std::sin(top),
               cz = 300.0 - (300.0 - 80.0) * std::cos(top);  // centre of the 80 mm arc
  const double side = std::asin((y2 - cy) / 80.0);
  const double dy = cy + (80.0 - 13.0) * std::sin(side),
               dz = cz - (80.0 - 13.0) * std::cos(side);  // centre of the 13 mm arc
  const double flank = std::atan(20.0);
  std::vector<std::pair<double, double>> half;
  const auto arc = [&](double oy, double oz, double R, double from, double to) {
    const int n = std::max(2, static_cast<int>(std::ceil(R * (to - from) / 0.1)));
    for (int k = 1; k <= n; ++k) {
      const double t = from + (to - from) * k / n;
      half.emplace_back(oy + R * std::sin(t), oz - R * std::cos(t));
    }
  };
  arc(0.0, 300.0, 300.0, 0.0, top);
  arc(cy, cz, 80.0, top, side);
  arc(dy, dz, 13.0, side, flank);
  const auto [ey, ez] = half.back();
  for (int k = 1; k <= 28; ++k) half.emplace_back(ey + (30.0 - ez) / 20.0 * k / 28.0, ez + (30.0 - ez) * k / 28.0);
  ProfilePoints p;
  for (std::size_t k = half.size(); k-- > 0;) {
    p.y.push_back(-half[k].first * mm);
    p.z.push_back(half[k].second * mm);
  }
  p.y.push_back(0.0);
  p.z.push_back(0.0);
  for (const auto& [y, z] : half) {
    p.y.push_back(y * mm);
    p.z.push_back(z * mm);
  }
  return p;
}

}  // namespace

ProfilePoints cone_profile(double conicity) {
  const double from = std::atan(conicity), to = 70.0 * 3.14159265358979323846 / 180.0, R = 13.0, y1 = -38.0;
  std::vector<std::pair<double, double>> p;  // from the field side to the flange
  for (int k = 0; k <= 196; ++k) p.emplace_back(60.0 - 0.5 * k, -conicity * (60.0 - 0.5 * k));
  for (int k = 1; k <= 40; ++k) {
    const double b = from + (to - from) * k / 40.0;
    p.emplace_back(y1 - R * (std::sin(b) - std::sin(from)), -conicity * y1 + R * (std::cos(from) - std::cos(b)));
  }
  const auto [ey, ez] = p.back();
  for (int k = 1; k <= 30; ++k) p.emplace_back(ey - 0.5 * k / std::tan(to), ez + 0.5 * k);
  ProfilePoints out;
  for (std::size_t k = p.size(); k-- > 0;) {
    out.y.push_back(p[k].first * mm);
    out.z.push_back(p[k].second * mm);
  }
  return out;
}

const ProfilePoints* built_in_profile(const std::string& name) {
  static const ProfilePoints wheel = make_s1002();
  static const ProfilePoints rail_60e1 = make_rail(20.456 / 2.0, 52.053 / 2.0);
  static const ProfilePoints rail_uic60 = make_rail(10.5, 25.988023397);
  return name == "s1002" ? &wheel : name == "60e1" ? &rail_60e1 : name == "uic60" ? &rail_uic60 : nullptr;
}

}  // namespace epafi
