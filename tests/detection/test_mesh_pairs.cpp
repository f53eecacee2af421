#include "detection/narrow/mesh/mesh_pairs.h"

#include "detection/narrow/narrow_phase.h"
#include "detection/shapes/box.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/superquadric.h"
#include "tests/detection/mesh_floors.h"
#include "tests/support/polyhedra.h"

using namespace epafi;
using namespace epafi::testing;

TEST_CASE("a point inside all sides of a triangle is at its height, any other at least at its bound",
          "[detection][mesh-pairs]") {
  Random random(47, 0);
  std::size_t inside = 0, bounded = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 place = 100.0 * random_point(random);  // far from the origin: differences are rounded to 1e-14
    const TriangleSurface s{{place + random_point(random), place + random_point(random), place + random_point(random)},
                            {{0, 1, 2}}};
    const TriangleMesh mesh = TriangleMesh::from_surface(s);
    const Vec3 x = place + random_point(random);
    const OverTriangle at = over_triangle(mesh, 0, x);
    const NearestOnTriangle near = nearest_on_triangle(x, mesh.corners(0));
    const double area = (s.vertices[1] - s.vertices[0]).cross(s.vertices[2] - s.vertices[0]).norm();
    const double rounding = 1e-13 / std::min(1.0, area);  // of the normal of a sliver
    CHECK(std::sqrt(at.least_square()) <= near.distance + rounding);
    const bool is_inside = at.beyond < -rounding;
    bounded += at.beyond > rounding;
    if (std::abs(at.beyond) > rounding) CHECK((near.part == TrianglePart::face) == is_inside);
    if (!is_inside) continue;
    ++inside;
    CHECK(std::abs(at.height) == Approx(near.distance).margin(rounding));
    CHECK(lies_on(mesh, 0, near.point, 1e-12 / std::min(1.0, area)));
  }
  CHECK((inside > 100 && bounded > 1000));
}

TEST_CASE("a sphere on a triangulated floor sees exactly the plane, whatever the triangles",
          "[detection][mesh-pairs]") {
  Random random(51, 0);
  for (const auto joints : {Joints::shared, Joints::loose, Joints::staggered}) {
    for (const std::uint32_t n : {2u, 8u, 40u}) {  // cells larger and smaller than the sphere
      const TriangleSurface flat = floor_surface(random, n, joints);
      const TriangleMesh mesh = TriangleMesh::from_surface(flat);
      const Pose at{random_point(random), random_turn(random)};
      const Sphere sphere{0.1};
      for (int k = 0; k < 300; ++k) {
        Vec3 foot(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 0.0);
        const auto& t = flat.triangles[random.bits() % flat.triangles.size()];
        if (k % 3 == 1) foot = 0.5 * (flat.vertices[t[0]] + flat.vertices[t[1]]);  // over an edge
        if (k % 3 == 2) foot = flat.vertices[t[0]];                                // over a vertex
        if (foot.cwiseAbs().maxCoeff() > 0.7) continue;
        const double side = k % 2 ? 1.0 : -1.0;  // both sides are walls
        const Pose body{at.to_world(foot + Vec3(0, 0, side * random.uniform(0.05, 0.1))), random_turn(random)};
        const HalfSpace plane{Vec3(0, 0, side)};
        const ContactSet found = contacts_with(sphere, body, mesh, at);
        check_same_contacts(found, contacts_closed(sphere, body, plane, at), 1e-14);
        if (found.size() == 1) CHECK(found.effective_radius[0] == 0.1);
      }
    }
  }
}

