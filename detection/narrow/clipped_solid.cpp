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

std::uint32_t ClippedSolid::kept(std::uint32_t vertex) {
  std::uint32_t& name = new_name_[vertex];
  if (name == unnamed) name = static_cast<std::uint32_t>(next_points_.size()), next_points_.push_back(points[vertex]);
  return name;
}

/// Where the edge leaves; each edge is met from both of its faces and gets one point.
std::uint32_t ClippedSolid::crossing(std::uint32_t inside, std::uint32_t outside) {
  for (const Crossing& c : crossings_)
    if (c.inside == inside && c.outside == outside) return c.point;
  const double p = above_[inside], q = above_[outside];  // p <= 0 < q
  const auto name = static_cast<std::uint32_t>(next_points_.size());
  next_points_.push_back(points[inside] + p / (p - q) * (points[outside] - points[inside]));
  crossings_.push_back({inside, outside, name});
  return name;
}

void ClippedSolid::cut_face(std::uint32_t begin, std::uint32_t end) {
  const auto is_in = [&](std::uint32_t k) { return above_[corners_[k]] <= 0.0; };
  std::uint32_t first_entry = unnamed, open_exit = unnamed;
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::uint32_t next = k + 1 == end ? begin : k + 1;
    if (is_in(k)) next_corners_.push_back(kept(corners_[k]));
    if (is_in(k) == is_in(next)) continue;
    if (is_in(k)) {
      open_exit = crossing(corners_[k], corners_[next]);
      next_corners_.push_back(open_exit);
      continue;
    }
    const std::uint32_t entry = crossing(corners_[next], corners_[k]);
    next_corners_.push_back(entry);
    // the face runs exit -> entry along the cut, the cap the other way
    if (open_exit == unnamed) first_entry = entry;
    else cap_next_.resize(std::max<std::size_t>(cap_next_.size(), entry + 1u), unnamed), cap_next_[entry] = open_exit;
    open_exit = unnamed;
  }
  if (first_entry != unnamed && open_exit != unnamed) {
    cap_next_.resize(std::max<std::size_t>(cap_next_.size(), first_entry + 1u), unnamed);
    cap_next_[first_entry] = open_exit;
  }
  if (next_corners_.size() > next_begin_.back()) next_begin_.push_back(static_cast<std::uint32_t>(next_corners_.size()));
}

void ClippedSolid::close_cuts() {
  for (std::uint32_t start = 0; start < cap_next_.size(); ++start) {
    if (cap_next_[start] == unnamed) continue;
    for (std::uint32_t p = start; p < cap_next_.size() && cap_next_[p] != unnamed;) {
      next_corners_.push_back(p);
      const std::uint32_t next = cap_next_[p];
      cap_next_[p] = unnamed;
      p = next;
    }
    next_begin_.push_back(static_cast<std::uint32_t>(next_corners_.size()));
  }
}

bool ClippedSolid::clip(const Plane& plane) {
  above_.resize(points.size());
  double low = infinity, high = -infinity;
  for (std::size_t i = 0; i < points.size(); ++i) {
    above_[i] = plane.above(points[i]);
    low = std::min(low, above_[i]), high = std::max(high, above_[i]);
  }
  if (!(low < 0.0)) return false;
  if (!(high > 0.0)) return true;
  next_points_.clear(), next_corners_.clear(), crossings_.clear(), cap_next_.clear();
  next_begin_.assign(1, 0u);
  new_name_.assign(points.size(), unnamed);
  for (std::size_t f = 0; f + 1 < begin_.size(); ++f) cut_face(begin_[f], begin_[f + 1]);
  close_cuts();
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
