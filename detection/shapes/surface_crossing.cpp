#include "detection/shapes/surface_crossing.h"

#include <cmath>
#include <optional>

#include "detection/aabb.h"

namespace epafi {
namespace {

/// A triangle with its box and the planes through its sides that stand on it.
struct FacetInSweep {
  std::uint32_t triangle;
  Aabb box;
  std::array<Vec3, 3> corner, inward;
  Vec3 normal;
};

FacetInSweep facet_of(const TriangleSurface& s, std::uint32_t t) {
  FacetInSweep f{t, {}, {}, {}, Vec3::Zero()};
  for (std::size_t k = 0; k < 3; ++k) f.corner[k] = s.vertices[s.triangles[t][k]];
  for (const Vec3& c : f.corner) f.box.include(c);
  f.normal = (f.corner[1] - f.corner[0]).cross(f.corner[2] - f.corner[0]).normalized();
  for (std::size_t k = 0; k < 3; ++k) f.inward[k] = f.normal.cross(f.corner[(k + 1) % 3] - f.corner[k]).normalized();
  return f;
}

/// Where a side of p goes through the inside of q.
std::optional<Vec3> crossing_of(const FacetInSweep& p, const FacetInSweep& q, double slack) {
  std::array<double, 3> height{};
  for (std::size_t k = 0; k < 3; ++k) height[k] = q.normal.dot(p.corner[k] - q.corner[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const double h0 = height[k], h1 = height[(k + 1) % 3];
    if (!(h0 * h1 < 0.0) || std::min(std::abs(h0), std::abs(h1)) <= std::abs(slack)) continue;
    const Vec3 x = p.corner[k] + h0 / (h0 - h1) * (p.corner[(k + 1) % 3] - p.corner[k]);
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) inside = inside && q.inward[i].dot(x - q.corner[i]) > slack;
    if (inside) return x;
  }
  return std::nullopt;
}

}  // namespace

SurfaceCrossings find_crossings(const TriangleSurface& surface, double slack) {
  std::vector<FacetInSweep> facets;
  facets.reserve(surface.triangles.size());
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) facets.push_back(facet_of(surface, t));
  std::sort(facets.begin(), facets.end(), [](const FacetInSweep& a, const FacetInSweep& b) {
    return std::pair(a.box.min.x(), a.triangle) < std::pair(b.box.min.x(), b.triangle);
  });
  std::vector<std::optional<Vec3>> place(surface.triangles.size());
  const auto see = [&](const FacetInSweep& p, const FacetInSweep& q) {
    if (!place[p.triangle]) place[p.triangle] = crossing_of(p, q, slack);
  };
  for (std::size_t i = 0; i < facets.size(); ++i)
    for (std::size_t k = i + 1; k < facets.size() && facets[k].box.min.x() <= facets[i].box.max.x(); ++k) {
      if (!facets[i].box.overlaps(facets[k].box)) continue;
      see(facets[i], facets[k]);
      see(facets[k], facets[i]);
    }
  SurfaceCrossings out;
  for (const auto& x : place) {
    if (!x) continue;
    if (out.triangles++ == 0) out.first = *x;
  }
  return out;
}

}  // namespace epafi