TEST_CASE("a sphere sliding over a flat mesh of any fineness feels no kick and keeps its contact on one surface",
          "[detection][mesh-pairs][long]") {
  Random random(52, 0);
  const Sphere sphere{0.05};
  for (const auto joints : {Joints::shared, Joints::loose, Joints::staggered})
    for (const std::uint32_t n : {1u, 2u, 7u, 40u, 160u}) {  // triangles from 40 radii to a quarter of one
      const TriangleMesh mesh = TriangleMesh::from_surface(floor_surface(random, n, joints));
      Feature first = 0;
      double kick = 0.0, gap_error = 0.0;
      bool kept = true;
      for (int k = 0; k <= 2000; ++k) {
        // obliquely, then along the lattice lines of the staggered floor: over vertices and along edges
        const double x = -0.9 + 9e-4 * k;
        const Vec3 p(x, k % 2 ? 0.3 + 5e-5 * k : 0.0, 0.0499);
        const ContactSet c = contacts_with(sphere, {p, Quat(1, 0, 0, 0)}, mesh);
        REQUIRE(c.size() == 1);
        if (k == 0) first = c.feature[0];
        kept = kept && c.feature[0] == first;
        kick = std::max(kick, c.normal[0].head<2>().norm());
        gap_error = std::max(gap_error, std::abs(c.gap[0] + 1e-4));
      }
      INFO(n << " cells");
      CHECK(kept);
      CHECK(kick < 1e-9);
      CHECK(gap_error < 1e-15);
    }
}

TEST_CASE("a sphere outside a closed box of triangles meets the box", "[detection][mesh-pairs]") {
  Random random(53, 0);
  const Vec3 half(0.5, 0.3, 0.2);
  const TriangleMesh mesh = TriangleMesh::from_surface(box_surface(half));
  const Box box(half);
  int faces = 0, edges = 0, corners = 0;
  for (int k = 0; k < 12000; ++k) {
    const Sphere sphere{random.uniform(0.02, 0.3)};
    const Pose at{random_point(random), random_turn(random)};
    const Vec3 on(random.uniform(-0.8, 0.8), random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5));
    const Vec3 outside = on - on.cwiseMax(-half).cwiseMin(half);
    if (outside.norm() == 0.0) continue;
    const Pose body{at.to_world(on), Quat(1, 0, 0, 0)};
    const auto n = (outside.array() != 0.0).count();
    const ContactSet expected = contacts_closed(sphere, body, box, at);
    if (expected.size() == 1) (n == 1 ? faces : n == 2 ? edges : corners)++;
    const ContactSet found = contacts_with(sphere, body, mesh, at);
    check_same_contacts(found, expected, 1e-12);  // the normal of an edge is a difference divided by the distance
  }
  CHECK(std::min({faces, edges, corners}) > 100);
}

TEST_CASE("a sphere in the corner of a room meets its three walls", "[detection][mesh-pairs]") {
  const TriangleMesh room = TriangleMesh::from_surface(box_surface({1, 1, 1}));
  const ContactSet c = contacts_with(Sphere{0.2}, {Vec3(0.81, -0.82, 0.83), Quat(1, 0, 0, 0)}, room);
  REQUIRE(c.size() == 3);
  check_distinct_features(c);
  Vec3 gaps = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) gaps += c.gap[k] * c.normal[k];
  CHECK((gaps - Vec3(-0.01, 0.02, -0.03)).norm() < 1e-15);  // normals from the sphere to the walls: +x, -y, +z
}

TEST_CASE("contacts on a sharp edge keep their name while the sphere rounds it", "[detection][mesh-pairs]") {
  const TriangleMesh mesh = TriangleMesh::from_surface(box_surface({1, 1, 1}));
  Feature first = 0;
  for (int k = 1; k < 100; ++k) {
    const double angle = 0.5 * pi * k / 100;
    const ContactSet c = contacts_with(
        Sphere{0.1}, {Vec3(1 + 0.09 * std::cos(angle), 0.013 * k - 0.6, 1 + 0.09 * std::sin(angle)), Quat(1, 0, 0, 0)},
        mesh);
    REQUIRE(c.size() == 1);
    CHECK(c.gap[0] == Approx(-0.01).epsilon(1e-12));
    if (k == 1) first = c.feature[0];
    CHECK(c.feature[0] == first);
  }
}

