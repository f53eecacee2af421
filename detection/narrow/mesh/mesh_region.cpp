#include "detection/narrow/mesh/mesh_region.h"

#include <algorithm>
#include <cmath>

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/mesh/triangle_core.h"

namespace epafi {
namespace {

constexpr double not_rising = 1e-9;  // [rad] far below what a normal can feel, far above rounding
constexpr double blunt = 1e-4;       // [rad] an edge that bends less does not end a rim
constexpr double same_distance = 1e-9, half_turn = 3.14159265358979323846;

/// x rises above the plane.
bool is_above(const PlacedCore& body, const RegionPlane& plane, const Vec3& x) {
  const Vec3 w = x - plane.point;
  return plane.normal.dot(w) > body.tolerance + not_rising * w.norm();
}

/// The triangles around a place, gathered to a region: the first in any case, rounded slivers lie around notches.
class Gathering {
 public:
  Gathering(const PlacedCore& body, std::span<const std::uint32_t> triangles, bool front, MeshRegion& region)
      : body_(body), mesh_(*body.mesh), region_(region) {
    region.front = front;
    region.triangles.clear();
    region.planes.clear();
    region.notches.clear();
    region.corners.clear();
    region.radius = 0.0;
    for (const std::uint32_t t : triangles)
      if (mesh_.around[t].notches != 0) find_notches(t);
  }
  void take(std::uint32_t t) {
    const auto corner = mesh_.corners(t);
    const RegionPlane plane{region_.front ? mesh_.normals[t] : Vec3(-mesh_.normals[t]), corner[0], t};
    const bool is_first = region_.triangles.empty();
    const auto holds = [&](const FaceNotch& n) { return !keeps_out(n, corner); };
    if (is_first) std::erase_if(region_.notches, holds);
    if (!bends_away(plane, corner) || std::ranges::any_of(region_.notches, holds)) return;
    region_.triangles.push_back(t);
    const auto same = [&](const RegionPlane& p) { return mesh_.face[p.triangle] == mesh_.face[t]; };
    if (std::none_of(region_.planes.begin(), region_.planes.end(), same)) region_.planes.push_back(plane);
    for (const Vec3& c : corner) {
      const Vec3 x = c - body_.pose.position;
      if (std::find(region_.corners.begin(), region_.corners.end(), x) != region_.corners.end()) continue;
      region_.corners.push_back(x);
      region_.radius = std::max(region_.radius, x.norm());
    }
  }

 private:
  void find_notches(std::uint32_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const FaceNotch notch{mesh_.face[t], mesh_.triangles[t][k]};
      if ((mesh_.around[t].notches >> k & 1) != 0 && std::ranges::count(region_.notches, notch) == 0)
        region_.notches.push_back(notch);
    }
  }
  /// No corner of either rises above the planes of the other.
  bool bends_away(const RegionPlane& plane, const std::array<Vec3, 3>& corner) const {
    for (const Vec3& c : corner)
      for (const RegionPlane& p : region_.planes)
        if (is_above(body_, p, c)) return false;
    return std::none_of(region_.corners.begin(), region_.corners.end(),
                        [&](const Vec3& c) { return is_above(body_, plane, body_.pose.position + c); });
  }
  /// The convex outline of what is gathered in the plane of the face, the corners of one more triangle among it, does
  /// not hold the notch: seen from there, all of it is within half a turn. (A connected part of a face whose outline
  /// reaches out of the face goes around a notch.)
  bool keeps_out(const FaceNotch& notch, const std::array<Vec3, 3>& corner) const {
    const Vec3 &normal = mesh_.normals[notch.face], at = mesh_.vertices[notch.vertex];
    Vec3 right = Vec3::Zero(), left = Vec3::Zero();  // the outermost corners
    const auto is_within = [&](const Vec3& d) {
      const double length = d.norm();
      if (length <= body_.tolerance || std::abs(normal.dot(d)) > body_.tolerance) return true;
      const auto is_left = [&](const Vec3& a, const Vec3& b) {  // b of a, or along it
        return normal.dot(a.cross(b)) >= -body_.tolerance * std::max(length, a.norm());
      };
      if (right.squaredNorm() == 0.0) right = left = d;
      const bool from_right = is_left(right, d), from_left = is_left(d, left);
      if (!from_right) right = d;
      if (!from_left) left = d;
      return from_right || from_left;
    };
    const auto is_gathered_within = [&](const Vec3& c) { return is_within(body_.pose.position + c - at); };
    return std::ranges::all_of(region_.corners, is_gathered_within) &&
           std::ranges::all_of(corner, [&](const Vec3& c) { return is_within(c - at); });
  }

