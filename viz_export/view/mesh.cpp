#include "viz_export/view/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/state/hash.h"
#include "viz_export/view/refine.h"

namespace epafi {
namespace {

constexpr double crease = 0.86;                // cosine: 31 degrees
constexpr double curved_crease = 0.47;         // 62 degrees: of bodies with caps
constexpr std::size_t most_refined = 250'000;  // triangles of all curved bodies
constexpr float same_place = 1e-5f;            // of the mesh's size: the seam of a turned profile is closed

/// Normals of the polygons (Newell), unit or zero.
std::vector<Vec3> polygon_normals(const Surface& s) {
  std::vector<Vec3> out;
  std::size_t begin = 0;
  for (const std::int32_t offset : s.offsets) {
    const auto end = static_cast<std::size_t>(offset);
    Vec3 normal = Vec3::Zero();
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3& p = s.points[static_cast<std::size_t>(s.connectivity[k])];
      const Vec3& q = s.points[static_cast<std::size_t>(s.connectivity[k + 1 < end ? k + 1 : begin])];
      normal += p.cross(q);
    }
    const double length = normal.norm();
    out.push_back(length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero()));
    begin = end;
  }
  return out;
}

/// True at the middle of a planar fan of polygons, as in cylinders and closed tubes.
bool has_flat_cap(const std::vector<Vec3>& normals, const std::vector<std::vector<std::uint32_t>>& around) {
  constexpr double one_plane = 1.0 - 1e-12;
  return std::ranges::any_of(around, [&](const std::vector<std::uint32_t>& fan) {
    return fan.size() > 2 &&
           std::ranges::all_of(fan, [&](std::uint32_t f) { return normals[f].dot(normals[fan.front()]) > one_plane; });
  });
}

double largest_coordinate(const Surface& s) {
  double out = 0;
  for (const Vec3& p : s.points) out = std::max(out, p.cwiseAbs().maxCoeff());
  return out;
}

/// Key that is equal for scaled copies: corners to 1e-6 of the size.
std::string form_of(const Surface& s, double size) {
  Hash hash;
  hash.add(std::uint64_t{s.curved});
  for (const auto* numbers : {&s.connectivity, &s.offsets})
    for (const std::int32_t number : *numbers) hash.add(static_cast<std::uint64_t>(number));
  for (const Vec3& p : s.points)
    for (int axis = 0; axis < 3; ++axis) hash.add(static_cast<std::uint64_t>(std::llround(1e6 * p[axis] / size)));
  return hash.hex();
}

/// For each point, the first point at the same position.
std::vector<std::uint32_t> joined_points(const ViewMesh& mesh) {
  float size = 0;
  for (const Eigen::Vector3f& p : mesh.points) size = std::max(size, p.cwiseAbs().maxCoeff());
  const float step = size > 0 ? same_place * size : 1.0f;
  std::map<std::array<long, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> out;
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    const Eigen::Vector3f at = mesh.points[p] / step;
    out.push_back(known.try_emplace({std::lround(at.x()), std::lround(at.y()), std::lround(at.z())}, p).first->second);
  }
  return out;
}

}  // namespace

