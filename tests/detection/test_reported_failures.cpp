// Failures that users of other libraries reported in public trackers, rebuilt from their descriptions. Each went wrong
// somewhere: no hit, a wrong depth, a flipped normal, a point far away, no end. The answers are closed forms.
#include "detection/narrow/gjk/convex_answer.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/narrow_phase.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"
#include "tests/support/triangle_solid.h"

using namespace epafi;
using support::about;
using testing::upright;

namespace {

struct Touch {
  ContactSet contacts;
  std::size_t degenerate = 0;
  double deepest() const {
    return contacts.size() > 0 ? *std::min_element(contacts.gap.begin(), contacts.gap.end()) : infinity;
  }
};

/// Two bodies through the pair table, as in a step.
template <class A, class B>
Touch touch(const A& a, const Pose& pose_a, const B& b, const Pose& pose_b, double reach = 0.0) {
  ShapeStore shapes;
  World world(Columns{.rotation = true, .force = false});
  Body body;
  body.mass = 1.0;
  body.inertia = Vec3::Ones();
  body.shape = shapes.add(a).packed;
  body.position = pose_a.position;
  body.orientation = pose_a.orientation;
  world.add(body);
  body.shape = shapes.add(b).packed;
  body.position = pose_b.position;
  body.orientation = pose_b.orientation;
  world.add(body);
  BatchNarrowPhase narrow(shapes, reach, false);
  const PairList pairs{{{0, 1}}, 0.0, 1};
  Touch found;
  narrow.collide(world, pairs, found.contacts);
  found.degenerate = narrow.degenerate_pairs();
  for (std::size_t k = 0; k < found.contacts.size(); ++k) {
    CHECK(std::abs(found.contacts.normal[k].norm() - 1.0) < 1e-14);
    CHECK(found.contacts.arm[k].allFinite());
  }
  return found;
}

double signed_distance(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb,
                       ConvexMethod method = ConvexMethod::automatic) {
  const auto d = ask(method, a.view(), b.view(), pa, pb);
  CHECK(d.normal.allFinite());
  CHECK(std::abs((pb.position - pa.position + d.witness_b - d.witness_a).dot(d.normal) - d.distance) <
        1e-9 * (a.radius + b.radius));
  return d.distance;
}

constexpr ConvexMethod both[] = {ConvexMethod::automatic, ConvexMethod::gjk_epa};

}  // namespace

TEST_CASE("reported: cubes of edge 2 offset by exactly 1.9 along z touch 0.1 deep along z", "[detection][reported]") {
  const Box cube(Vec3::Ones());
  for (const auto method : both)
    CHECK(signed_distance(cube.hull, {}, cube.hull, {{0, 0, 1.9}, upright}, method) == Approx(-0.1).epsilon(1e-13));
  const Touch f = touch(cube, {}, cube, {{0, 0, 1.9}, upright});
  REQUIRE(f.contacts.size() == 4);
  CHECK(f.contacts.normal[0] == Vec3(0, 0, 1));
}

TEST_CASE("reported: a thin box on a plate, where the origin lies outside the polytope", "[detection][reported]") {
  const Box thin(Vec3(0.307, 1.5, 0.0185)), plate(Vec3(1, 2, 0.005));
  Random random(81, 0);
  for (int k = 0; k < 200; ++k) {
    const double depth = std::pow(10.0, -random.uniform(3, 9));
    const Vec3 c(random.uniform(-0.6, 0.6), random.uniform(-0.4, 0.4), 0.0185 + 0.005 - depth);
    const double exact = c.z() - 0.0185 - 0.005;
    const Quat turn = about(Vec3::UnitZ(), random.uniform(0, 3));
    for (const auto method : both)
      CHECK(std::abs(signed_distance(plate.hull, {}, thin.hull, {c, turn}, method) - exact) < 2e-12);
  }
}

TEST_CASE("reported: equal boxes in equal turns kiss with a gap below an epsilon", "[detection][reported]") {
  Random random(82, 0);
  const Box box(Vec3(0.05, 0.15, 0.2));
  for (int k = 0; k < 200; ++k) {
    const Quat turn = testing::random_turn(random);
    for (const double gap : {1e-17, 1e-16, 1e-15, -1e-16, 0.0}) {
      const Vec3 centre = turn * Vec3(0.1 + gap, 0.02, 0.03);
      for (const auto method : both)
        CHECK(std::abs(signed_distance(box.hull, {Vec3::Zero(), turn}, box.hull, {centre, turn}, method)) < 2e-15);
    }
  }
}

