#include "detection/narrow/polyhedra/manifold.h"

#include <algorithm>
#include <set>

#include "detection/narrow/pairs/half_space_pairs.h"
#include "detection/narrow/pairs/sphere_pairs.h"
#include "detection/shapes/half_space.h"
#include "tests/detection/mesh_floors.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using testing::upright;

namespace {

Patch patch_of(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb, double reach = 0.0) {
  const PolyhedronPair pair(a.view(), b.view(), pa, pb);
  return contact_patch(pair, polyhedron_distance(pair, reach + a.sweep + b.sweep), reach, a.sweep, b.sweep);
}
std::set<Feature> features(const Patch& p) {
  std::set<Feature> out;
  for (int k = 0; k < p.count; ++k) out.insert(p.point[static_cast<std::size_t>(k)].feature);
  return out;
}

}  // namespace

TEST_CASE("a box resting on a larger one touches at its four lower corners", "[detection][manifold]") {
  const Box floor(Vec3(2, 2, 0.5)), box(Vec3(0.5, 0.25, 0.5));
  const Patch p = patch_of(floor.hull, {}, box.hull, {{0.3, 0.1, 0.99}, upright});
  REQUIRE(p.count == 4);
  Vec3 sum = Vec3::Zero();
  for (const PatchPoint& c : std::span(p.point).first(static_cast<std::size_t>(p.count))) {
    CHECK(c.gap == Approx(-0.01).epsilon(1e-12));
    CHECK(c.position.z() == Approx(0.495).epsilon(1e-14));  // midway between 0.5 and 0.49
    CHECK(std::abs(std::abs(c.position.x() - 0.3) - 0.5) < 1e-14);
    CHECK(std::abs(std::abs(c.position.y() - 0.1) - 0.25) < 1e-14);
    sum += c.position;
  }
  CHECK((sum / 4 - Vec3(0.3, 0.1, 0.495)).norm() < 1e-14);
  CHECK(features(p).size() == 4);
}

TEST_CASE("equal boxes stacked exactly keep their features under jitter, whichever body is A",
          "[detection][manifold]") {
  const Box box(Vec3::Constant(0.5));
  Random random(51, 0);
  const auto straight = features(patch_of(box.hull, {}, box.hull, {{0, 0, 0.999}, upright}));
  REQUIRE(straight.size() == 4);
  for (int k = 0; k < 200; ++k) {
    const Vec3 slip = 1e-8 * testing::random_point(random);
    const Quat tilt(Eigen::AngleAxisd(1e-8 * random.uniform(), testing::random_direction(random)));
    const Patch p = patch_of(box.hull, {}, box.hull, {Vec3(0, 0, 0.999) + slip, tilt});
    CHECK(features(p) == straight);
  }
}

TEST_CASE("crossed edges and a tip touch in one point midway between the surfaces", "[detection][manifold]") {
  const Box cube(Vec3::Constant(0.5));
  const double half = std::sqrt(0.5), depth = 0.02;  // from the centre to an edge
  const Quat about_x(Eigen::AngleAxisd(std::atan(1.0), Vec3::UnitX())),
      about_y(Eigen::AngleAxisd(std::atan(1.0), Vec3::UnitY()));
  const Patch edges = patch_of(cube.hull, {{0, 0, 0}, about_x}, cube.hull, {{0, 0, 2 * half - depth}, about_y});
  REQUIRE(edges.count == 1);
  CHECK(edges.point[0].gap == Approx(-depth).epsilon(1e-12));
  const Vec3 x = about_x * edges.point[0].position;  // world axes
  CHECK((x - Vec3(0, 0, half - 0.5 * depth)).norm() < 1e-12);
  const double tip = std::sqrt(0.75);  // a cube on its corner
  const Quat on_corner = Quat::FromTwoVectors(Vec3(1, 1, 1), Vec3::UnitZ());
  const Patch corner = patch_of(cube.hull, {}, cube.hull, {{0.1, -0.05, 0.5 + tip - depth}, on_corner});
  REQUIRE(corner.count == 1);
  CHECK(corner.point[0].gap == Approx(-depth).epsilon(1e-12));
  CHECK((corner.point[0].position - Vec3(0.1, -0.05, 0.5 - 0.5 * depth)).norm() < 1e-12);
}

