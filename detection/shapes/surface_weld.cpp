#include "detection/shapes/surface_weld.h"

#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace epafi {
namespace {

constexpr std::uint32_t nobody = 0xffffffffu;

/// Corners in the order of their places along one direction.
class CornerOrder {
 public:
  CornerOrder(const std::vector<Vec3>& corners, const Vec3& along) : along_(along), place_(corners.size()) {
    std::vector<double> place(corners.size());
    for (std::size_t k = 0; k < corners.size(); ++k) place[k] = along.dot(corners[k]);
    order_.resize(corners.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return place[a] < place[b] || (place[a] == place[b] && a < b); });
    for (std::size_t k = 0; k < order_.size(); ++k) place_[k] = place[order_[k]];
  }
  const std::vector<std::uint32_t>& order() const { return order_; }
  double place(std::size_t k) const { return place_[k]; }
  /// The corners whose places are within the tolerance of the way from a to b.
  std::span<const std::uint32_t> beside(const Vec3& a, const Vec3& b, double tolerance) const {
    const double from = along_.dot(a), to = along_.dot(b);
    const auto begin = std::lower_bound(place_.begin(), place_.end(), std::min(from, to) - tolerance);
    const auto end = std::upper_bound(begin, place_.end(), std::max(from, to) + tolerance);
    return std::span(order_).subspan(static_cast<std::size_t>(begin - place_.begin()),
                                     static_cast<std::size_t>(end - begin));
  }

 private:
  Vec3 along_;
  std::vector<double> place_;
  std::vector<std::uint32_t> order_;
};

/// of[k]: the corner that corner k becomes.
void rename(TriangleSurface& surface, const std::vector<std::uint32_t>& of) {
  std::vector<std::uint32_t> name(of.size());
  std::vector<Vec3> kept;
  for (std::uint32_t k = 0; k < of.size(); ++k) {
    if (of[k] != k) continue;
    name[k] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(surface.vertices[k]);
  }
  for (Triangle& t : surface.triangles)
    for (std::uint32_t& v : t) v = name[of[v]];
  surface.vertices.swap(kept);
}

/// Behind the last use of the edge that begins at uses[begin].
std::size_t end_of_edge(const std::vector<EdgeUse>& uses, std::size_t begin) {
  std::size_t end = begin;
  while (end < uses.size() && uses[end].edge() == uses[begin].edge()) ++end;
  return end;
}

/// A corner on the inside of a side, by how far along.
struct CornerOnSide {
  std::uint32_t triangle, side;
  double along;  ///< in (0, 1)
  std::uint32_t corner;
};

/// Appends the corners that lie on the edge within the tolerance, but not at its ends.
/// name[k]: the surface's number of corner k of the orders.
void find_on_edge(const TriangleSurface& surface, const std::array<CornerOrder, 3>& orders,
                  const std::vector<std::uint32_t>& name, const EdgeUse& use, double tolerance,
                  std::vector<CornerOnSide>& out) {
  const Triangle& t = surface.triangles[use.triangle];
  const Vec3 &a = surface.vertices[t[use.side]], &b = surface.vertices[t[(use.side + 1) % 3]];
  std::span<const std::uint32_t> near = orders[0].beside(a, b, tolerance);
  for (std::size_t k = 1; k < 3; ++k) {
    const auto other = orders[k].beside(a, b, tolerance);
    if (other.size() < near.size()) near = other;
  }
  const Vec3 way = b - a;
  const double length = way.norm();
  for (const std::uint32_t k : near) {
    const std::uint32_t v = name[k];
    if (v == t[0] || v == t[1] || v == t[2]) continue;
    const Vec3 to = surface.vertices[v] - a;
    const double along = to.dot(way) / (length * length);
    if (!(along * length > tolerance && (1.0 - along) * length > tolerance)) continue;
    if ((to - along * way).squaredNorm() <= tolerance * tolerance) out.push_back({use.triangle, use.side, along, v});
  }
}

/// Cuts one triangle at all corners on its sides: from the corner on one side to the corner across.
void cut(TriangleSurface& surface, std::span<const CornerOnSide> at) {
  struct Piece {
    Triangle corner;
    std::array<std::uint32_t, 3> side;  ///< of the whole triangle that side k lies on, or nobody
  };
  std::vector<Piece> pieces{{surface.triangles[at.front().triangle], {0, 1, 2}}};
  for (const CornerOnSide& c : at) {
    // the last piece on that side holds the rest of it: corners come in ascending order along each side
    for (std::size_t p = pieces.size(); p-- > 0;) {
      const auto k = static_cast<std::size_t>(std::find(pieces[p].side.begin(), pieces[p].side.end(), c.side) -
                                              pieces[p].side.begin());
      if (k == 3) continue;
      const Piece whole = pieces[p];
      const std::size_t next = (k + 1) % 3, across = (k + 2) % 3;
      pieces[p] = {{whole.corner[k], c.corner, whole.corner[across]}, {nobody, nobody, whole.side[across]}};
      pieces.push_back({{c.corner, whole.corner[next], whole.corner[across]}, {c.side, whole.side[next], nobody}});
      break;
    }
  }
  surface.triangles[at.front().triangle] = pieces.front().corner;
  for (std::size_t p = 1; p < pieces.size(); ++p) surface.triangles.push_back(pieces[p].corner);
}

}  // namespace