TEST_CASE("reported: a plate of 0.46 by 0.48 by 0.01 in a box, and a slab against a cylinder",
          "[detection][reported]") {
  const Box plate(Vec3(0.23, 0.24, 0.005)), box(Vec3(0.1, 0.1, 0.1));
  for (const auto method : both)
    CHECK(std::abs(signed_distance(plate.hull, {}, box.hull, {{0.05, 0.02, 0.1}, upright}, method) + 0.005) < 1e-14);
  const Box slab(Vec3(0.025, 0.195, 0.735));
  const Cylinder can(0.1, 0.3);
  for (const double depth : {1e-3, 1e-6, 1e-9}) {
    const Touch f =
        touch(slab, {}, can, {{0.025 + 0.1 - depth, 0.01, 0.2}, upright});  // axis along z, beside the wide face
    REQUIRE(f.contacts.size() >= 1);
    CHECK(std::abs(f.deepest() + depth) < 2e-12);
    CHECK(f.contacts.normal[0].x() == Approx(1.0).epsilon(1e-9));
    CHECK(f.degenerate == 0);
  }
}

TEST_CASE("reported: cubes on a diagonal leave by a face, not towards a vertex", "[detection][reported]") {
  const Box cube(Vec3::Constant(0.5));
  for (const double s : {0.9, 0.99, 0.999999})
    for (const auto method : both)
      CHECK(std::abs(signed_distance(cube.hull, {}, cube.hull, {{s, s, s}, upright}, method) - (s - 1.0)) < 1e-13);
}

TEST_CASE("reported: two faces 2.5e-4 deep are not dropped, at any step of a slow approach", "[detection][reported]") {
  const Box box(Vec3(0.5, 0.5, 0.5));
  for (int k = -50; k <= 50; ++k) {
    const double gap = 1e-5 * k + 2.5e-6;
    const Touch f = touch(box, {}, box, {{0, 0, 1 + gap}, upright});
    CHECK(f.contacts.size() == (gap < 0 ? 4 : 0));
    if (gap < 0) CHECK(std::abs(f.deepest() - gap) < 3e-16);
  }
}

TEST_CASE("reported: boxes of half size 1 to 100 keep their contacts", "[detection][reported]") {
  for (const double h : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    const Box box(Vec3::Constant(h));
    const Touch f = touch(box, {}, box, {{0.1 * h, 0.2 * h, 2 * h - 1e-3}, upright});
    CHECK(f.contacts.size() == 4);
    CHECK(std::abs(f.deepest() + 1e-3) < 1e-15 * 2 * h);
  }
}

TEST_CASE("reported: clearly separated hulls are never at distance 0, overlapping cubes never apart",
          "[detection][reported]") {
  Random random(83, 0);
  const ConvexHull a = support::random_hull(random, 40), b = support::random_hull(random, 60);
  const Box cube(Vec3::Constant(0.5));
  for (int k = 0; k < 3000; ++k) {
    const Pose pb{random.uniform(2.1, 6) * testing::random_direction(random), testing::random_turn(random)};
    const double d = signed_distance(a, {}, b, pb);
    CHECK(d > pb.position.norm() - a.radius - b.radius - 1e-12);
    CHECK(d > 0.09);
    const Pose inside{random.uniform(0, 0.999) * testing::random_direction(random),
                      testing::random_turn(random)};  // inner spheres meet
    CHECK(signed_distance(cube.hull, {}, cube.hull, inside) < 0.0);
  }
}

TEST_CASE("reported: blobs of 128 vertices end within the cap", "[detection][reported]") {
  Random random(84, 0);
  const ConvexHull a = support::random_hull(random, 128), b = support::random_hull(random, 128);
  int most = 0;
  for (int k = 0; k < 300; ++k) {
    const MinkowskiDifference m(
        ConvexRef::to(a), ConvexRef::to(b), Pose{},
        Pose{random.uniform(0, 2.5) * testing::random_direction(random), testing::random_turn(random)});
    most = std::max(most, gjk(m).iterations);
  }
  INFO("most iterations " << most);
  CHECK(most <= gjk_cap);
}