  const PlacedCore& body_;
  const TriangleMesh& mesh_;
  MeshRegion& region_;
};

/// Side of a surface on which a point is, by the nearest surface point and its angle-weighted normal (Baerentzen and
/// Aanaes 2005).
struct NearestPlace {
  double distance = infinity, height = 0.0;

  void see(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x) {
    auto corner = mesh.corners(t);
    for (Vec3& c : corner) c -= x;
    const NearestOnTriangle near = nearest_on_triangle(Vec3::Zero(), corner);
    if (near.distance < distance * (1.0 - same_distance)) height = 0.0;
    if (near.distance <= distance * (1.0 + same_distance))
      height -= angle_at(near.part, corner) * mesh.normals[t].dot(near.point);
    distance = std::min(distance, near.distance);
  }
  /// Angle of the surface around a point of a triangle [rad].
  static double angle_at(TrianglePart part, const std::array<Vec3, 3>& corner) {
    if (part == TrianglePart::face) return 2.0 * half_turn;
    if (part < TrianglePart::corner0) return half_turn;
    const auto k = static_cast<std::size_t>(part) - static_cast<std::size_t>(TrianglePart::corner0);
    const Vec3 u = corner[(k + 1) % 3] - corner[k], v = corner[(k + 2) % 3] - corner[k];
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }
};

/// How far the solid goes on from a vertex along a unit direction, at most `most` [m]; 0: not at all. It goes on where
/// no triangle of the vertex turns its outside that way, and at least one its inside.
double solid_beyond(const PlacedCore& body, bool front, const Vec3& from, const Vec3& along, double most) {
  const TriangleMesh& mesh = *body.mesh;
  const double side = front ? 1.0 : -1.0;
  bool behind = false, outside = false;
  double length = most;
  const Vec3 to = from + most * along;
  static thread_local std::vector<std::uint32_t> near;  // keeps its size
  near.clear();
  mesh.query(Aabb{from.cwiseMin(to), from.cwiseMax(to)}.fattened(body.tolerance), near);
  for (const std::uint32_t t : near) {
    const double rise = side * mesh.normals[t].dot(along), height = over_triangle(mesh, t, from).height;
    if (lies_on(mesh, t, from, body.tolerance)) {
      behind = behind || rise < -blunt;
      outside = outside || rise > blunt;
    } else if (std::abs(rise) > blunt && stands_between(mesh, t, from, to, body.tolerance)) {
      length = std::min(length, std::abs(height / rise));
    }
  }
  return behind && !outside ? length : 0.0;
}

}  // namespace

void find_sides(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const Vec3& x,
                std::vector<unsigned char>& front) {
  constexpr unsigned char unknown = 2;
  static thread_local std::vector<std::size_t> part;  // keeps its size
  front.assign(triangles.size(), unknown);
  for (std::size_t first = 0; first < triangles.size(); ++first) {
    if (front[first] != unknown) continue;
    NearestPlace nearest;
    part.assign(1, first);
    front[first] = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::uint32_t t = triangles[part[i]];
      nearest.see(mesh, t, x);
      for (const std::uint32_t next : mesh.neighbours[t]) {
        const std::size_t place = place_of(triangles, next);
        if (place == triangles.size() || triangles[place] != next || front[place] != unknown) continue;
        front[place] = 0;
        part.push_back(place);
      }
    }
    if (const std::uint32_t closed = mesh.around[triangles[first]].closed; closed != TriangleMesh::none) {
      const double found = nearest.distance;
      nearest = {};  // what stands between x and these triangles need not be among them
      const auto reach = [&] { return std::min(found, nearest.distance) * (1.0 + same_distance); };
      mesh.each_within(x, reach, [&](std::uint32_t t) {
        if (mesh.around[t].closed == closed) nearest.see(mesh, t, x);
      });
    }
    for (const std::size_t k : part) front[k] = nearest.height >= 0.0;
  }
}

