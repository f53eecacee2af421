#include "detection/narrow/polyhedra/overlap_faces.h"

#include <algorithm>
#include <optional>

#include "detection/narrow/polyhedra/clipped_solid.h"

namespace epafi {
namespace {

constexpr std::size_t most_faces = NearFaces::most;
// Over twice the bound. A set is accepted if all its faces are within the first value and all others beyond the last,
// so that rounding cannot make two sets acceptable; searches use the middle.
constexpr double within = 1.9, middle = 1.95, beyond = 2.0;

/// A convex polygon of a fixed room. Each cut adds one corner at most, and a facet is cut by the planes of both bodies.
struct SmallPolygon {
  static constexpr std::size_t most = 32, most_of_facet = most - 2 * most_faces;
  std::size_t count = 0;
  std::array<Vec3, most> corner;
  std::uint32_t own = 0;  ///< bits: corners that no cut has made
  std::size_t size() const { return count; }
  const Vec3& operator[](std::size_t k) const { return corner[k]; }
  void assign(const SmallPolygon& from) {
    count = from.count;
    own = from.own;
    std::copy_n(from.corner.begin(), count, corner.begin());
  }
};

/// What is left of the polygon below the plane: itself where that is all, or `other`.
const SmallPolygon* cut(const Plane& plane, const SmallPolygon* from, SmallPolygon& other) {
  std::array<double, SmallPolygon::most> above;
  double lowest = infinity, highest = -infinity;
  for (std::size_t k = 0; k < from->count; ++k) {
    above[k] = plane.above(from->corner[k]);
    lowest = std::min(lowest, above[k]);
    highest = std::max(highest, above[k]);
  }
  if (!(highest > 0.0)) return from;
  other.count = 0;
  other.own = 0;
  if (!(lowest < 0.0)) return &other;
  std::size_t last = from->count - 1;
  for (std::size_t k = 0; k < from->count; last = k++) {
    if ((above[k] > 0.0) != (above[last] > 0.0))
      other.corner[other.count++] =
          from->corner[last] + above[last] / (above[last] - above[k]) * (from->corner[k] - from->corner[last]);
    if (above[k] > 0.0) continue;
    other.own |= (from->own >> k & 1) << other.count;
    other.corner[other.count++] = from->corner[k];
  }
  return &other;
}

/// Cuts by many planes in turn.
class Cutter {
 public:
  /// The polygon that is left, valid until the next one. but: a plane left out.
  template <class PlaneOf>
  const SmallPolygon& run(const SmallPolygon& from, std::size_t planes, const PlaneOf& plane,
                          std::size_t but = most_faces) {
    const SmallPolygon* left = &from;
    for (std::size_t j = 0; j < planes && left->count > 2; ++j)
      if (j != but) left = cut(plane(j), left, left == &spare_[0] ? spare_[1] : spare_[0]);
    return *left;
  }