TEST_CASE("a capsule on a triangulated floor stands on its ends as on the plane", "[detection][mesh-pairs]") {
  Random random(54, 0);
  for (const auto joints : {Joints::shared, Joints::loose, Joints::staggered}) {
    const TriangleMesh mesh = TriangleMesh::from_surface(floor_surface(random, 12, joints));
    const Capsule capsule(0.05, 0.6);
    for (int k = 0; k < 500; ++k) {
      const double tilt = k % 2 ? 0.0 : random.uniform(-0.1, 0.1);
      const Quat turn = Quat(Eigen::AngleAxisd(random.uniform(0, 2 * pi), Vec3::UnitZ())) *
                        Quat(Eigen::AngleAxisd(0.5 * pi + tilt, Vec3::UnitX()));
      const Pose body{
          Vec3(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 0.3 * std::abs(std::sin(tilt)) + 0.049), turn};
      check_same_contacts(contacts_with(capsule, body, mesh), contacts_closed(capsule, body, HalfSpace{}, {}), 1e-14);
    }
  }
}

TEST_CASE("the deepest contact of a capsule with a box of triangles is the distance of its axis",
          "[detection][mesh-pairs]") {
  Random random(55, 0);
  const Vec3 half(0.5, 0.3, 0.2);
  const TriangleMesh mesh = TriangleMesh::from_surface(box_surface(half));
  int touching = 0;
  for (int k = 0; k < 4000; ++k) {
    const Capsule capsule(0.1, random.uniform(0.0, 1.0));
    const Pose body{random_point(random, -0.9, 0.9), random_turn(random)};
    const Vec3 along = body.orientation * Vec3(0, 0, capsule.half_length());
    const auto distance = [&](double t) {
      const Vec3 p = body.position + t * along;
      return (p - p.cwiseMax(-half).cwiseMin(half)).norm();
    };
    double low = -1, high = 1;  // the distance to a convex body is convex along the axis: ternary search
    for (int i = 0; i < 200; ++i) {
      const double a = low + (high - low) / 3, b = high - (high - low) / 3;
      (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
    }
    const double exact = distance(0.5 * (low + high)) - capsule.radius;
    if (exact + capsule.radius < 1e-6) continue;  // the axis goes through: depth is another question
    const ContactSet c = contacts_with(capsule, body, mesh);
    double deepest = infinity;
    for (const double gap : c.gap) deepest = std::min(deepest, gap);
    if (exact >= 0) {
      CHECK(c.size() == 0);
    } else {
      ++touching;
      CHECK(deepest == Approx(exact).margin(1e-7));  // ternary search stalls at the square root of rounding
      check_distinct_features(c);
    }
  }
  CHECK(touching > 200);
}

TEST_CASE("a capsule across the edge of a table rests on the edge", "[detection][mesh-pairs]") {
  const TriangleMesh table = TriangleMesh::from_surface(box_surface({1, 1, 0.1}));
  const Quat along_x(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitY()));
  const ContactSet c = contacts_with(Capsule(0.05, 1.0), {Vec3(0.8, 0.2, 0.149), along_x}, table);
  REQUIRE(c.size() == 2);  // the end over the table and the edge at x = 1
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(c.gap[k] == Approx(-0.001).epsilon(1e-12));
    CHECK((c.normal[k] - Vec3(0, 0, -1)).norm() < 1e-12);
  }
  CHECK(std::max(c.arm[0].x(), c.arm[1].x()) == Approx(0.2).epsilon(1e-12));
  CHECK(std::min(c.arm[0].x(), c.arm[1].x()) == Approx(-0.5).epsilon(1e-12));
}

TEST_CASE("an end of a capsule that has gone through a thin floor is pushed back", "[detection][mesh-pairs]") {
  Random random(56, 0);
  const TriangleMesh mesh = TriangleMesh::from_surface(floor_surface(random, 12));
  const ContactSet c = contacts_with(Capsule(0.05, 0.6), {Vec3(0.1, 0.2, 0.2), Quat(1, 0, 0, 0)}, mesh);
  REQUIRE(c.size() == 1);
  CHECK(c.gap[0] == Approx(-0.15).epsilon(1e-12));  // the lower end at z = -0.1, its sphere down to -0.15
  CHECK(c.normal[0].z() == Approx(-1.0));
}

