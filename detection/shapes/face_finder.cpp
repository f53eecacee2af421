#include "detection/shapes/face_finder.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>

namespace epafi {
namespace {

/// Moves a corner into the planes that meet there: the least way that takes all of them, but for directions in which
/// they hardly differ.
Vec3 moved_into(const std::vector<const FacePlane*>& planes, const Vec3& x) {
  constexpr double differs = 0.02;  // about 0.2 rad between planes: a corner moves at most 7 times as far as it was off
  Mat3 normals = Mat3::Zero();
  Vec3 off = Vec3::Zero();
  for (const FacePlane* p : planes) {
    normals += p->normal * p->normal.transpose();
    off += p->height(x) * p->normal;
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(normals);
  Vec3 out = x;
  for (int k = 0; k < 3; ++k) {
    const Vec3 q = solver.eigenvectors().col(k);
    if (solver.eigenvalues()[k] > differs) out -= q.dot(off) / solver.eigenvalues()[k] * q;
  }
  return out;
}

}  // namespace

FaceFinder::FaceFinder(const TriangleSurface& surface, double tolerance)
    : surface_(surface), around_(surface.triangles), tolerance_(tolerance) {
  const auto count = static_cast<std::uint32_t>(surface_.triangles.size());
  std::vector<double> area(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Triangle& c = surface_.triangles[t];
    area[t] = (surface_.vertices[c[1]] - surface_.vertices[c[0]])
                  .cross(surface_.vertices[c[2]] - surface_.vertices[c[0]])
                  .squaredNorm();
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return area[a] > area[b]; });
  face.assign(count, unknown);
  for (const std::uint32_t first : order)
    if (face[first] == unknown) grow(first);
}

void FaceFinder::grow(std::uint32_t first) {
  const auto self = static_cast<std::uint32_t>(planes.size());
  FacePlane plane = plane_of(surface_, surface_.triangles[first]);
  members_.assign(1, first);
  face[first] = self;
  std::size_t fit_at = 2;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    around_.each(members_[k], [&](std::uint32_t t) {
      if (face[t] != unknown || !lies_in(plane, t)) return;
      face[t] = self;
      members_.push_back(t);
    });
    if (members_.size() < fit_at) continue;
    plane = fitted(plane);
    fit_at = 2 * members_.size();
  }
  planes.push_back(members_.size() > 1 ? fitted(plane) : plane);
  size.push_back(static_cast<std::uint32_t>(members_.size()));
}

bool FaceFinder::lies_in(const FacePlane& plane, std::uint32_t t) const {
  const Triangle& c = surface_.triangles[t];
  if (!(plane_of(surface_, c).normal.dot(plane.normal) > 0.0)) return false;  // folded back: a blade
  return std::all_of(c.begin(), c.end(),
                     [&](std::uint32_t v) { return std::abs(plane.height(surface_.vertices[v])) <= tolerance_; });
}

FacePlane FaceFinder::fitted(const FacePlane& before) const {
  Vec3 mean = Vec3::Zero();
  for (const std::uint32_t t : members_)
    for (const std::uint32_t v : surface_.triangles[t]) mean += surface_.vertices[v] - before.point;
  mean /= 3.0 * static_cast<double>(members_.size());
  mean += before.point;
  Mat3 spread = Mat3::Zero();
  for (const std::uint32_t t : members_)
    for (const std::uint32_t v : surface_.triangles[t]) {
      const Vec3 d = surface_.vertices[v] - mean;
      spread += d * d.transpose();
    }
  // of the scatter about the plane before: small entries lose no digits against large ones
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
  const Vec3 n = solver.eigenvectors().col(0);
  return {n.dot(before.normal) < 0.0 ? Vec3(-n) : n, mean};
}

CornerMoves move_into_planes(TriangleSurface& s, const FaceFinder& faces, double rounding) {
  double farthest = 0.0;
  std::vector<std::vector<const FacePlane*>> at(s.vertices.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const FacePlane& plane = faces.planes[faces.face[t]];
    if (faces.size[faces.face[t]] < 2) continue;
    for (const std::uint32_t v : s.triangles[t]) {
      farthest = std::max(farthest, std::abs(plane.height(s.vertices[v])));
      if (std::find(at[v].begin(), at[v].end(), &plane) == at[v].end()) at[v].push_back(&plane);
    }
  }
  CornerMoves moves{farthest <= rounding};
  for (std::size_t v = 0; v < at.size() && !moves.is_exact; ++v) {
    if (at[v].empty()) continue;
    const Vec3 before = s.vertices[v];
    for (int pass = 0; pass < 2; ++pass) s.vertices[v] = moved_into(at[v], s.vertices[v]);
    const double way = (s.vertices[v] - before).norm();
    if (way <= rounding) continue;
    ++moves.count;
    moves.farthest = std::max(moves.farthest, way);
  }
  return moves;
}

}  // namespace epafi