 private:
  std::array<SmallPolygon, 2> spare_;
};

/// The near faces of one body, in A's axes.
struct Side {
  std::size_t count = 0;
  std::array<std::uint32_t, most_faces> face;
  std::array<Plane, most_faces> plane;
  std::array<SmallPolygon, most_faces> facet;  ///< of the overlap
  Vec3 apex;                                   ///< on all planes
  Vec3 along;                                  ///< of an edge that is on all planes, unit; 0: the apex alone
  /// The apex nearest to x: cells far smaller than the overlap keep their digits.
  Vec3 apex_near(const Vec3& x) const { return apex + along.dot(x - apex) * along; }
};

struct FaceScratch {
  Side a, b;
  Cutter cutter;
  std::vector<Vec3> corners, in_b;
  std::vector<double> highest;  ///< by face: of a corner above it [m]
};
FaceScratch& face_scratch() {
  static thread_local FaceScratch s;  // results do not depend on it
  return s;
}

/// What all the faces share, in the body's axes: an edge of two faces, or a vertex. False where there is nothing.
bool find_apex(const PolyhedronView& p, Side& side) {
  const std::span<const std::uint32_t> wanted{side.face.data(), side.count};
  const auto bits = [](std::span<const std::uint32_t> faces) {
    std::uint64_t out = 0;
    for (const std::uint32_t f : faces) out |= std::uint64_t{1} << f % 64;
    return out;
  };
  const std::uint64_t wanted_bits = bits(wanted);
  const auto shared = [&](std::uint32_t v) {
    const auto fan = p.fans.subspan(p.fan_begin[v], p.fan_begin[v + 1] - p.fan_begin[v]);
    if ((wanted_bits & ~bits(fan)) != 0) return false;  // so for nearly all that do not have them
    return std::ranges::all_of(wanted, [&](std::uint32_t f) { return std::ranges::find(fan, f) != fan.end(); });
  };
  const std::uint32_t first = side.face[0];
  std::size_t found = 0;
  for (std::uint32_t k = p.face_begin[first]; k < p.face_begin[first + 1]; ++k) {
    const Vec3& x = p.vertices[p.face_vertices[k]];
    if (!shared(p.face_vertices[k])) continue;
    if (found++ == 0) {
      side.apex = x;
      side.along.setZero();
    } else
      side.along = (x - side.apex).normalized();
  }
  return found > 0;
}

/// place(x): of the body's own axes, turn(n): of its directions.
template <class Place, class Turn>
bool take_faces(const PolyhedronView& p, std::span<const std::uint16_t> faces, const Place& place, const Turn& turn,
                Side& side) {
  side.count = faces.size();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t f = side.face[i] = faces[i];
    if (!(f < p.face_normals.size())) return false;  // of another part of the body
    const std::uint32_t begin = p.face_begin[f], count = p.face_begin[f + 1] - begin;
    if (count > SmallPolygon::most_of_facet) return false;
    const Vec3 normal = turn(p.face_normals[f]);
    SmallPolygon& polygon = side.facet[i];
    polygon.count = count;
    polygon.own = (1u << count) - 1;
    for (std::uint32_t k = 0; k < count; ++k) polygon.corner[k] = place(p.vertices[p.face_vertices[begin + k]]);
    side.plane[i] = {normal, p.face_offsets[f] + normal.dot(place(Vec3::Zero()))};
  }
  return true;
}

/// Corners that a cut has made are edges of one body in faces of the other: both bodies' facets have them. made: they
/// are wanted.
void cut_facets(Side& own, const Side& other, bool made, FaceScratch& s) {
  for (std::size_t i = 0; i < own.count; ++i) {
    const SmallPolygon& left = s.cutter.run(own.facet[i], other.count, [&](std::size_t j) { return other.plane[j]; });
    if (left.count < 3)
      own.facet[i].count = 0;
    else if (&left != &own.facet[i])
      own.facet[i].assign(left);
    const SmallPolygon& facet = own.facet[i];
    for (std::size_t k = 0; k < facet.count; ++k)
      if (made || (facet.own >> k & 1)) s.corners.push_back(facet.corner[k]);
  }
}

/// The faces are all that come near the overlap, and all of them do. in_own: its corners in the body's axes.
bool are_near(const PolyhedronView& view, const Side& side, std::span<const Vec3> corners, std::span<const Vec3> in_own,
              double least) {
  std::array<double, most_faces> nearest;
  double bound = infinity;
  for (std::size_t i = 0; i < side.count; ++i) {
    double low = infinity, high = -infinity;
    for (const Vec3& x : corners) {
      const double above = side.plane[i].above(x);
      low = std::min(low, above);
      high = std::max(high, above);
    }
    nearest[i] = -high;
    bound = std::min(bound, -low);
  }
  if (!(bound > least)) return false;
  for (std::size_t i = 0; i < side.count; ++i)
    if (!(nearest[i] < within * bound)) return false;
  return hull_kernels().all_below(view.face_lanes, in_own, -beyond * bound, {side.face.data(), side.count});
}

/// A sum of cones over parts of planes. Of a flat overlap the corners of a cone are nearly in one plane with its apex:
/// base times height keeps the digits that a triple product would lose.
struct Cones {
  Vec3 apex;
  double volume = 0.0, depth = 0.0;  ///< depth: below `own` of the centroid, times the volume
  Vec3 moment = Vec3::Zero();        ///< about the apex