TEST_CASE("a box on a triangulated floor stands on its four corners", "[detection][mesh-pairs]") {
  Random random(57, 0);
  for (const auto joints : {Joints::shared, Joints::loose, Joints::staggered}) {
    for (const std::uint32_t n : {2u, 10u, 40u}) {
      const TriangleMesh mesh = TriangleMesh::from_surface(floor_surface(random, n, joints));
      const Pose at{random_point(random), random_turn(random)};
      const Box box(Vec3(0.1, 0.15, 0.2));
      for (int k = 0; k < 100; ++k) {
        // penetration far below the cells: triangles that reach under the box by less than it must not push sideways
        const double depth = std::pow(10.0, random.uniform(-6, -3));
        const double tilt = k % 2 ? 0.0 : 0.3 * depth;
        const Pose in_mesh{Vec3(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 0.2 - depth),
                           Quat(Eigen::AngleAxisd(random.uniform(0, 2 * pi), Vec3::UnitZ())) *
                               Quat(Eigen::AngleAxisd(tilt, Vec3::UnitX()))};
        const Pose body{at.to_world(in_mesh.position), at.orientation * in_mesh.orientation};
        const ContactSet found = contacts_with(box, body, mesh, at),
                         expected = contacts_closed(box, body, HalfSpace{}, at);
        CHECK(expected.size() == 4);
        check_same_contacts(found, expected,
                            2e-7);  // points within the snap distance of 1e-6 of the size of an edge may be its
        check_distinct_features(found);
        for (std::size_t i = 0; i < found.size(); ++i)
          CHECK((found.normal[i] + at.orientation * Vec3::UnitZ()).norm() < 1e-9);
      }
    }
  }
}

namespace {

/// Turned, moved by `away` [m] and in single precision; every third triangle once more, turned over.
TriangleSurface as_in_files(const TriangleSurface& s, const Quat& turn, const Vec3& away) {
  TriangleSurface out = moved(s, turn, away);
  for (Vec3& v : out.vertices) v = v.cast<float>().cast<double>();
  for (std::size_t t = 0; t < s.triangles.size(); t += 3)
    out.triangles.push_back({s.triangles[t][0], s.triangles[t][2], s.triangles[t][1]});
  return out;
}

/// The body stands, lies or leans on the floor as on the plane that was meant.
template <class S>
void check_on_rounded_floor(const S& shape, std::uint64_t stream) {
  Random random(64, stream);
  for (const double away : {0.0, 3.0, 100.0})
    for (const auto joints : {Joints::shared, Joints::loose, Joints::staggered}) {
      const auto n = static_cast<std::uint32_t>(5 + random.bits() % 30);
      const Quat turn = random_turn(random);
      const Vec3 place = away * random_direction(random);
      const double precision = std::ldexp(away + 2.0, -24);
      const TriangleSurface rounded = as_in_files(floor_surface(random, n, joints), turn, place);
      const TriangleMesh mesh = TriangleMesh::from_surface(rounded, precision);
      INFO(S::name << ", " << away << " m away, " << n << " cells, joints " << static_cast<int>(joints));
      CHECK(mesh.joined.faces == 1);
      for (int k = 0; k < 30; ++k) {
        const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * pi), Vec3::UnitZ()));
        const Quat lies(Eigen::AngleAxisd(k % 3 == 1 ? 0.5 * pi : 0.0, Vec3::UnitX()));
        const Quat own = k % 3 == 2 ? random_turn(random) : Quat(yaw * lies);
        const Vec3 down = own.conjugate() * Vec3(0, 0, -1);
        const double height = shape.support(down).dot(down) + shape.rounding() - 1e-3;
        const Vec3 foot(random.uniform(-0.25, 0.25), random.uniform(-0.25, 0.25), height);
        const Pose body{turn * foot + place, turn * own};
        const HalfSpace plane{mesh.normals[0].dot(turn * Vec3::UnitZ()) > 0.0 ? mesh.normals[0] : -mesh.normals[0]};
        CHECK(plane.normal.cross(turn * Vec3::UnitZ()).norm() < 4.0 * precision);
        const ContactSet found = contacts_with(shape, body, mesh);
        check_same_contacts(found, contacts_closed(shape, body, plane, {mesh.vertices[0], Quat(1, 0, 0, 0)}), 1e-11);
      }
    }
}

}  // namespace

