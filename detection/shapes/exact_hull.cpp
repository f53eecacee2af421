/// Quickhull (Barber, Dobkin, Huhdanpaa 1996, ACM Trans. Math. Softw. 22, 469) with the exact orientation of CGAL's
/// kernel. A point removes also the facets in whose plane it lies: so the horizon never holds an edge in line with it,
/// no triangle is degenerate, and what ends up inside an edge or a face is gone.
#include "detection/shapes/exact_hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>

namespace epafi {
namespace {

using HullKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct HullFacet {
  std::array<std::uint32_t, 3> corner;
  std::array<std::uint32_t, 3> beside;  ///< facet across the edge from corner k to corner k + 1
  std::vector<std::uint32_t> outside;   ///< points strictly above, each in the list of one facet
  bool removed = false;
};

class HullBuilder {
 public:
  HullBuilder(std::span<const Vec3> points, std::array<std::uint32_t, 4> simplex)
      : points_(points), starting_(points.size()) {
    for (const Vec3& p : points) exact_.emplace_back(p.x(), p.y(), p.z());
    if (side(simplex[0], simplex[1], simplex[2], simplex[3]) > 0) std::swap(simplex[1], simplex[2]);
    const auto [a, b, c, d] = simplex;
    facets_.push_back({{a, b, c}, {1, 2, 3}, {}});
    facets_.push_back({{b, a, d}, {0, 3, 2}, {}});
    facets_.push_back({{c, b, d}, {0, 1, 3}, {}});
    facets_.push_back({{a, c, d}, {0, 2, 1}, {}});
    std::vector<std::uint32_t> others;
    for (std::uint32_t k = 0; k < points.size(); ++k)
      if (std::find(simplex.begin(), simplex.end(), k) == simplex.end()) others.push_back(k);
    share_out(others, 0);
  }

  std::vector<std::array<std::uint32_t, 3>> build() {
    for (std::size_t f = 0; f < facets_.size(); ++f)
      if (!facets_[f].removed && !facets_[f].outside.empty()) add(farthest_above(f), static_cast<std::uint32_t>(f));
    std::vector<std::array<std::uint32_t, 3>> out;
    for (const HullFacet& f : facets_) {
      if (f.removed) continue;
      auto corner = f.corner;
      std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
      out.push_back(corner);
    }
    return out;
  }

 private:
  /// Positive where d sees a, b, c counter-clockwise, 0 on their plane.
  int side(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    return static_cast<int>(CGAL::orientation(exact_[a], exact_[b], exact_[c], exact_[d]));
  }
  int side(std::size_t f, std::uint32_t point) const {
    const auto& [a, b, c] = facets_[f].corner;
    return side(a, b, c, point);
  }

  /// Gives each point to the first facet from `first` on that it lies strictly above; the others are inside.
  void share_out(const std::vector<std::uint32_t>& points, std::size_t first) {
    for (const std::uint32_t p : points)
      for (std::size_t f = first; f < facets_.size(); ++f) {
        if (side(f, p) <= 0) continue;
        facets_[f].outside.push_back(p);
        break;
      }
  }

  /// To rounding: any point above would do, the farthest saves facets.
  std::uint32_t farthest_above(std::size_t f) const {
    const auto& [a, b, c] = facets_[f].corner;
    const Vec3 first = points_[a], normal = (points_[b] - first).cross(points_[c] - first);
    const auto& above = facets_[f].outside;
    return *std::max_element(above.begin(), above.end(), [&](std::uint32_t p, std::uint32_t q) {
      return normal.dot(points_[p] - first) < normal.dot(points_[q] - first);
    });
  }

  /// Facets that the point sees, or in whose plane it lies, are replaced by those from the horizon to it.
  void add(std::uint32_t point, std::uint32_t seen) {
    const auto first = static_cast<std::uint32_t>(facets_.size());
    std::vector<std::uint32_t> removed{seen}, orphans;
    facets_[seen].removed = true;
    for (std::size_t r = 0; r < removed.size(); ++r) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t other = facets_[removed[r]].beside[k];
        if (facets_[other].removed) continue;
        if (side(other, point) < 0) continue;
        facets_[other].removed = true;
        removed.push_back(other);
      }
    }
    for (const std::uint32_t r : removed) {
      for (std::size_t k = 0; k < 3; ++k)
        if (!facets_[facets_[r].beside[k]].removed) add_facet(r, k, point);
      orphans.insert(orphans.end(), facets_[r].outside.begin(), facets_[r].outside.end());
      facets_[r].outside = {};
    }
    for (std::uint32_t f = first; f < facets_.size(); ++f) {
      const std::uint32_t next = starting_[facets_[f].corner[1]];
      facets_[f].beside[1] = next;
      facets_[next].beside[2] = f;
    }
    orphans.erase(std::find(orphans.begin(), orphans.end(), point));
    share_out(orphans, first);
  }

  /// From edge k of a removed facet, on the horizon, to the point.
  void add_facet(std::uint32_t removed, std::size_t k, std::uint32_t point) {
    const std::uint32_t from = facets_[removed].corner[k], to = facets_[removed].corner[(k + 1) % 3];
    const std::uint32_t kept = facets_[removed].beside[k], added = static_cast<std::uint32_t>(facets_.size());
    HullFacet& beyond = facets_[kept];
    for (std::size_t j = 0; j < 3; ++j)
      if (beyond.corner[j] == to && beyond.corner[(j + 1) % 3] == from) beyond.beside[j] = added;
    starting_[from] = added;
    facets_.push_back({{from, to, point}, {kept, 0, 0}, {}});
  }

  std::span<const Vec3> points_;
  std::vector<HullKernel::Point_3> exact_;
  std::vector<HullFacet> facets_;
  std::vector<std::uint32_t> starting_;  ///< facet of the new ones whose horizon edge begins at a point
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> exact_hull(std::span<const Vec3> points,
                                                     std::array<std::uint32_t, 4> simplex) {
  return HullBuilder(points, simplex).build();
}

}  // namespace epafi