  /// own: a plane through the apex.
  void add(const SmallPolygon& base, const Plane& plane, const Plane& own) {
    const double height = -plane.above(apex);
    const Vec3& p = base[0];
    for (std::size_t k = 2; k < base.size(); ++k) {
      const Vec3 &q = base[k - 1], &r = base[k];
      const double of_tetrahedron = height * plane.normal.dot((q - p).cross(r - p)) / 6.0;
      volume += of_tetrahedron;
      depth -= 0.25 * of_tetrahedron * (own.above(p) + own.above(q) + own.above(r));
      moment += 0.25 * of_tetrahedron * ((p - apex) + (q - apex) + (r - apex));
    }
  }
  /// Leaves out a cell; `depth` is no longer meant.
  void take(const Cones& cell) {
    volume -= cell.volume;
    moment -= cell.moment + cell.volume * (cell.apex - apex);
  }
};

/// Cones from far off lose the digits of the overlap's own size.
bool is_at_hand(const Side& side, std::span<const Vec3> corners) {
  constexpr double far = 8.0;  // extents; errors grow by as much
  double extent = 0.0;
  for (const Vec3& x : corners) extent = std::max(extent, (x - corners[0]).squaredNorm());
  return (side.apex_near(corners[0]) - corners[0]).squaredNorm() <= far * far * extent;
}

/// The part of the overlap where near plane order[k] is the nearest; nothing where it has no volume.
std::optional<Cones> cell_of(std::size_t k, std::span<const std::size_t> order, const Side& own, const Side& other,
                             FaceScratch& s) {
  const Plane& nearest = own.plane[order[k]];
  const auto bisector = [&](std::size_t j) -> Plane {
    const Plane& p = own.plane[order[j]];
    return {p.normal - nearest.normal, p.offset - nearest.offset};
  };
  std::optional<Cones> cell;
  for (std::size_t f = 0; f < other.count; ++f) {
    if (other.facet[f].count == 0) continue;
    const SmallPolygon& part = s.cutter.run(other.facet[f], order.size(), bisector, k);
    if (part.count < 3) continue;
    if (!cell) cell = Cones{own.apex_near(part[0])};
    cell->add(part, other.plane[f], nearest);
  }
  return cell;
}

/// All of the overlap, from an apex on all own planes.
Cones whole_of(const Side& own, const Side& other) {
  std::optional<Cones> whole;
  for (std::size_t f = 0; f < other.count; ++f) {
    if (other.facet[f].count == 0) continue;
    if (!whole) whole = Cones{own.apex_near(other.facet[f][0])};
    whole->add(other.facet[f], other.plane[f], own.plane[0]);
  }
  return whole ? *whole : Cones{own.apex};
}

/// The near plane that is the nearest at x comes first, the others as they are.
std::array<std::size_t, most_faces> nearest_first(const Side& own, const Vec3& x) {
  std::array<std::size_t, most_faces> order;
  for (std::size_t i = 0; i < own.count; ++i) order[i] = i;
  const auto higher = [&](std::size_t i, std::size_t j) { return own.plane[i].above(x) < own.plane[j].above(x); };
  const auto first = std::max_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(own.count), higher);
  std::rotate(order.begin(), first, first + 1);
  return order;
}

/// The field of one body. The cell that has the overlap's centroid, mostly the largest, is what the others leave, and
/// most of them goes with the first cut, the one against it. False where a cell is as thin as rounding.
bool add_field(const Side& own, const Side& other, bool of_a, double least, FaceScratch& s,
               std::vector<OverlapCell>& out) {
  Cones rest = whole_of(own, other);
  const double sure = least_rest * rest.volume;
  if (!(rest.volume > 0.0)) return false;
  const auto all = nearest_first(own, rest.apex + rest.moment / rest.volume);
  const std::span<const std::size_t> order{all.data(), own.count};
  const auto add = [&](std::size_t k, const Cones& cell) {
    if (!(cell.volume > 0.0) || !(cell.depth > least * cell.volume)) return false;
    const Vec3 centroid = cell.apex + cell.moment / cell.volume;
    out.push_back({of_a, own.face[order[k]], cell.volume, cell.depth / cell.volume, centroid});
    return true;
  };
  for (std::size_t k = 1; k < order.size(); ++k) {
    const auto cell = cell_of(k, order, own, other, s);
    if (!cell) continue;
    if (!add(k, *cell)) return false;
    rest.take(*cell);
  }
  if (!(rest.volume > sure)) {
    const auto cell = cell_of(0, order, own, other, s);
    return !cell || add(0, *cell);
  }
  rest.depth = -own.plane[order[0]].normal.dot(rest.moment);  // the apex lies on the plane
  return add(0, rest);
}