TEST_CASE(
    "on a floor of single precision up to 100 m away, with triangles loose, doubled and crooked, every body "
    "stands as on the plane",
    "[detection][mesh-pairs]") {
  check_on_rounded_floor(Box(Vec3(0.1, 0.15, 0.2)), 0);
  check_on_rounded_floor(Cylinder(0.1, 0.3), 1);
  check_on_rounded_floor(Ellipsoid({0.1, 0.2, 0.15}), 2);
  check_on_rounded_floor(Superquadric({0.1, 0.1, 0.15}, 2, 8), 3);
}

namespace {
void check_near_box(std::uint64_t stream) {
  Random random(58, stream);
  INFO("stream " << stream);
  const Vec3 half(0.5, 0.3, 0.2);
  const TriangleMesh mesh = TriangleMesh::from_surface(box_surface(half));
  const Box solid(half), body(Vec3(0.1, 0.2, 0.15));
  int near = 0;
  for (int k = 0; k < 3000; ++k) {
    const Pose pose{random_point(random, -0.9, 0.9), random_turn(random)}, at;
    const double reach = 0.05;
    const PolyhedronPair pair(body.view(), solid.view(), pose, at);
    const PolyhedronDistance d = polyhedron_distance(pair);
    if (d.axis.gap <= 0.0) continue;
    const ContactSet c = contacts_with(body, pose, mesh, at, reach);
    double least = infinity;
    for (const double gap : c.gap) least = std::min(least, gap);
    if (d.axis.gap < reach) {
      ++near;
      CHECK(least == Approx(d.axis.gap).margin(1e-6));  // snap distance of the manifold
    } else {
      CHECK(least == infinity);
    }
  }
  CHECK(near > 100);
}
}  // namespace

TEST_CASE("polyhedra near a box of triangles are as far from it as from the solid box", "[detection][mesh-pairs]") {
  check_near_box(0);
}

TEST_CASE("a body beside an edge of triangles, its centre behind the plane beyond, is not in it",
          "[detection][mesh-pairs]") {
  for (std::uint64_t stream = 1; stream < 10; ++stream) check_near_box(stream);  // 7 and 9 once: 27 mm deep, 3 mm away
}

TEST_CASE("a box in slight contact with a box of triangles is pushed apart as the solid boxes are",
          "[detection][mesh-pairs]") {
  Random random(59, 0);
  const Vec3 half(0.5, 0.3, 0.2);
  const TriangleMesh mesh = TriangleMesh::from_surface(box_surface(half));
  const Box solid(half), body(Vec3(0.1, 0.2, 0.15));
  int touching = 0, certified = 0;
  for (int k = 0; k < 20000 && touching < 300; ++k) {
    Pose pose{random_point(random, -0.9, 0.9), random_turn(random)};
    PolyhedronDistance d = polyhedron_distance(PolyhedronPair(body.view(), solid.view(), pose, {}));
    if (d.axis.gap <= 0.0 || d.axis.gap > 0.1) continue;
    pose.position += (d.axis.gap + 1e-5) * (pose.orientation * d.axis.normal);  // 1e-5 into the solid
    d = polyhedron_distance(PolyhedronPair(body.view(), solid.view(), pose, {}));
    if (d.axis.gap > -0.9e-5) continue;  // corners against corners slide past
    ++touching;
    const ContactSet c = contacts_with(body, pose, mesh);
    REQUIRE(c.size() > 0);
    const Vec3 n = pose.orientation * d.axis.normal;
    std::size_t deepest = 0;
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (c.gap[i] < c.gap[deepest]) deepest = i;
      CHECK(c.normal[i].dot(n) > 0.0);  // none pulls the body in
    }
    CHECK(c.gap[deepest] == Approx(d.axis.gap).margin(1e-7));
    CHECK(c.normal[deepest].dot(n) > 0.99);
    // two directions may separate equally well: the one that was found must be one of them
    const PolyhedronPair pair(body.view(), solid.view(), pose, {});
    certified += std::abs(pair.separation(pose.orientation.conjugate() * c.normal[deepest]) - d.axis.gap) < 1e-7;
  }
  CHECK(touching == 300);
  // A triangle knows nothing of the solid behind it: where a contact is nearer to a corner than it is deep, the
  // direction may be off by degrees. With 1e-5 deep and bodies of 0.3 that is 1 case of 300 here.
  CHECK(certified >= 299);
}

