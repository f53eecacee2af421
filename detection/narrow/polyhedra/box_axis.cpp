// The 15 axes of two boxes: A's three, B's three, and the nine across an axis of each.
#include <cmath>

#include "detection/narrow/polyhedra/axis_search.h"

namespace epafi {
namespace {

using AxisKind = SeparatingAxis::Kind;

constexpr double even = 1e-9;       // of the size: axes nearer than this to the best are left to the search
constexpr double parallel = 1e-6;   // squared sine: below it rounding of an axis across reaches `even`
constexpr double straight = 1e-14;  // skew up to which the 15 axes are those of the boxes, far below `even`

/// The largest separation met, and the largest of the others.
struct TwoLargest {
  double best = -infinity, second = -infinity;
  int axis = 0;  ///< 0 to 2 of A, 3 to 5 of B, 6 + 3 i + j across A's i and B's j
  void meet(double gap, int which) {
    const bool larger = gap > best;
    second = larger ? best : std::max(second, gap);
    best = larger ? gap : best;
    axis = larger ? which : axis;
  }
};

/// B's box seen from A's.
struct BoxPair {
  std::array<Vec3, 3> u, v;    ///< axes of A and of B
  Vec3 between, t, tb;         ///< from A's centre to B's; along A's axes, along B's
  double r[3][3], size[3][3];  ///< cosines between A's axes and B's; their sizes

  BoxPair(const PolyhedronPair& pair, const BoxFrame& a, const BoxFrame& b)
      : between(pair.rotation * b.centre + pair.offset - a.centre) {
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = pair.a.face_normals[a.face[k][1]];
      v[k] = pair.rotation * pair.b.face_normals[b.face[k][1]];
      t[static_cast<int>(k)] = between.dot(u[k]);
      tb[static_cast<int>(k)] = between.dot(v[k]);
    }
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        r[i][j] = u[i].dot(v[j]);
        size[i][j] = std::abs(r[i][j]);
      }
  }
  /// False where two axes are so parallel that what lies across them is left out.
  bool meet_all(const Vec3& a, const Vec3& b, TwoLargest& found) const;
};

bool BoxPair::meet_all(const Vec3& a, const Vec3& b, TwoLargest& found) const {
  for (int i = 0; i < 3; ++i)
    found.meet(std::abs(t[i]) - a[i] - (size[i][0] * b[0] + size[i][1] * b[1] + size[i][2] * b[2]), i);
  for (int j = 0; j < 3; ++j)
    found.meet(std::abs(tb[j]) - b[j] - (size[0][j] * a[0] + size[1][j] * a[1] + size[2][j] * a[2]), 3 + j);
  bool all = true;
  for (int i = 0; i < 3; ++i) {
    const int p = (i + 1) % 3, q = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int l = (j + 1) % 3, m = (j + 2) % 3;
      const double along = std::abs(t[q] * r[p][j] - t[p] * r[q][j]) - a[p] * size[q][j] - a[q] * size[p][j] -
                           b[l] * size[i][m] - b[m] * size[i][l];
      const double square = 1.0 - r[i][j] * r[i][j];
      all = all && square > parallel;
      // the length of the axis is at most 1: dividing lowers what is below 0 further
      if (!(square > parallel) || (along < 0.0 && along < found.second)) continue;
      found.meet(along / std::sqrt(square), 6 + 3 * i + j);
    }
  }
  return all;
}

/// The edges of the two boxes that face each other across axis i of A and j of B.
SeparatingAxis across(const BoxPair& at, const BoxFrame& a, const BoxFrame& b, std::size_t i, std::size_t j) {
  Vec3 n = at.u[i].cross(at.v[j]);
  if (n.dot(at.between) < 0.0) n = -n;
  const auto along_u = [&](std::size_t k) { return n.dot(at.u[k % 3]) > 0.0; };
  const auto along_v = [&](std::size_t k) { return n.dot(at.v[k % 3]) < 0.0; };
  const std::uint32_t of_a = a.edge[i][2u * along_u(i + 1) + along_u(i + 2)];
  const std::uint32_t of_b = b.edge[j][2u * along_v(j + 1) + along_v(j + 2)];
  return {AxisKind::edges, 0.0, n.normalized(), of_a, of_b};
}

}  // namespace

BoxAxis box_axis(const PolyhedronPair& pair) {
  const BoxFrame &a = *pair.a.box, &b = *pair.b.box;
  const BoxPair at(pair, a, b);
  TwoLargest found;
  const bool all = at.meet_all(a.half, b.half, found);
  const auto k = static_cast<std::size_t>(found.axis % 3);
  const double t = at.t[found.axis % 3], tb = at.tb[found.axis % 3];
  BoxAxis out;
  if (found.axis < 3)
    out.axis = {AxisKind::face_a, 0.0, t > 0.0 ? at.u[k] : Vec3(-at.u[k]), a.face[k][t > 0.0], 0};
  else if (found.axis < 6)
    out.axis = {AxisKind::face_b, 0.0, tb > 0.0 ? at.v[k] : Vec3(-at.v[k]), 0, b.face[k][tb < 0.0]};
  else
    out.axis = across(at, a, b, static_cast<std::size_t>(found.axis) / 3 - 2, k);
  out.axis.gap = found.best;
  const double size = pair.a.radius + pair.b.radius + at.between.cwiseAbs().maxCoeff();
  out.alone = all && std::max(a.skew, b.skew) < straight && found.second < found.best - even * size;
  return out;
}

}  // namespace epafi
