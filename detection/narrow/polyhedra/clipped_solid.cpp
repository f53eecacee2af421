#include "detection/narrow/polyhedra/clipped_solid.h"

#include <algorithm>
#include <cstring>

#include "engine/lanes/lanes.h"

namespace epafi {
namespace {

constexpr std::uint32_t unnamed = 0xffffffffu;

template <class T>
void at_least(std::vector<T>& list, std::size_t size) {
  if (list.size() < size) list.resize(2 * size);
}

using Two = LanesOf<2>::Real;  // fills a register of the baseline; loops over four or five planes gain nothing by more

EPAFI_LANES Two load(const double* p) {
  Two x;
  std::memcpy(&x, p, sizeof x);
  return x;
}

}  // namespace

void PlaneColumns::append(const Plane& p) {
  if (count_ + 2 > x_.size())
    for (std::vector<double>* column : {&x_, &y_, &z_, &offset_}) column->resize(2 * count_ + 16);
  x_[count_] = p.normal.x();
  y_[count_] = p.normal.y();
  z_[count_] = p.normal.z();
  offset_[count_] = p.offset;
  ++count_;
  x_[count_] = y_[count_] = z_[count_] = 0.0;
  offset_[count_] = infinity;
}

/// For the surface that is made next.
void ClippedSolid::make_room(std::size_t points, std::size_t faces, std::size_t corners) {
  at_least(next_.x, points);
  at_least(next_.y, points);
  at_least(next_.z, points);
  at_least(next_.begin, faces + 1);
  at_least(next_.corners, corners);
  next_count_ = 0;
  next_faces_ = 0;
  next_.begin[0] = 0;
}

void ClippedSolid::append(const Vec3& x) {
  next_.x[next_count_] = x.x();
  next_.y[next_count_] = x.y();
  next_.z[next_count_] = x.z();
  ++next_count_;
}

/// What was made next is the surface from now on.
void ClippedSolid::take_next() {
  std::swap(now_, next_);
  count_ = next_count_;
  faces_ = next_faces_;
}

void ClippedSolid::assign(const PolyhedronView& view, const Mat3& rotation, const Vec3& offset) {
  make_room(view.vertices.size(), view.face_normals.size(), view.face_vertices.size());
  for (const Vec3& v : view.vertices) append(rotation * v + offset);
  std::copy(view.face_begin.begin(), view.face_begin.end(), next_.begin.begin());
  std::copy(view.face_vertices.begin(), view.face_vertices.end(), next_.corners.begin());
  next_faces_ = view.face_normals.size();
  take_next();
}

void ClippedSolid::assign(const PolyhedronView& view, std::span<const std::uint32_t> faces, const Mat3& rotation,
                          const Vec3& offset) {
  make_room(view.vertices.size(), faces.size(), view.face_vertices.size());
  new_name_.assign(view.vertices.size(), unnamed);
  std::uint32_t* out = next_.corners.data();
  for (const std::uint32_t f : faces) {
    for (std::uint32_t k = view.face_begin[f]; k < view.face_begin[f + 1]; ++k) {
      const std::uint32_t v = view.face_vertices[k];
      if (new_name_[v] == unnamed) {
        new_name_[v] = static_cast<std::uint32_t>(next_count_);
        append(rotation * view.vertices[v] + offset);
      }
      *out++ = new_name_[v];
    }
    next_.begin[++next_faces_] = static_cast<std::uint32_t>(out - next_.corners.data());
  }
  take_next();
}

void ClippedSolid::assign(const ClippedSolid& other) {
  const Surface& from = other.now_;
  const std::size_t corners = from.begin[other.faces_];
  make_room(other.count_, other.faces_, corners);
  std::copy_n(from.x.begin(), other.count_, next_.x.begin());
  std::copy_n(from.y.begin(), other.count_, next_.y.begin());
  std::copy_n(from.z.begin(), other.count_, next_.z.begin());
  std::copy_n(from.begin.begin(), other.faces_ + 1, next_.begin.begin());
  std::copy_n(from.corners.begin(), corners, next_.corners.begin());
  std::swap(now_, next_);
  count_ = other.count_;
  faces_ = other.faces_;
}

/// Where the edge leaves; each edge is met from both of its faces and gets one point.
std::uint32_t ClippedSolid::crossing(std::uint32_t inside, std::uint32_t outside) {
  const std::uint64_t edge = std::uint64_t{inside} << 32 | outside;
  const std::size_t known = next_count_ - kept_;
  for (std::size_t k = 0; k < known; ++k)
    if (crossings_[k] == edge) return kept_ + static_cast<std::uint32_t>(k);
  const double p = above_[inside], q = above_[outside];  // p <= 0 < q
  const Vec3 from = point(inside);
  append(from + p / (p - q) * (point(outside) - from));
  crossings_[known] = edge;
  cap_next_[known] = unnamed;
  return static_cast<std::uint32_t>(next_count_ - 1);
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
      if (!in)
        open_exit = cut;
      else if (open_exit == unnamed)
        first_entry = cut;
      else {
        cap_next_[cut - kept_] = open_exit;
        open_exit = unnamed;
      }
    }
    if (in) *out++ = name;
    last = corner;
    last_in = in;
  }
  if (first_entry != unnamed) cap_next_[first_entry - kept_] = open_exit;
  return out;
}