TEST_CASE("hulls deep in a triangulated floor touch it as the plane: with all corners below, not those of one face",
          "[detection][mesh-pairs]") {
  Random random(63, 0);
  for (const auto joints : {Joints::shared, Joints::loose, Joints::staggered}) {
    for (const std::uint32_t n : {2u, 10u}) {
      const TriangleMesh mesh = TriangleMesh::from_surface(floor_surface(random, n, joints));
      const Pose at{random_point(random), random_turn(random)};
      int several = 0;
      for (int k = 0; k < 200; ++k) {
        const ConvexHull hull = support::random_hull(random, 8 + random.bits() % 24, Vec3::Constant(0.2));
        const Quat turn = random_turn(random);
        double lowest = 0.0;
        for (const Vec3& v : hull.vertices) lowest = std::min(lowest, (turn * v).z());
        const double depth = std::pow(10.0, random.uniform(-4, -0.7)) * hull.radius;
        const Pose in_mesh{Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), -lowest - depth), turn};
        const Pose body{at.to_world(in_mesh.position), at.orientation * turn};
        const ContactSet found = contacts_with(hull, body, mesh, at),
                         expected = contacts_closed(hull, body, HalfSpace{}, at);
        several += expected.size() > 1;
        check_same_contacts(found, expected, 1e-9);
        check_distinct_features(found);
      }
      CHECK(several > 15);
    }
  }
}

TEST_CASE("cylinders and ellipsoids on a triangulated floor see the plane", "[detection][mesh-pairs]") {
  Random random(60, 0);
  for (const std::uint32_t n : {2u, 20u}) {
    const TriangleMesh mesh = TriangleMesh::from_surface(floor_surface(random, n));
    const Cylinder cylinder(0.1, 0.3);
    const Ellipsoid ellipsoid({0.1, 0.2, 0.15});
    for (int k = 0; k < 100; ++k) {
      const Vec3 place(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 0.0);
      const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * pi), Vec3::UnitZ()));
      const Pose standing{place + Vec3(0, 0, 0.1499), yaw};
      const ContactSet stands = contacts_with(cylinder, standing, mesh),
                       plane = contacts_closed(cylinder, standing, HalfSpace{}, {});
      CHECK(stands.size() >= std::min<std::size_t>(plane.size(), 3));
      CHECK(stands.size() <= 4);
      for (std::size_t i = 0; i < stands.size(); ++i) {
        CHECK(stands.gap[i] == Approx(-1e-4).epsilon(1e-9));
        CHECK((stands.normal[i] - Vec3(0, 0, -1)).norm() < 1e-12);
      }
      const Quat turn = random_turn(random);
      const Vec3 down = turn.conjugate() * Vec3(0, 0, -1);
      const Pose tipped{place + Vec3(0, 0, ellipsoid.support(down).dot(down) - 1e-4), turn};
      check_same_contacts(contacts_with(ellipsoid, tipped, mesh), contacts_closed(ellipsoid, tipped, HalfSpace{}, {}),
                          1e-12);
    }
  }
}

