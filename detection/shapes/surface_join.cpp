#include "detection/shapes/surface_join.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "detection/aabb.h"
#include "detection/shapes/surface_weld.h"

namespace epafi {
namespace {

constexpr std::uint32_t unknown = 0xffffffffu;

struct Plane {
  Vec3 normal;
  Vec3 point;
  double height(const Vec3& x) const { return normal.dot(x - point); }
};

Plane plane_of(const TriangleSurface& s, const Triangle& t) {
  const Vec3 &a = s.vertices[t[0]], &b = s.vertices[t[1]], &c = s.vertices[t[2]];
  return {(b - a).cross(c - a).normalized(), a};
}

/// The triangles behind the sides of each, however many share a side.
class Neighbourhood {
 public:
  explicit Neighbourhood(const std::vector<Triangle>& triangles) : uses_(sorted_edge_uses(triangles)) {
    run_.resize(triangles.size());
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
      while (end < uses_.size() && uses_[end].edge() == uses_[begin].edge()) ++end;
      for (std::size_t k = begin; k < end; ++k) run_[uses_[k].triangle][uses_[k].side] = {begin, end};
    }
  }
  template <class F>
  void each(std::uint32_t t, const F& f) const {
    for (const auto& [begin, end] : run_[t])
      for (std::size_t k = begin; k < end; ++k)
        if (uses_[k].triangle != t) f(uses_[k].triangle);
  }

 private:
  std::vector<EdgeUse> uses_;
  std::vector<std::array<std::pair<std::size_t, std::size_t>, 3>> run_;
};

/// Gathers triangles to faces, beginning with the largest.
class FaceFinder {
 public:
  FaceFinder(const TriangleSurface& surface, double tolerance)
      : surface_(surface), around_(surface.triangles), tolerance_(tolerance) {}

  void find() {
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

  std::vector<std::uint32_t> face;  ///< by triangle: which of the planes
  std::vector<Plane> planes;
  std::vector<std::uint32_t> size;  ///< of each face: its triangles

 private:
  void grow(std::uint32_t first) {
    const auto self = static_cast<std::uint32_t>(planes.size());
    Plane plane = plane_of(surface_, surface_.triangles[first]);
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
  bool lies_in(const Plane& plane, std::uint32_t t) const {
    const Triangle& c = surface_.triangles[t];
    if (!(plane_of(surface_, c).normal.dot(plane.normal) > 0.0)) return false;  // folded back: a blade
    return std::all_of(c.begin(), c.end(),
                       [&](std::uint32_t v) { return std::abs(plane.height(surface_.vertices[v])) <= tolerance_; });
  }
  /// Through the members' corners, least squares.
  Plane fitted(const Plane& before) const {
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

  const TriangleSurface& surface_;
  Neighbourhood around_;
  double tolerance_;
  std::vector<std::uint32_t> members_;
};

/// Moves a corner into the planes that meet there: the least way that takes all of them, but for directions in which
/// they hardly differ.
Vec3 moved_into(const std::vector<const Plane*>& planes, const Vec3& x) {
  constexpr double differs = 0.02;  // about 0.2 rad between planes: a corner moves at most 7 times as far as it was off
  Mat3 normals = Mat3::Zero();
  Vec3 off = Vec3::Zero();
  for (const Plane* p : planes) {
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

/// Moves corners where some face is not plane to rounding. Normals stay those of the triangles where all are.
void flatten(JoinedSurface& joined, const FaceFinder& faces, double rounding) {
  TriangleSurface& s = joined.surface;
  double farthest = 0.0;
  std::vector<std::vector<const Plane*>> at(s.vertices.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const Plane& plane = faces.planes[faces.face[t]];
    if (faces.size[faces.face[t]] < 2) continue;
    for (const std::uint32_t v : s.triangles[t]) {
      farthest = std::max(farthest, std::abs(plane.height(s.vertices[v])));
      if (std::find(at[v].begin(), at[v].end(), &plane) == at[v].end()) at[v].push_back(&plane);
    }
  }
  const bool exact = farthest <= rounding;
  for (std::size_t v = 0; v < at.size() && !exact; ++v) {
    if (at[v].empty()) continue;
    const Vec3 before = s.vertices[v];
    for (int pass = 0; pass < 2; ++pass) s.vertices[v] = moved_into(at[v], s.vertices[v]);
    const double way = (s.vertices[v] - before).norm();
    if (way <= rounding) continue;
    ++joined.report.moved;
    joined.report.move_distance = std::max(joined.report.move_distance, way);
  }
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const std::uint32_t f = faces.face[t];
    joined.normals.push_back(exact || faces.size[f] < 2 ? plane_of(s, s.triangles[t]).normal : faces.planes[f].normal);
  }
}

}  // namespace

std::string JoinReport::to_string() const {
  std::string text;
  const auto add = [&](const std::string& sentence) { text.append(text.empty() ? "" : ", ").append(sentence); };
  if (welded > 0) add(fmt::format("{} corners joined with others up to {:.2g} m away", welded, weld_distance));
  if (doubled > 0) add(fmt::format("{} triangles given twice left out", doubled));
  if (slivers > 0) add(fmt::format("{} triangles lower than that left out", slivers));
  if (cut > 0) add(fmt::format("{} cuts at corners that lie on a side", cut));
  if (flipped > 0) add(fmt::format("{} triangles turned over", flipped));
  if (moved > 0)
    add(fmt::format("{} corners moved into the planes of their faces by up to {:.2g} m", moved, move_distance));
  return text.empty() ? text : fmt::format("joined within {:.2g} m: {}", tolerance, text);
}

JoinedSurface join_surface(TriangleSurface surface, double precision) {
  JoinedSurface joined;
  JoinReport& report = joined.report;
  Aabb box;
  double largest = 0.0;
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t v : t) {
      box.include(surface.vertices[v]);
      largest = std::max(largest, surface.vertices[v].cwiseAbs().maxCoeff());
    }
  const double size = box.extent().norm();
  report.tolerance = std::max(join_tolerance * size, 4.0 * precision);
  report.flatness = std::max(flat_tolerance * size, 4.0 * precision);
  weld_corners(surface, report);
  // corners that are one tell how far all are off
  report.flatness = std::max(report.flatness, 2.0 * report.weld_distance);
  drop_slivers(surface, report);
  cut_at_corners(surface, report);
  turn_alike(surface, report);
  FaceFinder faces(surface, report.flatness);
  faces.find();
  joined.surface = std::move(surface);
  flatten(joined, faces, 1e-14 * largest);
  std::vector<std::uint32_t> lowest(faces.planes.size(), unknown);
  for (std::uint32_t t = 0; t < faces.face.size(); ++t) {
    lowest[faces.face[t]] = std::min(lowest[faces.face[t]], t);
    joined.face.push_back(lowest[faces.face[t]]);
  }
  report.faces = faces.planes.size();
  return joined;
}

}  // namespace epafi
