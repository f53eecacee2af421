#include "viz_export/vtk/surface.h"

#include <cmath>
#include <numbers>

#include "detection/surfaces/tessellate.h"
#include "engine/state/frame.h"

namespace epafi {

namespace {

// 12 sides leave out 3.4 % of a radius; 24 sides would make the frames of ten thousand capsules four times larger (150
// MB)
constexpr Fineness fineness{.segments = 12};
constexpr std::int32_t rows = 6, columns = 12;  // directions; rows is even, so that none is level

void add_polygon(Surface& surface, std::initializer_list<std::int32_t> corners) {
  surface.connectivity.insert(surface.connectivity.end(), corners);
  surface.offsets.push_back(static_cast<std::int32_t>(surface.connectivity.size()));
}

Surface square(const HalfSpace& shape, double size, const Vec3& centre) {
  const ContactFrame f = contact_frame(shape.normal);
  const Vec3 foot = centre - centre.dot(f.normal) * f.normal, u = 0.5 * size * f.tangent1, v = 0.5 * size * f.tangent2;
  Surface surface;
  surface.points = {foot - u - v, foot + u - v, foot + u + v, foot - u + v};
  add_polygon(surface, {0, 1, 2, 3});
  return surface;
}

template <class View>
Surface faces_of(const View& view) {
  Surface surface;
  surface.points.assign(view.vertices.begin(), view.vertices.end());
  surface.connectivity.assign(view.face_vertices.begin(), view.face_vertices.end());
  for (std::size_t f = 1; f < view.face_begin.size(); ++f)
    surface.offsets.push_back(static_cast<std::int32_t>(view.face_begin[f]));
  return surface;
}

Surface triangles_of(const TriangleSurface& mesh) {
  Surface surface;
  surface.points = mesh.vertices;
  for (const Triangle& t : mesh.triangles)
    add_polygon(surface,
                {static_cast<std::int32_t>(t[0]), static_cast<std::int32_t>(t[1]), static_cast<std::int32_t>(t[2])});
  return surface;
}

/// True for shapes whose facets approximate a curved surface.
template <class S>
constexpr bool is_curved = std::is_same_v<S, Capsule> || std::is_same_v<S, Cylinder> || std::is_same_v<S, Ellipsoid> ||
                           std::is_same_v<S, Superquadric> || std::is_same_v<S, Clump> || HollowShape<S>;

template <class S>
Fineness fineness_of(const S& shape) {
  if constexpr (HollowShape<S>) return {.segments = 48};  // few, and large
  if constexpr (std::is_same_v<S, Superquadric>) {
    constexpr int round = 3;  // exponent; beyond it a quarter needs points on both sides of its edge
    if (std::max(shape.across, shape.along) > round) return {.segments = 24};
  }
  return fineness;
}

/// Support points in the directions of a latitude-longitude grid about z, for shapes without another surface.
template <class S>
Surface support_grid(const S& shape) {
  using std::numbers::pi;
  Surface surface;
  const auto add = [&](double polar, double azimuth) {
    const Vec3 d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
    surface.points.push_back(shape.support(d) + shape.rounding() * d);
  };
  add(0.0, 0.0);
  for (std::int32_t r = 0; r < rows; ++r)
    for (std::int32_t c = 0; c < columns; ++c) add((r + 0.5) * pi / rows, c * 2.0 * pi / columns);
  add(pi, 0.0);
  const auto at = [](std::int32_t r, std::int32_t c) { return 1 + r * columns + c % columns; };
  for (std::int32_t c = 0; c < columns; ++c) {
    add_polygon(surface, {0, at(0, c), at(0, c + 1)});
    for (std::int32_t r = 0; r + 1 < rows; ++r)
      add_polygon(surface, {at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)});
    add_polygon(surface, {at(rows - 1, c + 1), at(rows - 1, c), rows * columns + 1});
  }
  return surface;
}

}  // namespace

Surface surface_of(const ShapeStore& shapes, ShapeRef ref, double plane_size, const Vec3& plane_centre) {
  return shapes.with(ref, [&](const auto& shape) -> Surface {
    using S = std::decay_t<decltype(shape)>;
    if constexpr (std::is_same_v<S, Sphere>) {
      return {};
    } else if constexpr (std::is_same_v<S, HalfSpace>) {
      return square(shape, plane_size, plane_centre);
    } else if constexpr (requires { shape.view().face_begin; }) {
      return faces_of(shape.view());
    } else if constexpr (requires { tessellate(shape, fineness); }) {
      Surface surface = triangles_of(tessellate(shape, fineness_of(shape)));
      surface.curved = is_curved<S>;
      return surface;
    } else {
      static_assert(ConvexShape<S>, "a shape is drawn from its faces, its triangles or its support function");
      Surface surface = support_grid(shape);
      surface.curved = true;
      return surface;
    }
  });
}

}  // namespace epafi