/// One face for each closed chain of cuts.
std::uint32_t* ClippedSolid::close_cuts(std::uint32_t* out) {
  for (std::uint32_t start = 0; start < next_count_ - kept_; ++start) {
    std::uint32_t* const face = out;
    for (std::uint32_t p = start; cap_next_[p] != unnamed;) {
      *out++ = p + kept_;
      const std::uint32_t next = cap_next_[p] - kept_;
      cap_next_[p] = unnamed;
      p = next;
    }
    // a cut of two points is no face: the two faces beside it meet there, and an edge must not be listed twice
    if (out < face + 3)
      out = face;
    else
      next_.begin[++next_faces_] = static_cast<std::uint32_t>(out - next_.corners.data());
  }
  return out;
}

void ClippedSolid::ranges(const PlaneColumns& planes, std::vector<double>& low, std::vector<double>& high) const {
  const std::size_t count = planes.size();
  at_least(low, count + 1);
  at_least(high, count + 1);
  for (std::size_t k = 0; k < count; k += 2) {
    const Two x = load(&planes.x_[k]), y = load(&planes.y_[k]), z = load(&planes.z_[k]),
              offset = load(&planes.offset_[k]);
    Two least{infinity, infinity}, most{-infinity, -infinity};
    for (std::size_t i = 0; i < count_; ++i) {
      const Two h = x * now_.x[i] + y * now_.y[i] + z * now_.z[i] - offset;
      least = min(least, h);
      most = max(most, h);
    }
    std::memcpy(&low[k], &least, sizeof least);
    std::memcpy(&high[k], &most, sizeof most);
  }
}

void ClippedSolid::assign_tetrahedron(const std::array<Vec3, 4>& x) {
  make_room(4, 4, 12);
  for (const Vec3& p : x) append(p);
  static constexpr std::array<std::uint32_t, 12> faces{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  static constexpr std::array<std::uint32_t, 12> mirrored{0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
  const bool positive = (x[1] - x[0]).dot((x[2] - x[0]).cross(x[3] - x[0])) > 0.0;
  std::ranges::copy(positive ? faces : mirrored, next_.corners.begin());
  for (std::uint32_t f = 0; f <= 4; ++f) next_.begin[f] = 3 * f;
  next_faces_ = 4;
  take_next();
}

/// Without a branch on the unpredictable side of a point: points not kept are overwritten by the next one.
void ClippedSolid::keep_inside() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    next_.x[kept] = now_.x[i];
    next_.y[kept] = now_.y[i];
    next_.z[kept] = now_.z[i];
    const bool in = !(above_[i] > 0.0);
    new_name_[i] = in ? static_cast<std::uint32_t>(kept) : unnamed;
    kept += in;
  }
  next_count_ = kept;
  kept_ = static_cast<std::uint32_t>(kept);
}

void ClippedSolid::cut() {
  const std::size_t corners = now_.begin[faces_];
  make_room(count_ + corners, 2 * faces_ + 1, 4 * corners);  // each corner may add a cut to its face and one to the cap
  at_least(new_name_, count_);
  at_least(crossings_, corners);
  at_least(cap_next_, corners);
  keep_inside();
  std::uint32_t* out = next_.corners.data();
  for (std::size_t f = 0; f < faces_; ++f) {
    std::uint32_t* const face = out;
    out = cut_face(now_.corners.data() + now_.begin[f], now_.corners.data() + now_.begin[f + 1], out);
    if (out != face) next_.begin[++next_faces_] = static_cast<std::uint32_t>(out - next_.corners.data());
  }
  close_cuts(out);
  take_next();
}

bool ClippedSolid::clip(const Plane& plane) {
  at_least(above_, count_);
  double low = infinity, high = -infinity;
  for (std::size_t i = 0; i < count_; ++i) {
    above_[i] = plane.above(point(i));
    low = std::min(low, above_[i]);
    high = std::max(high, above_[i]);
  }
  if (!(low < 0.0)) return false;
  if (high > 0.0) cut();
  return true;
}

Volume ClippedSolid::volume() const {
  Volume out{point(0)};
  for (std::size_t f = 0; f < faces_; ++f) out.add_cone(face(f), [&](std::uint32_t k) { return point(k); });
  return out;
}

}  // namespace epafi
