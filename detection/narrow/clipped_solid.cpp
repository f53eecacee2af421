#include "detection/narrow/clipped_solid.h"

#include <algorithm>

namespace epafi {

namespace {
constexpr std::uint32_t unnamed = 0xffffffffu;
}

void ClippedSolid::assign(const PolyhedronView& view, const Mat3& rotation, const Vec3& offset) {
  points.clear();
  for (const Vec3& v : view.vertices) points.push_back(rotation * v + offset);
  begin_.assign(view.face_begin.begin(), view.face_begin.end());
  corners_.assign(view.face_vertices.begin(), view.face_vertices.end());
}

void ClippedSolid::assign(const ClippedSolid& other) {
  points = other.points, begin_ = other.begin_, corners_ = other.corners_;
}

/// Where the edge leaves; each edge is met from both of its faces and gets one point.
std::uint32_t ClippedSolid::crossing(std::uint32_t inside, std::uint32_t outside) {
  for (const Crossing& c : crossings_)
    if (c.inside == inside && c.outside == outside) return c.point;
  const double p = above_[inside], q = above_[outside];  // p <= 0 < q
  const auto name = static_cast<std::uint32_t>(next_points_.size());
  next_points_.push_back(points[inside] + p / (p - q) * (points[outside] - points[inside]));
  crossings_.push_back({inside, outside, name});
  cap_next_.push_back(unnamed);
  return name;
}

/// Writes what is left of the face behind `out`; the end of what was written.
std::uint32_t* ClippedSolid::cut_face(const std::uint32_t* begin, const std::uint32_t* end, std::uint32_t* out) {
  std::uint32_t first_entry = unnamed, open_exit = unnamed, last = *(end - 1);
  bool last_in = new_name_[last] != unnamed;
  for (const std::uint32_t* k = begin; k != end; ++k) {
    const std::uint32_t corner = *k, name = new_name_[corner];
    const bool in = name != unnamed;
    if (in != last_in) {
      const std::uint32_t cut = in ? crossing(corner, last) : crossing(last, corner);
      *out++ = cut;
      // the face runs exit -> entry along the cut, the cap the other way
      if (!in) open_exit = cut;
      else if (open_exit == unnamed) first_entry = cut;
      else cap_next_[cut - kept_] = open_exit, open_exit = unnamed;
    }
    if (in) *out++ = name;
    last = corner, last_in = in;
  }
  if (first_entry != unnamed) cap_next_[first_entry - kept_] = open_exit;
  return out;
}

/// One face for each closed chain of cuts.
std::uint32_t* ClippedSolid::close_cuts(std::uint32_t* out) {
  for (std::uint32_t start = 0; start < cap_next_.size(); ++start) {
    std::uint32_t* const face = out;
    for (std::uint32_t p = start; cap_next_[p] != unnamed;) {
      *out++ = p + kept_;
      const std::uint32_t next = cap_next_[p] - kept_;
      cap_next_[p] = unnamed;
      p = next;
    }
    // a cut of two points is no face: the two faces beside it meet there, and an edge must not be listed twice
    if (out < face + 3) out = face;
    else next_begin_.push_back(static_cast<std::uint32_t>(out - next_corners_.data()));
  }
  return out;
}

bool ClippedSolid::clip(const Plane& plane) {
  const std::size_t count = points.size();
  above_.resize(count);
  double low = infinity, high = -infinity;
  for (std::size_t i = 0; i < count; ++i) {
    above_[i] = plane.above(points[i]);
    low = std::min(low, above_[i]), high = std::max(high, above_[i]);
  }
  if (!(low < 0.0)) return false;
  if (!(high > 0.0)) return true;
  next_points_.clear(), crossings_.clear(), cap_next_.clear();
  new_name_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    new_name_[i] = above_[i] > 0.0 ? unnamed : static_cast<std::uint32_t>(next_points_.size());
    if (new_name_[i] != unnamed) next_points_.push_back(points[i]);
  }
  kept_ = static_cast<std::uint32_t>(next_points_.size());
  next_begin_.assign(1, 0u);
  next_corners_.resize(4 * corners_.size());  // each corner may add a cut to its face and one to the cap
  std::uint32_t* out = next_corners_.data();
  for (std::size_t f = 0; f + 1 < begin_.size(); ++f) {
    std::uint32_t* const face = out;
    out = cut_face(corners_.data() + begin_[f], corners_.data() + begin_[f + 1], out);
    if (out != face) next_begin_.push_back(static_cast<std::uint32_t>(out - next_corners_.data()));
  }
  out = close_cuts(out);
  next_corners_.resize(static_cast<std::size_t>(out - next_corners_.data()));
  points.swap(next_points_), begin_.swap(next_begin_), corners_.swap(next_corners_);
  return true;
}

Volume ClippedSolid::volume() const {
  Volume out;
  Vec3 moment = Vec3::Zero();
  const Vec3 origin = points.front();
  for (std::size_t f = 0; f + 1 < begin_.size(); ++f) {
    const Vec3 p = points[corners_[begin_[f]]] - origin;
    for (std::uint32_t k = begin_[f] + 1; k + 1 < begin_[f + 1]; ++k) {
      const Vec3 q = points[corners_[k]] - origin, r = points[corners_[k + 1]] - origin;
      const double six_fold = p.dot(q.cross(r));
      out.volume += six_fold, moment += six_fold * (p + q + r);
    }
  }
  if (out.volume > 0.0) out.centroid = origin + moment / (4.0 * out.volume);
  out.volume /= 6.0;
  return out;
}

}  // namespace epafi
