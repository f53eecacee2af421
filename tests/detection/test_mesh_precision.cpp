// Curved walls of quadrilaterals whose corners a file has rounded: more than three faces meet at a corner, which then
// lies in the planes of all of them only within the file's precision.
#include "detection/shapes/box.h"
#include "detection/shapes/cylinder.h"
#include "tests/detection/mesh_floors.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// A bowl of radius 1 of `rings` by `sides` quadrilaterals in halves, without its bottom; turned.
TriangleSurface random_bowl(Random& random) {
  const auto rings = 3 + static_cast<std::uint32_t>(random.bits() % 8), sides = 10 + rings * 2;
  const Quat turn = random_turn(random);
  TriangleSurface s;
  for (std::uint32_t j = 0; j <= rings; ++j)
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double polar = 0.5 * pi * (j + 1.0) / (rings + 1.0), around = 2.0 * pi * i / sides;
      s.vertices.push_back(
          turn * Vec3(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), -std::cos(polar)));
    }
  for (std::uint32_t j = 0; j < rings; ++j)
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t a = j * sides + i, b = j * sides + (i + 1) % sides;
      s.triangles.push_back({a, b, b + sides});
      s.triangles.push_back({a, b + sides, a + sides});
    }
  return s;
}

struct Rounded {
  TriangleMesh exact, read;
};
/// As it is, and as from a file in single precision, `offset` away from the origin.
Rounded rounded(const TriangleSurface& surface, const Vec3& offset) {
  TriangleSurface read = surface;
  double precision = 0.0;
  for (std::size_t v = 0; v < read.vertices.size(); ++v) {
    const Vec3 written = (surface.vertices[v] + offset).cast<float>().cast<double>();
    read.vertices[v] = written - offset;
    precision = std::max(precision, (read.vertices[v] - surface.vertices[v]).cwiseAbs().maxCoeff());
  }
  return {TriangleMesh::from_surface(surface), TriangleMesh::from_surface(read, precision)};
}

/// Sum of the forces of equal linear springs, over the stiffness [m].
Vec3 total(const ContactSet& contacts) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < contacts.size(); ++i) sum += std::max(0.0, -contacts.gap[i]) * contacts.normal[i];
  return sum;
}

/// Of a body that is pushed into the bowl by up to a twentieth of its radius.
template <class S>
void compare(const S& body, double radius, const Rounded& mesh, Random& random) {
  const auto t = static_cast<std::uint32_t>(random.bits() % mesh.exact.triangles.size());
  const auto corner = mesh.exact.corners(t);
  const Vec3 on_face = corner[0] + random.uniform(0.0, 0.5) * (corner[1] - corner[0]) +
                       random.uniform(0.0, 0.5) * (corner[2] - corner[0]);
  const Vec3 inward = normal_towards(mesh.exact, t, Vec3::Zero());
  const double depth = random.uniform(0.01, 0.05) * radius;
  const Quat turn = random_turn(random);
  Pose pose{Vec3(on_face + 2.0 * radius * inward), turn};
  for (int k = 0; k < 40; ++k) {
    const ContactSet near = contacts_with(body, pose, mesh.exact, {}, 3.0 * radius);
    double gap = infinity;
    for (const double g : near.gap) gap = std::min(gap, g);
    REQUIRE(gap < infinity);
    pose.position -= (gap + depth) * inward;
    if (std::abs(gap + depth) < 1e-9) break;
  }
  const ContactSet a = contacts_with(body, pose, mesh.exact), b = contacts_with(body, pose, mesh.read);
  CAPTURE(S::name, depth, a.size(), b.size());
  const auto most = static_cast<double>(std::max(a.size(), b.size()));
  CHECK((total(a) - total(b)).norm() <= 2.0 * most * mesh.read.joined.flatness);
}

}  // namespace

TEST_CASE("walls whose corners are rounded hold bodies as exact ones do", "[detection][mesh][precision]") {
  Random random(517, 0);
  for (int k = 0; k < 30; ++k) {
    const double far = k % 3 == 0 ? 0.0 : random.uniform(1.0, 1e4);
    INFO("draw " << k);
    const Rounded mesh = rounded(random_bowl(random), far * random_direction(random));
    for (int m = 0; m < 5; ++m) {
      compare(Sphere(0.3), 0.3, mesh, random);
      compare(Box(Vec3(0.2, 0.15, 0.1)), 0.1, mesh, random);
      compare(Cylinder(0.1, 0.2), 0.1, mesh, random);
    }
  }
}