TEST_CASE("a rounded box meets a plane with its rounding", "[detection][manifold]") {
  ConvexHull stone = Box(Vec3::Constant(0.5)).hull;
  stone.sweep = 0.1;
  const double depth = 0.01;
  ContactSet contacts;
  ContactSink sink(contacts);
  sink.begin(0, 1);
  collide_with_plane(stone.view(), stone.sweep, 1.0, HalfSpace{Vec3::UnitZ()},
                     PairQuery{{{0.2, 0.3, 0.6 - depth}, upright}, {{0, 0, 0}, upright}}, sink);
  sink.end();
  REQUIRE(contacts.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(contacts.gap[i] == Approx(-depth).epsilon(1e-12));
    CHECK(contacts.arm[i].z() == Approx(-0.6 + 0.5 * depth).epsilon(1e-12));  // midway between surface and plane
    CHECK(contacts.normal[i] == Vec3(0, 0, -1));
  }
}

TEST_CASE("a ball meets a rounded box with the rounding of both", "[detection][manifold]") {
  ConvexHull stone = Box(Vec3::Constant(0.5)).hull;
  stone.sweep = 0.1;
  for (const Vec3& way : {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1)}) {  // over a face, an edge, a corner
    const double depth = 0.01, reach = way.norm() * 0.5 + 0.2 + 0.1 - depth;
    ContactSet contacts;
    ContactSink sink(contacts);
    sink.begin(0, 1);
    collide_closed(Sphere{0.2}, stone, PairQuery{{reach * way.normalized(), upright}, {{0, 0, 0}, upright}}, sink);
    sink.end();
    REQUIRE(contacts.size() == 1);
    CHECK(contacts.gap[0] == Approx(-depth).epsilon(1e-9));
  }
}

TEST_CASE("each point of a tilted contact has its own gap", "[detection][manifold]") {
  const Box floor(Vec3(2, 2, 0.5)), box(Vec3::Constant(0.5));
  const double angle = 1e-3;
  const Pose pose{{0, 0, 0.999}, Quat(Eigen::AngleAxisd(angle, Vec3::UnitY()))};
  const Patch p = patch_of(floor.hull, {}, box.hull, pose, 0.01);
  REQUIRE(p.count == 4);
  for (const PatchPoint& c : std::span(p.point).first(static_cast<std::size_t>(p.count))) {
    // The lower corner above or below c, by the rotation matrix.
    const double side = c.position.x() > 0 ? 0.5 : -0.5;
    const double height = 0.999 - side * std::sin(angle) - 0.5 * std::cos(angle);
    CHECK(std::abs(c.gap - (height - 0.5)) < 1e-14);
  }
  // Without reach only the corners below the floor are contacts.
  CHECK(patch_of(floor.hull, {}, box.hull, {{0, 0, 1.0001}, pose.orientation}).count == 2);
}

TEST_CASE("a corner on a face and crossed edges give one point", "[detection][manifold]") {
  const Box floor(Vec3(2, 2, 0.5)), box(Vec3::Constant(0.5));
  // Body diagonal vertical: the corner is sqrt(3)/2 below the centre.
  const Quat diagonal = Quat::FromTwoVectors(Vec3(1, 1, 1), Vec3::UnitZ());
  const Patch corner = patch_of(floor.hull, {}, box.hull, {{0.1, 0.2, 0.5 + std::sqrt(0.75) - 1e-3}, diagonal});
  REQUIRE(corner.count == 1);
  CHECK(corner.point[0].gap == Approx(-1e-3).epsilon(1e-10));
  CHECK((corner.point[0].position - Vec3(0.1, 0.2, 0.4995)).norm() < 1e-13);
  CHECK(corner.point[0].feature >> 44 == static_cast<Feature>(FeatureKind::vertex_b));
  const double quarter = std::atan(1.0);
  const Patch edges = patch_of(box.hull, {Vec3::Zero(), Quat(Eigen::AngleAxisd(quarter, Vec3::UnitX()))}, box.hull,
                               {{0.1, 0.05, std::sqrt(2.0) - 1e-3}, Quat(Eigen::AngleAxisd(quarter, Vec3::UnitY()))});
  REQUIRE(edges.count == 1);
  CHECK(edges.point[0].gap == Approx(-1e-3).epsilon(1e-10));
}

