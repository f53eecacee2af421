#include "detection/surfaces/tessellate.h"

#include "detection/mass_properties.h"
#include "detection/shapes/mesh_file.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// Closed, the right way round, and nearer to the body's own volume and inertia with every refinement, at second order.
template <class S>
void check_converges(const S& shape) {
  const MassProperties exact = shape.mass_properties();
  double last = 0.0;
  for (const std::uint32_t n : {16u, 32u, 64u}) {
    const TriangleSurface s = tessellate(shape, {n});
    CHECK(inspect(s).is_watertight());
    const MassProperties m = surface_mass_properties(s);
    const double error = 1.0 - m.mass / exact.mass;
    CHECK(error > 0.0);  // inscribed
    CHECK(m.centre.norm() < 1e-14 * shape.bounding_radius());
    if (last > 0.0) CHECK(last / error == Approx(4.0).epsilon(0.05));
    last = error;
  }
  // with a = 2 pi/n: polygons instead of circles lose a^2/6 of the volume, chords instead of half circles at most a^2/4
  CHECK(last < 1.03 * (1.0 / 6 + 1.0 / 4) * std::pow(2 * pi / 64, 2));
}

}  // namespace

TEST_CASE("tessellations of round shapes are closed and converge to the body", "[detection][tessellate]") {
  check_converges(Sphere{0.3});
  check_converges(Capsule(0.3, 1.1));
  check_converges(Capsule(0.3, 0.0));
  check_converges(Cylinder(0.3, 1.1));
  check_converges(Ellipsoid({0.3, 1.1, 0.7}));
}

TEST_CASE("tessellations of boxes and meshes are exact", "[detection][tessellate]") {
  const Box box(Vec3(0.5, 1.0, 1.5));
  const TriangleSurface s = tessellate(box);
  CHECK(s.triangles.size() == 12);
  CHECK(inspect(s).is_watertight());
  CHECK(surface_mass_properties(s).mass == Approx(6.0).epsilon(1e-15));
  const TriangleSurface prism = prism_surface(7, 1, 1);
  CHECK(tessellate(TriangleMesh::from_surface(prism)).triangles == prism.triangles);
}

TEST_CASE("the square of a half-space lies in its plane, centred, of the size asked for, facing outward",
          "[detection][tessellate]") {
  Random random(61, 0);
  const HalfSpace half_space{random_direction(random)};
  const TriangleSurface s = tessellate(half_space, {24, 3.0});
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : s.vertices) {
    CHECK(std::abs(v.dot(half_space.normal)) < 1e-15);
    sum += v;
  }
  CHECK(sum.norm() < 1e-15);
  CHECK((s.vertices[1] - s.vertices[0]).norm() == Approx(3.0));
  for (const auto& t : s.triangles) {
    const Vec3 area = (s.vertices[t[1]] - s.vertices[t[0]]).cross(s.vertices[t[2]] - s.vertices[t[0]]);
    CHECK(area.dot(half_space.normal) == Approx(9.0));
  }
}

TEST_CASE("a shape of the store is tessellated through its reference", "[detection][tessellate]") {
  ShapeStore store;
  const ShapeRef box = store.add(Box(Vec3(1, 1, 1))), sphere = store.add(Sphere{1.0});
  CHECK(tessellate(store, box).vertices.size() == 8);
  CHECK(tessellate(store, sphere).vertices.size() == 2 + 11 * 24);
}
