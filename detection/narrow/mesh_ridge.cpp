#include "detection/narrow/mesh_ridge.h"

#include <algorithm>
#include <cmath>

#include "detection/narrow/epa.h"
#include "detection/narrow/gjk.h"

namespace epafi {
namespace {

/// The convex hull of the corners of some triangles, about a point of theirs.
struct Ridge {
  std::vector<Vec3> corners;
  Vec3 support(const Vec3& d) const {
    return *std::max_element(corners.begin(), corners.end(),
                             [&](const Vec3& a, const Vec3& b) { return d.dot(a) < d.dot(b); });
  }
  double radius() const {
    double square = 0.0;
    for (const Vec3& c : corners) square = std::max(square, c.squaredNorm());
    return std::sqrt(square);
  }
};

bool share_a_corner(const Triangle& a, const Triangle& b) {
  return std::any_of(a.begin(), a.end(), [&](std::uint32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

/// No corner of the other rises above the plane of t, seen from x.
bool falls_away(const TriangleMesh& mesh, std::uint32_t t, std::uint32_t other, const Vec3& x, double tolerance) {
  const Vec3 n = normal_towards(mesh, t, x), on_plane = mesh.corners(t)[0];
  for (const Vec3& c : mesh.corners(other))
    if (n.dot(c - on_plane) > tolerance) return false;
  return true;
}

/// The triangle and those that meet it in a corner and bend away from it.
void gather(const CoreNearMesh& body, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
            const BarredTriangle& at, Ridge& ridge) {
  ridge.corners.clear();
  const Vec3& x = body.pose.position;
  for (const auto t : triangles) {
    const bool own = t == at.triangle;
    if (!own &&
        (!share_a_corner(mesh.triangles[t], mesh.triangles[at.triangle]) ||
         !falls_away(mesh, at.triangle, t, x, body.tolerance) || !falls_away(mesh, t, at.triangle, x, body.tolerance)))
      continue;
    for (const Vec3& c : mesh.corners(t)) ridge.corners.push_back(c - at.point);
  }
}

/// The way out of the ridge.
MeshPoint leave(const CoreNearMesh& body, const Ridge& ridge, const BarredTriangle& at, ContactSink& sink) {
  const ConvexRef rock{&ridge, [](const void* p, const Vec3& d) { return static_cast<const Ridge*>(p)->support(d); },
                       ridge.radius()};
  const MinkowskiDifference difference(body.core, rock, body.pose, {at.point, Quat(1, 0, 0, 0)});
  const GjkResult g = gjk(difference);
  double gap = g.lower, uncertainty = g.upper - g.lower;
  Vec3 normal = g.normal, on_ridge = g.witness_b;
  if (g.status == GjkResult::Status::overlapping) {
    const Penetration p = epa(difference);
    gap = -p.upper, uncertainty = p.upper - p.lower, normal = p.normal, on_ridge = p.witness_b;
  }
  if (uncertainty > 1e-6 * difference.size()) sink.mark_degenerate();
  gap -= body.sweep;
  const Vec3 n = -(body.pose.orientation * normal);
  const Vec3 x = body.pose.position + body.pose.orientation * on_ridge;
  return {x + 0.5 * gap * n, n, gap, mesh_feature(at.triangle, 7u << 24)};
}

}  // namespace

void collide_ridges(const CoreNearMesh& body, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                    std::span<const char> spoke, std::span<const BarredTriangle> barred, std::vector<MeshPoint>& out,
                    ContactSink& sink) {
  static thread_local Ridge ridge;  // keep their size
  static thread_local std::vector<BarredTriangle> settled;
  settled.clear();
  for (const BarredTriangle& b : barred) {
    const auto touches = [&](std::uint32_t t) { return t == b.triangle || lies_on(mesh, t, b.point, body.tolerance); };
    bool known = false;
    for (std::size_t k = 0; k < triangles.size(); ++k) known = known || (spoke[k] && touches(triangles[k]));
    for (const BarredTriangle& s : settled)  // one contact for the triangles of a ridge
      known = known || share_a_corner(mesh.triangles[s.triangle], mesh.triangles[b.triangle]);
    if (known) continue;
    settled.push_back(b);
    gather(body, mesh, triangles, b, ridge);
    const MeshPoint p = leave(body, ridge, b, sink);
    if (p.gap < body.reach) out.push_back(p);
  }
}

}  // namespace epafi