TEST_CASE("octagonal overlaps keep four points and the deepest", "[detection][manifold]") {
  const Box floor(Vec3(0.5, 0.5, 0.5)), box(Vec3(0.5, 0.5, 0.5));
  const double eighth = std::atan(1.0);
  const Quat turn =
      Quat(Eigen::AngleAxisd(1e-4, Vec3(1, 0.3, 0).normalized())) * Quat(Eigen::AngleAxisd(eighth, Vec3::UnitZ()));
  const PolyhedronPair pair(floor.view(), box.view(), {}, {{0, 0, 0.99}, turn});
  const auto d = polyhedron_distance(pair);
  const Patch p = contact_patch(pair, d, 0.0, 0.0, 0.0);
  REQUIRE(p.count == 4);
  double deepest = 0.0;
  for (const PatchPoint& c : std::span(p.point).first(static_cast<std::size_t>(p.count)))
    deepest = std::min(deepest, c.gap);
  CHECK(std::abs(deepest - d.axis.gap) < 1e-14);
  // Area of the kept quadrilateral: at least that of the inscribed square of the octagon's corners, 1/2 of the unit
  // square.
  std::array<Vec3, 4> q{p.point[0].position, p.point[1].position, p.point[2].position, p.point[3].position};
  const double area =
      0.5 * std::abs((q[1] - q[0]).cross(q[2] - q[0]).z()) + 0.5 * std::abs((q[1] - q[0]).cross(q[3] - q[0]).z());
  CHECK(area > 0.5);
}

TEST_CASE("of six corners the deepest is kept in its own place", "[detection][manifold]") {
  std::vector<PatchPoint> corners;
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double turn = static_cast<double>(k) * std::atan(1.0) * 4.0 / 3.0;
    corners.push_back(
        {{std::cos(turn), std::sin(turn), 0.0}, k == 5 ? -2e-3 : -1e-3, make_feature(FeatureKind::vertex_a, k, 0)});
  }
  Patch p;
  keep_four(corners, Vec3::UnitZ(), 1.0, p);
  REQUIRE(p.count == 4);
  CHECK(p.point[0].feature == corners[5].feature);
  CHECK(p.point[0].position == corners[5].position);
  CHECK(p.point[0].gap == -2e-3);
  CHECK(p.point[1].feature == corners[2].feature);  // across
  for (int k = 1; k < 4; ++k) CHECK(p.point[static_cast<std::size_t>(k)].gap == -1e-3);
}

TEST_CASE("a needle, all its sides too steep to carry a point, pricks midway between tip and face",
          "[detection][manifold]") {
  // the sides' normals are 1.4 deg from the horizontal
  const ConvexHull needle =
      ConvexHull::from_faces(
          {{0, 0, 1}, {0.03, 0.03, -0.2}, {-0.03, 0.03, -0.2}, {-0.03, -0.03, -0.2}, {0.03, -0.03, -0.2}},
          {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {4, 3, 2, 1}})
          .hull;
  const Box slab(Vec3(2, 2, 0.5));
  const Patch above = patch_of(needle, {}, slab.hull, {{0.3, 0.2, 1.498}, upright});
  const Patch below = patch_of(slab.hull, {}, needle, {{0.3, 0.2, 1.498}, Quat(0, 1, 0, 0)});  // the other way up
  REQUIRE(above.count == 1);
  REQUIRE(below.count == 1);
  CHECK(above.point[0].gap == Approx(-2e-3).epsilon(1e-11));
  CHECK(below.point[0].gap == Approx(-2e-3).epsilon(1e-11));
  CHECK((above.point[0].position - Vec3(0, 0, 0.999)).norm() < 1e-13);
  CHECK((below.point[0].position - Vec3(0.3, 0.2, 0.499)).norm() < 1e-13);
}

TEST_CASE("swept boxes touch at their skins with the same four points", "[detection][manifold]") {
  Box floor(Vec3(2, 2, 0.5)), box(Vec3::Constant(0.5));
  floor.hull.sweep = 0.05;
  box.hull.sweep = 0.02;
  const Patch p = patch_of(floor.hull, {}, box.hull, {{0, 0, 1.06}, upright});
  REQUIRE(p.count == 4);
  for (const PatchPoint& c : std::span(p.point).first(static_cast<std::size_t>(p.count))) {
    CHECK(c.gap == Approx(-0.01).epsilon(1e-11));
    CHECK(c.position.z() == Approx(0.545).epsilon(1e-13));  // between 0.55 (floor's skin) and 0.54
  }
}