/// Of one body; corners in its axes. False where there are too many.
bool collect_near(const PolyhedronView& p, std::span<const Vec3> corners, FaceScratch& s, std::uint8_t& count,
                  std::array<std::uint16_t, most_faces>& out) {
  double bound = infinity;
  s.highest.clear();
  for (std::size_t f = 0; f < p.face_normals.size(); ++f) {
    double low = infinity, high = -infinity;
    for (const Vec3& x : corners) {
      const double above = p.face_normals[f].dot(x) - p.face_offsets[f];
      low = std::min(low, above);
      high = std::max(high, above);
    }
    bound = std::min(bound, -low);
    s.highest.push_back(high);
  }
  count = 0;
  for (std::size_t f = 0; f < p.face_normals.size(); ++f) {
    if (!(-s.highest[f] < middle * bound)) continue;
    if (count == most_faces || f > 0xffffu) return false;
    out[count++] = static_cast<std::uint16_t>(f);
  }
  return true;
}

}  // namespace

NearFaces near_faces(const PolyhedronPair& pair, std::span<const Vec3> corners) {
  NearFaces out;
  FaceScratch& s = face_scratch();
  s.in_b.clear();
  for (const Vec3& x : corners) s.in_b.push_back(pair.rotation.transpose() * (x - pair.offset));
  const bool few =
      collect_near(pair.a, corners, s, out.count_a, out.a) && collect_near(pair.b, s.in_b, s, out.count_b, out.b);
  const bool written_down = std::min(out.count_a, out.count_b) < 2 || std::max(out.count_a, out.count_b) < 3;
  if (!few || written_down) out.count_a = out.count_b = 0;
  return out;
}

bool find_cells(const PolyhedronPair& pair, const NearFaces& near, std::vector<OverlapCell>& out) {
  if (near.count_a == 0) return false;
  FaceScratch& s = face_scratch();
  const Mat3 back = pair.rotation.transpose();
  const auto turn = [&](const Vec3& n) -> Vec3 { return pair.rotation * n; };
  const auto place = [&](const Vec3& x) -> Vec3 { return pair.rotation * x + pair.offset; };
  const auto same = [](const Vec3& x) { return x; };
  if (!take_faces(pair.a, {near.a.data(), near.count_a}, same, same, s.a)) return false;
  if (!take_faces(pair.b, {near.b.data(), near.count_b}, place, turn, s.b)) return false;
  if (!find_apex(pair.a, s.a) || !find_apex(pair.b, s.b)) return false;
  s.b.apex = place(s.b.apex);
  s.b.along = turn(s.b.along);
  s.corners.clear();
  s.in_b.clear();
  const bool fewer_of_a = s.a.count < s.b.count;
  cut_facets(s.a, s.b, fewer_of_a, s);
  cut_facets(s.b, s.a, !fewer_of_a, s);
  if (s.corners.empty()) return false;
  for (const Vec3& x : s.corners) s.in_b.push_back(back * (x - pair.offset));
  const double least = thinnest_cell * (pair.a.radius + pair.b.radius);
  if (!are_near(pair.a, s.a, s.corners, s.corners, least) || !are_near(pair.b, s.b, s.corners, s.in_b, least))
    return false;
  if (!is_at_hand(s.a, s.corners) || !is_at_hand(s.b, s.corners)) return false;
  out.clear();
  return add_field(s.a, s.b, true, least, s, out) && add_field(s.b, s.a, false, least, s, out);
}

}  // namespace epafi