TEST_CASE("reported: a disjoint cylinder and capsule are apart, barely touching ones 0 deep, not metres",
          "[detection][reported]") {
  const Cylinder cylinder(0.5, 2.0);
  const Capsule capsule(0.25, 1.0);
  for (const double gap : {0.3, 1e-3, 1e-6, 1e-9, 1e-12}) {
    const Touch above = touch(cylinder, {}, capsule, {{0.1, 0.1, 1.0 + 0.5 + 0.25 + gap}, upright}, 1.0);
    REQUIRE(above.contacts.size() >= 1);
    CHECK(std::abs(above.deepest() - gap) < 1e-14);
    const Touch below = touch(cylinder, {}, capsule, {{0.1, 0.1, 1.0 + 0.5 + 0.25 - gap}, upright}, 1.0);
    REQUIRE(below.contacts.size() >= 1);
    CHECK(std::abs(below.deepest() + gap) < 1e-14);
    const Touch beside = touch(cylinder, {}, capsule, {{0.5 + 0.25 + gap, 0, 0.2}, about(Vec3::UnitY(), 1e-3)}, 1.0);
    REQUIRE(beside.contacts.size() >= 1);
    CHECK(beside.deepest() < gap);  // leaning by 1e-3 over half a metre comes nearer by up to 5e-4
    CHECK(beside.deepest() > gap - 6e-4);
  }
}

TEST_CASE("reported: the normal does not flip while a box hovers over or sinks into a hull", "[detection][reported]") {
  const Box box(Vec3(0.5, 0.5, 0.1)), ground(Vec3(2, 2, 0.25));
  for (int k = -200; k <= 200; ++k) {
    const double gap = 1e-4 * k;
    const auto d = ask(ConvexMethod::automatic, ground.view(), box.view(), {},
                       {{0.3, -0.2, 0.35 + gap}, about(Vec3::UnitZ(), 0.3)});
    CHECK(d.normal.z() == Approx(1.0).epsilon(1e-15));
    CHECK(std::abs(d.distance - gap) < 1e-15);
  }
  const Sphere point{1e-9};  // a point that comes from 0.24 inside to 0.25, the surface, and beyond
  for (int k = 0; k <= 40; ++k) {
    const double z = 0.24 + 5e-4 * k + 1e-7;
    const Touch f = touch(ground, {}, point, {{0.1, 0.2, z}, upright}, 0.1);
    REQUIRE(f.contacts.size() == 1);
    CHECK(f.contacts.normal[0] == Vec3(0, 0, 1));
    CHECK(std::abs(f.contacts.gap[0] - (z - 0.25 - 1e-9)) < 1e-15);
  }
}

TEST_CASE("reported: a sliver of 200 m by 1 m has its contact point on itself", "[detection][reported]") {
  const std::array<Vec3, 3> corner{Vec3(-100, 0, 0), Vec3(100, -0.5, 0), Vec3(100, 0.5, 0)};
  const TriangleSolid sliver(corner, Vec3::UnitZ());
  const Box box(Vec3(0.1, 0.1, 0.1));
  Random random(85, 0);
  for (int k = 0; k < 200; ++k) {
    const double x = random.uniform(-95, 95), depth = random.uniform(0, 1e-4);
    const Pose pose{{x, 0.0, 0.1 - depth}, about(Vec3::UnitZ(), random.uniform(0, 1))};
    const auto d = ask(ConvexMethod::automatic, sliver.view(), box.view(), sliver.pose(), pose);
    CHECK(std::abs(d.distance + depth) < 1e-13);
    CHECK((sliver.centre() + d.witness_a - Vec3(x, 0, 0)).norm() < 0.2);
  }
}

TEST_CASE("reported: a ground of 20 km carries a box of 1 m with its normal upright", "[detection][reported]") {
  for (const double side : {500.0, 20000.0}) {
    const Box ground(Vec3(0.5 * side, 0.5 * side, 10)), box(Vec3::Constant(0.5));
    Random random(86, 0);
    for (int k = 0; k < 100; ++k) {
      const double depth = std::pow(10.0, -random.uniform(2, 6));
      const Vec3 c(random.uniform(-0.49, 0.49) * side, random.uniform(-0.49, 0.49) * side, 10.5 - depth);
      const Touch f = touch(ground, {}, box, {c, about(Vec3::UnitZ(), random.uniform(0, 1))});
      REQUIRE(f.contacts.size() == 4);
      for (const Vec3& n : f.contacts.normal) CHECK(n == Vec3(0, 0, 1));
      CHECK(std::abs(f.deepest() + depth) < 1e-14);
    }
  }
}

TEST_CASE("reported: boxes at coordinates of 9e4 overlap as they do at the origin", "[detection][reported]") {
  const Box box(Vec3(1, 1, 1));
  const Vec3 far(9e4, -9e4, 9e4);  // 1.75 is a sum of powers of two: stored exactly
  CHECK(signed_distance(box.hull, {far, upright}, box.hull, {far + Vec3(1.75, 0.5, 0.25), upright}) == -0.25);
}

