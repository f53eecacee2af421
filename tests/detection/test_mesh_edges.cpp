// Flat sides that tip over the edge of a face of triangles: their points over the face come and go at a gap of zero.
#include "detection/shapes/cylinder.h"
#include "tests/detection/mesh_floors.h"
#include "tests/support/pair_errors.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// A side of length 2 half that lies over an edge that bends by more than 30 degrees, one end far inside a face of it.
struct OverEdge {
  Vec3 edge, normal, along;  ///< a point of the edge, normal of the face, direction of the side towards that end
  double place;              ///< of the edge on the side, from its middle [m]

  static OverEdge of(const TriangleMesh& mesh, double half, Random& random) {
    for (;;) {
      const auto t = static_cast<std::uint32_t>(random.bits() % mesh.triangles.size());
      const std::size_t k = random.bits() % 3;
      const auto corner = mesh.corners(t);
      const Vec3 edge = corner[k] + random.uniform() * (corner[(k + 1) % 3] - corner[k]), &n = mesh.normals[t];
      const Vec3 along = Eigen::AngleAxisd(random.uniform(-0.7, 0.7), n) * mesh.inward[t][k];
      const double place = random.uniform(-0.5, 0.5) * half;
      const double end_beyond = over_triangle(mesh, t, edge + (half - place) * along).beyond;
      if (n.dot(mesh.normals[mesh.neighbours[t][k]]) < 0.86 && end_beyond < -0.1 * half) return {edge, n, along, place};
    }
  }
};

/// Largest change of the sum of overlaps from one tilt to the next, over the depth [-].
template <class A>
double largest_jump(const A& a, double half_length, Random& random) {
  const TriangleMesh mesh = support::surface_of(support::random_hull(random, 6 + random.bits() % 6));
  const OverEdge laid = OverEdge::of(mesh, half_length, random);
  const double depth = random.uniform(0.005, 0.02) * a.radius;
  const Vec3 on_axis = laid.edge + (a.radius - depth) * laid.normal;
  const Pose at{random_point(random), random_turn(random)};
  double before = -1.0, most = 0.0;
  for (double tilt = -0.06; tilt < 0.06; tilt += 1e-4) {
    const Vec3 axis = std::cos(tilt) * laid.along + std::sin(tilt) * laid.normal;
    const Pose body{at.to_world(on_axis - laid.place * axis),
                    at.orientation * Quat::FromTwoVectors(Vec3::UnitZ(), axis)};
    double sum = 0.0;
    for (const double gap : contacts_with(a, body, mesh, at).gap) sum += std::max(0.0, -gap);
    if (before >= 0.0) most = std::max(most, std::abs(sum - before));
    before = sum;
  }
  return most / depth;
}

}  // namespace

TEST_CASE("a lying side that tips over an edge of triangles comes to touch its face gradually",
          "[detection][mesh][ridge]") {
  Random random(506, 0);
  for (int k = 0; k < 40; ++k) {
    INFO("draw " << k);
    // two points move by up to twice the length times the step of 1e-4 rad: 0.09 of the least depth
    CHECK(largest_jump(Capsule(0.07, 0.15), 0.075, random) < 0.1);
    CHECK(largest_jump(Cylinder(0.07, 0.15), 0.075, random) < 0.1);
  }
}