TEST_CASE("a ball as near to an inner edge as rounding can tell has one contact", "[detection][mesh]") {
  // a foot beside the edge by less than 1e-8 of the radius has the distance of the edge, to the last digit
  Random random(644, 1);
  for (int draw = 0; draw < 400; ++draw) {
    TriangleSurface two;
    two.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    two.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Pose floor{testing::random_point(random), testing::random_turn(random)};
    const double radius = std::pow(10.0, random.uniform(-3, 0)), along = random.uniform(-0.5, 0.5);
    const double beside = (draw % 2 == 0 ? 1.0 : -1.0) * radius * std::pow(10.0, random.uniform(-14, -6));
    const Vec3 at(along + beside, along - beside, radius * (1.0 - std::pow(10.0, random.uniform(-9, -3))));
    const ContactSet found = testing::contacts_with(Sphere{radius}, {floor.to_world(at), Quat(1, 0, 0, 0)},
                                                    TriangleMesh::from_surface(two), floor);
    INFO("draw " << draw << ", radius " << radius << ", beside " << beside / radius);
    CHECK(found.size() == 1);
  }
}

TEST_CASE("a short capsule touches each flat surface with its deeper end alone, as the sphere that it becomes",
          "[detection][mesh-pairs][capsule]") {
  const Vec3 half(1, 1, 0.25);
  const TriangleMesh mesh = TriangleMesh::from_surface(box_surface(half));
  std::vector<std::uint32_t> all(mesh.triangles.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
  Random random(131, 0);
  for (int k = 0; k < 400; ++k) {
    const double r = 0.1, depth = r * std::pow(10.0, -random.uniform(1, 8));
    const Capsule capsule(r, k % 5 == 0 ? 0.0 : 0.2499 * r * random.uniform(0, 1));
    const double lean = k % 2 == 0 ? std::pow(10.0, -random.uniform(0, 5)) : random.uniform(-1.5, 1.5);
    const Quat turn = Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ())) *
                      Quat(Eigen::AngleAxisd(std::acos(0.0) + lean, Vec3::UnitY()));
    const Vec3 axis = turn * Vec3::UnitZ();
    const double reaches = capsule.half_length() * std::abs(axis.z());
    const Pose pose{{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), half.z() + r + reaches - depth}, turn};
    const auto check = [&](const char* other, double rounding, const Pose& there, const auto& collide_them) {
      ContactSet c;
      ContactSink sink(c);
      sink.begin(0, 1);
      collide_them(PairQuery{pose, there, 0.0, false, nullptr}, sink);
      sink.end();
      INFO(other << ", draw " << k << ", length " << capsule.length << ", lean " << lean << ", depth " << depth);
      REQUIRE(c.size() == 1);
      CHECK(std::abs(c.gap[0] + depth) < rounding);
      CHECK((c.normal[0] + Vec3::UnitZ()).norm() < 1e-9);
      const Vec3 end = axis.z() > 0.0 ? Vec3(-capsule.half_length() * axis) : Vec3(capsule.half_length() * axis);
      CHECK((c.arm[0] - end).head<2>().norm() < 1e-9);
    };
    check("half-space", 1e-15, {{0, 0, half.z()}, Quat::Identity()},
          [&](const PairQuery& q, ContactSink& out) { collide_closed(capsule, HalfSpace{}, q, out); });
    check("box", 1e-12, {}, [&](const PairQuery& q, ContactSink& out) { collide(capsule, Box(half), q, out); });
    check("cylinder", 1e-12, {},
          [&](const PairQuery& q, ContactSink& out) { collide(capsule, Cylinder(1.0, 0.5), q, out); });
    check("mesh", 1e-12, {},
          [&](const PairQuery& q, ContactSink& out) { collide_triangles(capsule, mesh, all, q, out); });
  }
}
