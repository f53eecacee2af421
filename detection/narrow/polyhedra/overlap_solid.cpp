#include "detection/narrow/polyhedra/overlap_solid.h"

#include <algorithm>
#include <bit>

namespace epafi {
namespace {

double farthest(const PolyhedronView& p, const Vec3& d) { return d.dot(p.vertices[ConvexHull::support_vertex(p, d)]); }

/// Faces with a vertex at `least` or farther along d. plane(f): of face f, in A's axes.
template <class PlaneOf>
void find_layer(const PolyhedronView& p, const Vec3& d, double least, const PlaneOf& plane, Layer& layer) {
  layer.bits.assign((p.face_normals.size() + 63) / 64, 0);
  std::uint64_t first = 0;  // of hulls of up to 64 faces in a register
  for (std::size_t v = 0; v < p.vertices.size(); ++v) {
    const Lanes3& x = p.vertex_lanes[v / lane_count].at;  // in cache since the supports were asked for
    const std::size_t lane = v % lane_count;
    if (d.x() * x.x[lane] + d.y() * x.y[lane] + d.z() * x.z[lane] < least) continue;
    for (std::uint32_t k = p.fan_begin[v]; k < p.fan_begin[v + 1]; ++k) {
      const std::uint64_t bit = std::uint64_t{1} << p.fans[k] % 64;
      if (p.fans[k] < 64)
        first |= bit;
      else
        layer.bits[p.fans[k] / 64] |= bit;
    }
  }
  layer.bits[0] = first;
  layer.faces.clear();
  layer.planes.clear();
  for (std::size_t w = 0; w < layer.bits.size(); ++w) {
    for (std::uint64_t rest = layer.bits[w]; rest != 0; rest &= rest - 1) {
      const auto f = static_cast<std::uint32_t>(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
      layer.faces.push_back(f);
      layer.planes.append(plane(f));
    }
  }
  layer.done.assign(layer.faces.size(), 0);
}

void measure(const ClippedSolid& solid, Layer& layer) { solid.ranges(layer.planes, layer.low, layer.high); }

/// Cuts by the plane that takes away the highest point, as long as there is one: few of the others cut then.
bool clip_by(Layer& layer, ClippedSolid& solid) {
  for (;;) {
    measure(solid, layer);
    std::size_t first = layer.faces.size();
    double highest = 0.0;
    for (std::size_t k = 0; k < layer.faces.size(); ++k) {
      if (!(layer.low[k] < 0.0)) return false;
      if (!layer.done[k] && layer.high[k] > highest) {
        highest = layer.high[k];
        first = k;
      }
    }
    if (first == layer.faces.size()) return true;
    layer.done[first] = 1;
    if (!solid.clip(layer.planes[first])) return false;
  }
}

/// The plane of a face that is in the layer, from now on done.
Plane take(Layer& layer, std::uint32_t face) {
  const auto k = static_cast<std::size_t>(std::ranges::lower_bound(layer.faces, face) - layer.faces.begin());
  layer.done[k] = 1;
  return layer.planes[k];
}

struct Line {
  Vec3 from, along;
  Vec3 at(const Plane& plane) const { return from - plane.above(from) / plane.normal.dot(along) * along; }
};

/// Where two edges cross, the four planes beside them enclose a tetrahedron of which the overlap is all or a part.
/// False where they do not, or not near the bodies: then nothing is changed.
bool between_edges(const PolyhedronPair& pair, const SeparatingAxis& axis, OverlapSolid& out) {
  const HullEdge &ea = pair.a.edges[axis.feature_a], &eb = pair.b.edges[axis.feature_b];
  const auto has = [](const Layer& layer, std::uint32_t face) { return std::ranges::binary_search(layer.faces, face); };
  if (!has(out.a, ea.left) || !has(out.a, ea.right) || !has(out.b, eb.left) || !has(out.b, eb.right)) return false;
  const Plane left_a = take(out.a, ea.left), right_a = take(out.a, ea.right);
  const Plane left_b = take(out.b, eb.left), right_b = take(out.b, eb.right);
  const Vec3 on_a = pair.a.vertices[ea.from], on_b = pair.vertex_b(eb.from);
  const Line a{on_a, pair.a.vertices[ea.to] - on_a}, b{on_b, pair.vertex_b(eb.to) - on_b};
  const std::array<Vec3, 4> x{a.at(left_b), a.at(right_b), b.at(left_a), b.at(right_a)};
  bool encloses =
      right_b.above(x[0]) < 0.0 && left_b.above(x[1]) < 0.0 && right_a.above(x[2]) < 0.0 && left_a.above(x[3]) < 0.0;
  for (const Vec3& p : x) encloses = encloses && p.squaredNorm() < 4.0 * pair.a.radius * pair.a.radius;
  if (encloses)
    out.solid.assign_tetrahedron(x);
  else {
    std::ranges::fill(out.a.done, 0);
    std::ranges::fill(out.b.done, 0);
  }
  return encloses;
}

/// Closes a solid of the faces of a layer: by the cap, a plane beyond which the bodies have nothing in common, or at
/// once by the other body's face that looks most along the cap's normal, where it takes away all that the cap does.
/// That is a cut less for most stones that meet at a corner.
bool close(const Plane& cap, Layer& other, ClippedSolid& solid) {
  std::size_t first = 0;
  double most = -infinity;
  for (std::size_t k = 0; k < other.faces.size(); ++k) {
    const double along = cap.normal.dot(other.planes[k].normal);
    if (along > most) {
      most = along;
      first = k;
    }
  }
  const Plane face = other.planes[first];
  for (std::size_t i = 0; i < solid.points(); ++i)
    if (cap.above(solid.point(i)) > 0.0 && !(face.above(solid.point(i)) > 0.0)) return solid.clip(cap);
  other.done[first] = 1;
  return solid.clip(face);
}

/// The fewer faces are cut by the others.
bool cut_one_by_other(const PolyhedronPair& pair, const Vec3& n, double cap_a, double cap_b, OverlapSolid& out) {
  if (out.a.faces.size() <= out.b.faces.size()) {
    out.solid.assign(pair.a, out.a.faces, Mat3::Identity(), Vec3::Zero());
    return close({-n, -cap_a}, out.b, out.solid) && clip_by(out.b, out.solid);
  }
  out.solid.assign(pair.b, out.b.faces, pair.rotation, pair.offset);
  return close({n, cap_b}, out.a, out.solid) && clip_by(out.a, out.solid);
}

}  // namespace

bool intersect(const PolyhedronPair& pair, const SeparatingAxis& axis, OverlapSolid& out) {
  const Vec3 &n = axis.normal, n_in_b = pair.rotation.transpose() * n;
  const double top_a = farthest(pair.a, n), top_b = farthest(pair.b, -n_in_b);
  const double bottom_b = n.dot(pair.offset) - top_b, depth = top_a - bottom_b;
  if (!(depth > 0.0)) return false;
  // twice the depth, and what rounding may hide; the cap clears vertices not in the layer by more than rounding
  const double slack = 1e-14 * (pair.a.radius + pair.b.radius), reach = 2.0 * depth + slack,
               cap = 1.5 * depth + 0.5 * slack;
  const auto plane_a = [&](std::uint32_t f) { return Plane{pair.a.face_normals[f], pair.a.face_offsets[f]}; };
  const auto plane_b = [&](std::uint32_t f) {
    const Vec3 normal = pair.rotation * pair.b.face_normals[f];
    return Plane{normal, pair.b.face_offsets[f] + normal.dot(pair.offset)};
  };
  find_layer(pair.a, n, top_a - reach, plane_a, out.a);
  find_layer(pair.b, -n_in_b, top_b - reach, plane_b, out.b);
  const bool left = axis.kind == SeparatingAxis::Kind::edges && between_edges(pair, axis, out)
                        ? clip_by(out.a, out.solid) && clip_by(out.b, out.solid)
                        : cut_one_by_other(pair, n, top_a - cap, bottom_b + cap, out);
  if (left) {
    measure(out.solid, out.a);
    measure(out.solid, out.b);
  }
  return left;
}

}  // namespace epafi