TEST_CASE("reported: close parallel faces end, at every gap from 1e-3 to nothing", "[detection][reported]") {
  Random random(87, 0);
  const Box a(Vec3(1, 0.5, 0.3)), b(Vec3(0.4, 0.8, 0.2));
  for (int k = 3; k <= 17; ++k) {
    const double gap = std::pow(10.0, -k);
    const Quat turn = testing::random_turn(random), twist = about(Vec3::UnitZ(), random.uniform(0, 3));
    const MinkowskiDifference m(ConvexRef::to(a), ConvexRef::to(b), Pose{Vec3::Zero(), turn},
                                Pose{turn * Vec3(0.2, 0.1, 0.5 + gap), turn * twist});
    const GjkResult g = gjk(m);
    CHECK(g.iterations <= 20);
    CHECK(g.lower <= gap + 1e-15);
  }
}

TEST_CASE("reported: a point against seven vertices, where the iteration limit was reached", "[detection][reported]") {
  Random random(88, 0);
  for (int k = 0; k < 500; ++k) {
    const ConvexHull hull = support::random_hull(random, 7);
    const Sphere point{0.0};
    const Vec3 x = random.uniform(0, 3) * testing::random_direction(random);
    const GjkResult g = gjk(MinkowskiDifference(ConvexRef::to(hull), ConvexRef::to(point), Pose{}, Pose{x, upright}));
    CHECK(g.iterations <= 16);
    double outside = -infinity;
    for (std::size_t f = 0; f < hull.face_normals.size(); ++f)
      outside = std::max(outside, hull.face_normals[f].dot(x) - hull.face_offsets[f]);
    CHECK((g.status == GjkResult::Status::overlapping) == (outside < 1e-14));
  }
}

TEST_CASE("reported: a sphere in every place about a box, its centre included, has a finite answer",
          "[detection][reported]") {
  const Box box(Vec3(0.5, 0.4, 0.3));
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) {
        const Vec3 c(0.25 * i, 0.2 * j, 0.15 * k);  // faces, edges, vertices and the centre exactly
        const Touch f = touch(box, {}, Sphere{0.1}, {c, upright}, 1.0);
        REQUIRE(f.contacts.size() == 1);
        const Vec3 out = c.cwiseAbs() - box.half;
        CHECK(f.contacts.gap[0] == Approx(out.maxCoeff() - 0.1).margin(1e-15));
      }
}

TEST_CASE("reported: nearly identical triangles, and equal hulls in one pose, overlap", "[detection][reported]") {
  const std::array<Vec3, 3> corner{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 0.8, 0)};
  std::array<Vec3, 3> other = corner;
  for (Vec3& c : other) c += Vec3(1e-12, -1e-12, 0);
  const TriangleSolid p(corner, Vec3::UnitZ()), q(other, Vec3::UnitZ());
  const auto d = ask(ConvexMethod::automatic, p.view(), q.view(), p.pose(), q.pose());
  CHECK(std::abs(d.distance) < 1e-15);
  Random random(89, 0);
  for (int k = 0; k < 60; ++k) {
    const ConvexHull hull = support::random_hull(random, 4 + static_cast<std::size_t>(k % 20));
    const double exact = support::brute_force_distance(hull, {}, hull, {});
    for (const auto method : both) CHECK(std::abs(signed_distance(hull, {}, hull, {}, method) - exact) < 1e-11);
  }
}

TEST_CASE("reported: a cylinder on a floor of two triangles touches under itself", "[detection][reported]") {
  const TriangleMesh floor =
      TriangleMesh::from_surface({{{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const Cylinder can(0.3, 0.8);
  Random random(90, 0);
  for (int k = 0; k < 60; ++k) {
    const double depth = 1e-3 * random.uniform();
    const Pose pose{{random.uniform(-20, 20), random.uniform(-20, 20), 0.4 - depth},
                    about(Vec3::UnitZ(), random.uniform(0, 3))};
    const Touch f = touch(can, pose, floor, {});
    REQUIRE(f.contacts.size() >= 3);
    CHECK(std::abs(f.deepest() + depth) < 1e-13);
    for (const Vec3& arm : f.contacts.arm) CHECK(std::sqrt(arm.x() * arm.x() + arm.y() * arm.y()) < 0.3 + 1e-12);
  }
}