TEST_CASE("patches of random overlapping hulls hold the pair's depth and lie within the overlap",
          "[detection][manifold]") {
  Random random(52, 0);
  int overlaps = 0;
  for (int k = 0; k < 400; ++k) {
    const ConvexHull a = support::random_hull(random, 8 + static_cast<std::size_t>(k % 30)),
                     b = support::random_hull(random, 12);
    const Pose pb{random.uniform(1.2, 2) * testing::random_direction(random), testing::random_turn(random)};
    const PolyhedronPair pair(a.view(), b.view(), {}, pb);
    const auto d = polyhedron_distance(pair);
    const Patch p = contact_patch(pair, d, 0.0, 0.0, 0.0);
    if (d.axis.gap >= 0.0) {
      CHECK(p.count == 0);
      continue;
    }
    ++overlaps;
    REQUIRE(p.count >= 1);
    CHECK(features(p).size() == static_cast<std::size_t>(p.count));
    double deepest = 0.0;
    for (int i = 0; i < p.count; ++i) {
      const auto& c = p.point[static_cast<std::size_t>(i)];
      deepest = std::min(deepest, c.gap);
      CHECK(c.gap >= d.axis.gap - 1e-9);  // nothing is deeper along the normal than the depth
      // Midway between a point of A's face and a point of B's face: no farther from either body than half the overlap.
      const double off = -0.5 * c.gap + 2e-6;
      for (std::size_t f = 0; f < a.face_normals.size(); ++f)
        CHECK(a.face_normals[f].dot(c.position) <= a.face_offsets[f] + off);
      const Vec3 in_b = pb.to_local(c.position);
      for (std::size_t f = 0; f < b.face_normals.size(); ++f)
        CHECK(b.face_normals[f].dot(in_b) <= b.face_offsets[f] + off);
    }
    CHECK(std::abs(deepest - d.axis.gap) < 1.1e-5);
  }
  CHECK(overlaps > 50);
}

TEST_CASE("a slab thinner than the reach touches a plane at its lower corners", "[detection][manifold]") {
  for (const double tilt : {0.0, 1e-6, 1e-3, -1e-3}) {
    const Box slab(Vec3(0.5, 0.5, 5e-4));
    const Pose pose{{0, 0, 5e-4}, Quat(Eigen::AngleAxisd(tilt, Vec3(1, 2, 0).normalized()))};
    ContactSet contacts;
    ContactSink sink(contacts);
    sink.begin(0, 1);
    collide_closed(slab, HalfSpace{}, PairQuery{pose, {}, 0.01}, sink);
    sink.end();
    REQUIRE(contacts.size() == 4);
    std::set<std::uint32_t> lower;
    for (const Feature f : contacts.feature) {
      const std::uint32_t v = feature_vertex_a(f);
      CHECK(slab.hull.vertices[v].z() < 0.0);
      lower.insert(v);
    }
    CHECK(lower.size() == 4);
  }
}

namespace {

/// The body over the top of a slab and over the half-space in its place, in any frame, the slab as A and as B.
template <class S>
std::size_t check_on_slab(const S& body, const Quat& turn, double depth, double reach, Random& random) {
  const Box slab(Vec3(3, 2, 1));
  const Pose frame{10.0 * testing::random_point(random), testing::random_turn(random)};
  const double low = (turn * body.support(turn.conjugate() * Vec3(0, 0, -1))).z() - body.rounding();
  const Vec3 at(random.uniform(-1, 1), random.uniform(-1, 1), 1.0 - low - depth);
  const Pose p{frame.to_world(at), frame.orientation * turn}, plane{frame.to_world(Vec3(0, 0, 1)), frame.orientation};
  ContactSet expected;
  ContactSink sink(expected);
  sink.begin(0, 1);
  collide_closed(body, HalfSpace{}, PairQuery{p, plane, reach}, sink);
  sink.end();
  testing::check_same_contacts(support::contacts(body, p, slab, frame, reach), expected, 1e-8);
  ContactSet turned = support::contacts(slab, frame, body, p, reach);
  for (Vec3& n : turned.normal) n = -n;
  for (Vec3& arm : turned.arm) arm += frame.position - p.position;
  testing::check_same_contacts(turned, expected, 1e-8);
  return expected.size();
}

}  // namespace

TEST_CASE("what is deep in a face of a slab touches it as the plane, with corners of all its own faces",
          "[detection][manifold]") {
  Random random(641, 9);
  int several = 0;
  for (int k = 0; k < 300; ++k) {
    const Quat turn = testing::random_turn(random);
    const double depth = 0.2 * std::pow(10.0, random.uniform(-3, -0.4)), reach = k % 2 == 0 ? 0.0 : 0.5 * depth;
    const double size = random.uniform(0.05, 0.2);
    const std::size_t count =
        k % 4 < 2 ? check_on_slab(support::random_hull(random, 8 + random.bits() % 24, Vec3(0.2, 0.2, size)), turn,
                                  depth, reach, random)
                  : check_on_slab(Box(Vec3(size, 0.1, 0.15)), turn, depth, reach, random);
    several += count > 1;
  }
  CHECK(several > 40);
}
