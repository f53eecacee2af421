#include "detection/narrow/polyhedra/corner_cone.h"

#include <algorithm>
#include <cmath>

namespace epafi {

/// The faces around the vertex, with the edges between them as the first rays.
bool CornerCone::take_faces(const PolyhedronView& view, std::uint32_t vertex) {
  const std::uint32_t begin = view.fan_begin[vertex];
  face_count_ = ray_count_ = view.fan_begin[vertex + 1] - begin;
  if (face_count_ > most_faces) return false;
  for (std::size_t i = 0; i < face_count_; ++i) {
    face_[i] = view.fans[begin + i];
    normal_[i] = view.face_normals[face_[i]];
    rays_[i] = {view.vertices[view.neighbours[begin + i]] - view.vertices[vertex], 0.0};
  }
  return true;
}

bool CornerCone::assign(const PolyhedronView& view, std::uint32_t vertex) {
  if (!take_faces(view, vertex)) return false;
  const double rounding = 4e-15 * view.radius;
  for (std::size_t i = 0; i < face_count_; ++i)
    if (!(std::abs(normal_[i].dot(view.vertices[vertex]) - view.face_offsets[face_[i]]) <= rounding)) return false;
  tetrahedron_count_ = 0;
  split(0, face_count_ - 1, 0);
  return true;
}

/// The part's polygon of rays is triangulated from its first edge. p, q: rays that follow each other around it.
void CornerCone::add(std::size_t part, std::size_t p, std::size_t q) {
  if (p == part || q == part) return;
  const auto name = [](std::size_t k) { return static_cast<std::uint8_t>(k); };
  tetrahedra_[tetrahedron_count_++] = {{name(part), name(p), name(q)}, name(part)};
}

/// Faces i to j, where parts i and j meet behind ray `outer`: they meet up to the ray where a third face is as near, or
/// up to the edge between them.
void CornerCone::split(std::size_t i, std::size_t j, std::size_t outer) {
  if (j == i + 1) {
    add(i, j, outer);
    add(j, outer, j);
    return;
  }
  const Vec3 ij = normal_[j].cross(normal_[i]);
  const auto toward = [&](std::size_t m) -> Vec3 {
    return ij + normal_[i].cross(normal_[m]) + normal_[m].cross(normal_[j]);
  };
  std::size_t third = i + 1;
  Vec3 outward = toward(third);
  for (std::size_t m = i + 2; m < j; ++m)
    if ((normal_[m] - normal_[i]).dot(outward) < 0.0) {
      third = m;
      outward = toward(m);
    }
  const std::size_t inner = ray_count_++;
  rays_[inner] = {-outward, normal_[i].dot(outward)};
  add(i, inner, outer);
  add(j, outer, inner);
  split(i, third, inner);
  split(third, j, inner);
}

}  // namespace epafi