Vec3 MeshRegion::support(const Vec3& d) const {
  return *std::max_element(corners.begin(), corners.end(),
                           [&](const Vec3& a, const Vec3& b) { return d.dot(a) < d.dot(b); });
}

void gather_region(const PlacedCore& body, std::span<const std::uint32_t> triangles, std::uint32_t first, bool front,
                   MeshRegion& region) {
  const TriangleMesh& mesh = *body.mesh;
  Gathering gathering(body, triangles, front, region);
  region.first = first;
  gathering.take(first);
  const EdgeKind away = front ? EdgeKind::convex : EdgeKind::concave;
  for (std::size_t k = 0; k < region.triangles.size(); ++k) {
    const std::uint32_t t = region.triangles[k];
    for (std::size_t side = 0; side < 3; ++side) {
      const EdgeKind kind = mesh.edge_kinds[t][side];
      const std::uint32_t next = mesh.neighbours[t][side];
      if (kind != EdgeKind::flat && kind != away) continue;
      const std::size_t place = place_of(triangles, next);
      if (place == triangles.size() || triangles[place] != next) continue;
      if (std::find(region.triangles.begin(), region.triangles.end(), next) == region.triangles.end())
        gathering.take(next);
    }
  }
  std::sort(region.triangles.begin(), region.triangles.end());
}

bool continue_rims(const PlacedCore& body, MeshRegion& region) {
  const TriangleMesh& mesh = *body.mesh;
  const std::size_t before = region.corners.size();
  each_rim(mesh, region, [&](std::uint32_t t, std::size_t k) {
    const auto corner = mesh.corners(t);
    const Vec3 &a = corner[k], &b = corner[(k + 1) % 3], along = (b - a).normalized();
    for (const auto& [end, way] : {std::pair<Vec3, Vec3>{a, -along}, {b, along}}) {
      const double length = solid_beyond(body, region.front, end, way, 2.0 * (body.core.radius + body.sweep));
      const Vec3 beyond = end + length * way;
      const auto rises = [&](const RegionPlane& p) { return is_above(body, p, beyond); };
      if (!(length > body.tolerance) || std::ranges::any_of(region.planes, rises)) continue;
      region.corners.push_back(beyond - body.pose.position);
      region.radius = std::max(region.radius, region.corners.back().norm());
    }
  });
  return region.corners.size() > before;
}

WayOut find_way_out(const PlacedCore& body, const MeshRegion& region) {
  const auto support = [](const void* p, const Vec3& d) { return static_cast<const MeshRegion*>(p)->support(d); };
  const ConvexRef rock{&region, support, region.radius};
  const MinkowskiDifference difference(body.core, rock, body.turn.transpose(), Vec3::Zero());
  const double limit = body.reach + body.sweep;
  const GjkResult g = gjk(difference, {limit + 1e-12 * difference.size(), 1e-14, Vec3::Zero()});
  const auto to_mesh = [&](const Vec3& x) -> Vec3 { return body.pose.position + body.turn * x; };
  if (g.status == GjkResult::Status::beyond) return {infinity, -(body.turn * g.normal), to_mesh(g.witness_b), 0.0};
  if (g.status != GjkResult::Status::overlapping)
    return {g.lower, -(body.turn * g.normal), to_mesh(g.witness_b), g.upper - g.lower};
  const Penetration p = epa(difference);
  return {-p.upper, -(body.turn * p.normal), to_mesh(p.witness_b), p.upper - p.lower};
}

bool is_near(const PlacedCore& body, std::uint32_t t) {
  const auto corner = body.mesh->corners(t);
  const double limit = body.reach + body.sweep;
  const NearestOnTriangle near = nearest_on_triangle(body.pose.position, corner);
  if (near.distance > (body.core.radius + limit) * (1.0 + 1e-12)) return false;
  const TriangleCore triangle(corner);
  const Mat3 to_body = body.turn.transpose();
  const MinkowskiDifference difference(body.core, ConvexRef::to(triangle), to_body,
                                       to_body * (triangle.centre - body.pose.position));
  const Vec3 way = to_body * (near.point - body.pose.position);
  return gjk(difference, {limit, 1e-6, way}).status != GjkResult::Status::beyond;
}

}  // namespace epafi