ViewMesh view_mesh(const Surface& s) {
  ViewMesh mesh;
  for (const Vec3& p : s.points) mesh.points.push_back(p.cast<float>());
  const std::vector<Vec3> normals = polygon_normals(s);
  std::vector<std::vector<std::uint32_t>> around(s.points.size());  // polygons at each point
  std::size_t begin = 0;
  for (std::uint32_t f = 0; f < s.offsets.size(); ++f) {
    for (std::size_t k = begin; k < static_cast<std::size_t>(s.offsets[f]); ++k)
      around[static_cast<std::size_t>(s.connectivity[k])].push_back(f);
    begin = static_cast<std::size_t>(s.offsets[f]);
  }
  const bool round = s.curved && !has_flat_cap(normals, around);  // thin ends are bent by any angle
  const double bend = round ? -2.0 : s.curved ? curved_crease : crease;
  const auto add_corner = [&](std::uint32_t polygon, std::size_t place) {
    const auto point = static_cast<std::uint32_t>(s.connectivity[place]);
    Vec3 sum = Vec3::Zero();
    for (const std::uint32_t other : around[point])
      if (normals[other].dot(normals[polygon]) > bend) sum += normals[other];
    const double length = sum.norm();
    mesh.corners.push_back(point);
    mesh.normals.push_back((length > 0 ? Vec3(sum / length) : normals[polygon]).cast<float>());
  };
  begin = 0;
  for (std::uint32_t f = 0; f < s.offsets.size(); ++f) {
    const auto end = static_cast<std::size_t>(s.offsets[f]);
    for (std::size_t k = begin + 1; k + 1 < end; ++k) {  // fans: polygons of a surface are convex
      add_corner(f, begin);
      add_corner(f, k);
      add_corner(f, k + 1);
    }
    begin = end;
  }
  return mesh;
}

MeshStore::MeshStore(const std::vector<BodyRecord>& bodies) {
  std::size_t triangles = 0;
  for (const BodyRecord& b : bodies)
    if (b.surface != nullptr && b.surface->curved)
      triangles += b.surface->connectivity.size() - 2 * b.surface->offsets.size();
  refines_ = triangles <= most_refined;
}

namespace {

/// An edge as part of one face: the normal of the face, and the shading normals at the ends.
struct EdgeSide {
  Vec3 face;
  std::array<Eigen::Vector3f, 2> shading;
};

/// True for an edge that the shading shows: facets of a round body share normals at their corners.
bool is_crease(const EdgeSide& one, const EdgeSide& two) {
  constexpr float same_shading = 0.97f;  // cosine
  if (one.face.dot(two.face) >= crease) return false;
  return one.shading[0].dot(two.shading[0]) < same_shading || one.shading[1].dot(two.shading[1]) < same_shading;
}

}  // namespace

std::vector<std::uint32_t> feature_edges(const ViewMesh& mesh) {
  const std::vector<std::uint32_t> same = joined_points(mesh);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<EdgeSide>> edges;
  for (std::size_t c = 0; c + 2 < mesh.corners.size(); c += 3) {
    const auto point = [&](std::size_t k) -> Vec3 { return mesh.points[mesh.corners[c + k]].cast<double>(); };
    const Vec3 normal = (point(1) - point(0)).cross(point(2) - point(0)).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t from = c + k, to = c + (k + 1) % 3;
      if (same[mesh.corners[from]] > same[mesh.corners[to]]) std::swap(from, to);
      edges[{same[mesh.corners[from]], same[mesh.corners[to]]}].push_back(
          {normal, {mesh.normals[from], mesh.normals[to]}});
    }
  }
  std::vector<std::uint32_t> out;
  for (const auto& [ends, sides] : edges)
    if (sides.size() != 2 || is_crease(sides[0], sides[1])) out.insert(out.end(), {ends.first, ends.second});
  return out;
}

MeshStore::Copy MeshStore::of(const Surface* surface) {
  if (surface == nullptr) return {};
  const auto found = known_.find(surface);
  if (found != known_.end()) return found->second;
  const double size = std::max(largest_coordinate(*surface), 1e-300);
  const auto [form, is_new] = by_form_.emplace(form_of(*surface, size), static_cast<std::int32_t>(meshes_.size()));
  if (is_new) {
    ViewMesh mesh = view_mesh(*surface);
    meshes_.push_back(surface->curved && refines_ ? refined(mesh) : std::move(mesh));
    sizes_.push_back(size);
  }
  const Copy copy{form->second, size / sizes_[static_cast<std::size_t>(form->second)]};
  known_.emplace(surface, copy);
  return copy;
}

}  // namespace epafi