void weld_corners(TriangleSurface& surface, JoinReport& report) {
  // along a direction that no edge of a drawing has: few corners share a place
  const CornerOrder along(surface.vertices, Vec3(0.5377, 0.6831, 0.4943).normalized());
  const auto& order = along.order();
  std::vector<std::uint32_t> of(surface.vertices.size());
  std::iota(of.begin(), of.end(), 0u);
  for (std::size_t k = 0; k < order.size(); ++k) {
    double nearest = report.tolerance;
    for (std::size_t j = k; j-- > 0 && along.place(k) - along.place(j) <= report.tolerance;) {
      if (of[order[j]] != order[j]) continue;
      const double distance = (surface.vertices[order[k]] - surface.vertices[order[j]]).norm();
      if (distance > nearest) continue;
      nearest = distance;
      of[order[k]] = order[j];
    }
    if (of[order[k]] == order[k]) continue;
    ++report.welded;
    report.weld_distance = std::max(report.weld_distance, nearest);
  }
  if (report.welded > 0) rename(surface, of);
}

void drop_slivers(TriangleSurface& surface, JoinReport& report) {
  const std::size_t all = surface.triangles.size();
  std::erase_if(surface.triangles, [&](const Triangle& t) { return least_height(surface, t) <= report.tolerance; });
  report.slivers += all - surface.triangles.size();
  std::vector<std::pair<Triangle, std::uint32_t>> sorted;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    Triangle corner = surface.triangles[t];
    std::sort(corner.begin(), corner.end());
    sorted.emplace_back(corner, t);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<char> again(surface.triangles.size(), 0);
  for (std::size_t k = 1; k < sorted.size(); ++k) again[sorted[k].second] = sorted[k].first == sorted[k - 1].first;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (!again[t]) surface.triangles[kept++] = surface.triangles[t];
  report.doubled += surface.triangles.size() - kept;
  surface.triangles.resize(kept);
}

void cut_at_corners(TriangleSurface& surface, JoinReport& report) {
  const auto uses = sorted_edge_uses(surface.triangles);
  std::vector<EdgeUse> loose;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    end = end_of_edge(uses, begin);
    if (end - begin != 2)
      loose.insert(loose.end(), uses.begin() + static_cast<std::ptrdiff_t>(begin),
                   uses.begin() + static_cast<std::ptrdiff_t>(end));
  }
  if (loose.empty()) return;
  std::vector<std::uint32_t> name;  // a corner on an open side is itself the end of one: no others are tested
  std::vector<char> known(surface.vertices.size(), 0);
  for (const EdgeUse& u : loose)
    for (const std::uint32_t v : {u.low, u.high})
      if (!std::exchange(known[v], 1)) name.push_back(v);
  std::sort(name.begin(), name.end());
  std::vector<Vec3> corners;
  for (const std::uint32_t v : name) corners.push_back(surface.vertices[v]);
  const std::array<CornerOrder, 3> orders{CornerOrder(corners, Vec3::UnitX()), CornerOrder(corners, Vec3::UnitY()),
                                          CornerOrder(corners, Vec3::UnitZ())};
  std::vector<CornerOnSide> found;
  for (const EdgeUse& u : loose) find_on_edge(surface, orders, name, u, report.tolerance, found);
  std::sort(found.begin(), found.end(), [](const CornerOnSide& a, const CornerOnSide& b) {
    return std::tuple(a.triangle, a.side, a.along, a.corner) < std::tuple(b.triangle, b.side, b.along, b.corner);
  });
  for (std::size_t begin = 0, end = 0; begin < found.size(); begin = end) {
    while (end < found.size() && found[end].triangle == found[begin].triangle) ++end;
    cut(surface, std::span(found).subspan(begin, end - begin));
  }
  report.cut = found.size();
}

void turn_alike(TriangleSurface& surface, JoinReport& report) {
  const std::size_t count = surface.triangles.size();
  const auto uses = sorted_edge_uses(surface.triangles);
  struct Neighbour {
    std::uint32_t triangle = nobody;
    bool alike = true;
  };
  std::vector<std::array<Neighbour, 3>> neighbours(count);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    end = end_of_edge(uses, begin);
    if (end - begin != 2) continue;
    const EdgeUse &p = uses[begin], &q = uses[begin + 1];
    neighbours[p.triangle][p.side] = {q.triangle, p.forward != q.forward};
    neighbours[q.triangle][q.side] = {p.triangle, p.forward != q.forward};
  }
  std::vector<signed char> sign(count, 0);
  std::vector<std::uint32_t> part;
  for (std::uint32_t first = 0; first < count; ++first) {
    if (sign[first] != 0) continue;
    part.assign(1, first);
    sign[first] = 1;
    double area = 0.0;  // of those that stay over those that turn
    for (std::size_t k = 0; k < part.size(); ++k) {
      const Triangle& t = surface.triangles[part[k]];
      const Vec3 &a = surface.vertices[t[0]], &b = surface.vertices[t[1]], &c = surface.vertices[t[2]];
      area += sign[part[k]] * (b - a).cross(c - a).norm();
      for (const Neighbour& n : neighbours[part[k]]) {
        if (n.triangle == nobody || sign[n.triangle] != 0) continue;
        sign[n.triangle] = static_cast<signed char>(n.alike ? sign[part[k]] : -sign[part[k]]);
        part.push_back(n.triangle);
      }
    }
    for (const std::uint32_t t : part) {
      if ((sign[t] > 0) == (area >= 0.0)) continue;
      std::swap(surface.triangles[t][1], surface.triangles[t][2]);
      ++report.flipped;
    }
  }
}

}  // namespace epafi
