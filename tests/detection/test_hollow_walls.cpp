// Tubes and cones against their sampled surfaces, against solid cylinders, and in cases known exactly.
#include <numbers>

#include "detection/narrow/narrow_phase.h"
#include "detection/surfaces/tessellate.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/united_contacts.h"

using namespace epafi;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

using testing::pi;

template <class A, class B>
ContactSet touches(const A& a, const Pose& pa, const B& b, const Pose& pb, double reach, bool curvature = false) {
  ContactSet out;
  out.with_curvature = curvature;
  ContactSink sink(out);
  sink.begin(0, 1);
  if constexpr (HollowShape<B>)
    collide_closed(a, b, PairQuery{pa, pb, reach, curvature}, sink);
  else
    collide(a, b, PairQuery{pa, pb, reach, curvature}, sink);
  sink.end();
  return out;
}

std::size_t deepest_of(const ContactSet& c) {
  return static_cast<std::size_t>(std::min_element(c.gap.begin(), c.gap.end()) - c.gap.begin());
}

/// The point of the surface nearest to x, wall's axes, by sampling, each time finer about the best.
Vec3 nearest_sampled(const HollowWall& wall, const Vec3& x) {
  // the outline as one line: start disc from the axis out, side, end disc back to the axis
  const double start = wall.closed ? wall.start_radius : 0.0, end = wall.closed ? wall.end_radius : 0.0;
  const double whole = start + wall.side_length + end;
  const auto at = [&](double s, double angle) {
    double r = s, z = -wall.half_length;
    if (s >= start) {
      const double t = std::min(1.0, (s - start) / wall.side_length);
      r = (1.0 - t) * wall.start_radius + t * wall.end_radius;
      z = (2.0 * t - 1.0) * wall.half_length;
    }
    if (s > start + wall.side_length) r = whole - s;
    return Vec3(r * std::cos(angle), r * std::sin(angle), z);
  };
  double best_s = 0.0, best_angle = 0.0, least = infinity, width_s = whole, width_angle = pi;
  for (int round = 0; round < 60; ++round) {
    const double s0 = best_s, angle0 = best_angle;
    const int n = round == 0 ? 48 : 6;
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j) {
        const double s = std::clamp(s0 + width_s * i / n, 0.0, whole), angle = angle0 + width_angle * j / n;
        const double d = (at(s, angle) - x).squaredNorm();
        if (d < least) {
          least = d;
          best_s = s;
          best_angle = angle;
        }
      }
    width_s *= round == 0 ? 0.1 : 0.6;
    width_angle *= 0.65;  // slowly: near the axis the angle is known last
  }
  return at(best_s, best_angle);
}

HollowWall random_wall(Random& random, double scale) {
  const double radius = scale * random.uniform(0.2, 1.0), length = scale * random.uniform(0.2, 2.0);
  const double taper = random.uniform(0.0, 1.0) < 0.3 ? 0.0 : random.uniform(0.0, 80.0) * pi / 180.0;
  const double other = std::max(0.0, radius - length * std::tan(taper));
  const bool closed = random.uniform(0.0, 1.0) < 0.5;
  if (taper == 0.0) return Tube(radius, length, closed).wall;
  return random.uniform(0.0, 1.0) < 0.5 ? Cone(radius, other, length, closed).wall
                                        : Cone(other, radius, length, closed).wall;
}

Vec3 place_near(Random& random, const HollowWall& wall) {
  const double angle = random.uniform(0.0, 2.0 * pi), r = 1.4 * wall.most_radius() * random.uniform(0.0, 1.0);
  return {r * std::cos(angle), r * std::sin(angle), 1.4 * wall.half_length * random.uniform(-1.0, 1.0)};
}

Pose random_pose(Random& random, double scale) {
  return {scale * testing::random_point(random), testing::random_turn(random)};
}

}  // namespace

TEST_CASE("the deepest contact of a ball with a tube or cone is at the nearest point of its surface",
          "[detection][hollow]") {
  Random random(31, 0);
  for (int k = 0; k < 200; ++k) {
    const double scale = std::pow(10.0, random.uniform(-3.0, 3.0));
    const HollowWall wall = random_wall(random, scale);
    const Pose pose = random_pose(random, scale);
    const Vec3 centre = place_near(random, wall);
    const Vec3 nearest = nearest_sampled(wall, centre);
    const double distance = (nearest - centre).norm();
    const double radius = distance * random.uniform(0.7, 1.3);
    const auto c =
        touches(Sphere{radius}, {pose.to_world(centre), testing::random_turn(random)},
                Cone(wall.start_radius, wall.end_radius, 2.0 * wall.half_length, wall.closed), pose, 2.0 * scale);
    INFO("case " << k << ": radii " << wall.start_radius << " " << wall.end_radius << " length "
                 << 2.0 * wall.half_length << (wall.closed ? " closed" : " open") << " centre " << centre.transpose());
    REQUIRE(c.size() >= 1);
    const std::size_t i = deepest_of(c);
    // the last grid is 1e-11 of the first, so that the sampled distance is exact to rounding
    CHECK_THAT(c.gap[i], WithinAbs(distance - radius, 1e-9 * scale));
    const Vec3 towards = pose.orientation * ((nearest - centre) / distance);
    if (distance > 0.01 * scale) CHECK((c.normal[i] - towards).norm() < 1e-5);  // the root of 1e-9 over 0.01
    CHECK((c.arm[i] - radius * c.normal[i]).norm() < 1e-12 * radius);
  }
}

TEST_CASE("a ball touches side and disc in a corner, the rim of an open end, and both sides of a narrow cone",
          "[detection][hollow]") {
  const Pose here{};
  const auto at = [](double x, double z) { return Pose{{x, 0.0, z}, Quat(1, 0, 0, 0)}; };
  const Tube closed(1.0, 2.0, true), open(1.0, 2.0, false);
  const auto corner = touches(Sphere{0.2}, at(0.81, 0.82), closed, here, 0.0);
  REQUIRE(corner.size() == 2);
  CHECK_THAT(corner.gap[0], WithinAbs(-0.01, 1e-14));
  CHECK((corner.normal[0] - Vec3(1, 0, 0)).norm() < 1e-15);
  CHECK_THAT(corner.gap[1], WithinAbs(-0.02, 1e-14));
  CHECK((corner.normal[1] - Vec3(0, 0, 1)).norm() < 1e-15);
  // from outside on the disc, on the side, and over the corner
  CHECK_THAT(touches(Sphere{0.2}, at(0.5, 1.19), closed, here, 0.0).gap.at(0), WithinAbs(-0.01, 1e-14));
  CHECK_THAT(touches(Sphere{0.2}, at(1.19, 0.5), closed, here, 0.0).gap.at(0), WithinAbs(-0.01, 1e-14));
  CHECK_THAT(touches(Sphere{0.2}, at(1.12, 1.12), closed, here, 0.0).gap.at(0),
             WithinAbs(0.12 * std::sqrt(2.0) - 0.2, 1e-14));
  CHECK(touches(Sphere{0.2}, at(0.5, 1.19), open, here, 0.0).size() == 0);
  // a ball that is wider than the tube lies on its rim, on both sides
  const auto rim = touches(Sphere{1.25}, at(0.0, 1.0 + 0.74), open, here, 0.0);
  REQUIRE(rim.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) CHECK_THAT(rim.gap[k], WithinAbs(std::sqrt(1.0 + 0.74 * 0.74) - 1.25, 1e-14));
  CHECK((rim.normal[0] + rim.normal[1]).head<2>().norm() < 1e-14);
  // in a cone of 45 degrees a ball on the axis touches where its distance to the side is z/sqrt(2)
  const auto wedged = touches(Sphere{0.71}, at(0.0, 0.0), Cone(0.0, 2.0, 2.0, false), here, 0.0);
  REQUIRE(wedged.size() == 2);
  CHECK_THAT(wedged.gap[0], WithinAbs(std::sqrt(0.5) - 0.71, 1e-14));
}

TEST_CASE("the radius of a ball's contact has the wall's curvature, negative inside", "[detection][hollow]") {
  for (const double ratio : {1e-6, 0.01, 0.2, 0.39, 0.41, 0.7, 0.89}) {
    const double r = ratio, inside = 0.5 * (1.0 / r - 1.0), outside = 0.5 * (1.0 / r + 1.0);
    CHECK_THAT(wall_contact_radius(r, -1.0), WithinRel(hertz_radius(inside, 0.5 / r), 1e-11));
    CHECK_THAT(wall_contact_radius(r, 1.0), WithinRel(hertz_radius(0.5 / r, outside), 1e-11));
    const auto c = touches(Sphere{r}, {{1.0 - r, 0, 0}, Quat(1, 0, 0, 0)}, Tube(1.0, 4.0, false), {}, 1e-9, true);
    CHECK_THAT(c.effective_radius.at(0), WithinRel(wall_contact_radius(r, -1.0), 1e-11));
  }
  CHECK(wall_contact_radius(0.3, 0.0) == Approx(0.3));
}

namespace {

/// Least room between sampled points of a body and the side, seen from inside.
template <class S>
double least_room(const S& body, const Pose& in_wall, const HollowWall& wall, Random& random) {
  double least = infinity;
  Vec3 best = Vec3::UnitX();
  for (int k = 0; k < 6000; ++k) {
    const double wide = k < 2000 ? 1.0 : std::pow(0.995, k - 2000);
    const Vec3 d = (k < 2000 ? testing::random_direction(random)
                             : Vec3(best + wide * testing::random_direction(random)).normalized());
    const Vec3 local = in_wall.orientation.conjugate() * d;
    const Vec3 x = in_wall.position + in_wall.orientation * body.support(local) + body.rounding() * d;
    const double room = -wall.beyond_side(std::hypot(x.x(), x.y()), x.z());
    if (room < least) {
      least = room;
      best = d;
    }
  }
  return least;
}

template <class S, class Make>
void check_inside(const Make& make, double tolerance) {
  Random random(33, 1);
  for (int k = 0; k < 12; ++k) {
    const S body = make(random);
    const double slope = random.uniform(0.0, 1.0), middle = random.uniform(2.0, 3.0);
    const Cone cone(middle - 3.0 * slope * 0.5, middle + 3.0 * slope * 0.5, 6.0, false);
    if (!(cone.wall.start_radius > 1.2)) continue;
    const Pose wall = random_pose(random, 1.0);
    const Pose in_wall{{random.uniform(0.0, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.3, 0.3)},
                       testing::random_turn(random)};
    const Pose pose{wall.to_world(in_wall.position), wall.orientation * in_wall.orientation};
    const double least = least_room(body, in_wall, cone.wall, random);
    const auto c = touches(body, pose, cone, wall, 10.0);
    INFO(S::name << " case " << k);
    REQUIRE(c.size() >= 1);
    CHECK_THAT(c.gap[deepest_of(c)], WithinAbs(least, tolerance));
  }
}

}  // namespace

TEST_CASE("each ball of a clump touches a tube or cone at the nearest point of the surface", "[detection][hollow]") {
  Random random(65, 3);
  for (int k = 0; k < 40; ++k) {
    const double scale = std::pow(10.0, random.uniform(-3.0, 3.0));
    const HollowWall wall = random_wall(random, scale);
    ShapeStore shapes;
    World world{Columns{.rotation = true}};
    Body body;
    const Pose pose = random_pose(random, scale);
    Clump clump;
    Body hollow;
    hollow.position = pose.position;
    hollow.orientation = pose.orientation;
    hollow.shape = shapes.add(Cone(wall.start_radius, wall.end_radius, 2.0 * wall.half_length, wall.closed)).packed;
    body.position = pose.to_world(place_near(random, wall));
    body.orientation = testing::random_turn(random);
    body.mass = 1.0;
    body.inertia = Vec3::Ones();
    std::vector<double> distance;
    for (int i = 0; i < 4; ++i) {
      const Vec3 centre = 0.3 * scale * testing::random_point(random);
      const Vec3 x = pose.to_local(Pose{body.position, body.orientation}.to_world(centre));
      distance.push_back((nearest_sampled(wall, x) - x).norm());
      clump.parts.push_back({centre, distance.back() * random.uniform(0.7, 1.3)});
    }
    body.shape = shapes.add(clump).packed;
    const bool wall_first = k % 2 == 0;
    world.add(wall_first ? hollow : body);
    world.add(wall_first ? body : hollow);
    PairList pairs;
    pairs.pairs.push_back({0, 1});
    pairs.margin = scale;
    BatchNarrowPhase narrow(shapes, 0.0, true);
    ContactSet found;
    narrow.collide(world, pairs, found);
    for (std::size_t i = 0; i < 4; ++i) {
      double deepest = infinity;
      for (std::size_t c = 0; c < found.size(); ++c)
        if ((found.feature[c] >> 48 & 0xff) == i) deepest = std::min(deepest, found.gap[c]);
      const double gap = distance[i] - clump.parts[i].radius;
      INFO("case " << k << " ball " << i << " gap " << gap / scale << " found " << deepest / scale);
      if (gap < 0.0)
        CHECK_THAT(deepest, WithinAbs(gap, 1e-9 * scale));
      else
        CHECK(deepest == infinity);
    }
  }
}

TEST_CASE("inside a tube or cone the deepest point of a convex body is the one of its sampled surface",
          "[detection][hollow]") {
  const auto size = [](Random& random) {
    return Vec3(random.uniform(0.2, 0.6), random.uniform(0.2, 0.6), random.uniform(0.2, 0.6));
  };
  // sampling climbs to 1e-6 of the size where the surface is smooth; corners are found exactly
  check_inside<Box>([&](Random& r) { return Box(size(r)); }, 1e-12);
  check_inside<Capsule>([&](Random& r) { return Capsule(0.5 * size(r).x(), size(r).y()); }, 1e-5);
  check_inside<Cylinder>([&](Random& r) { return Cylinder(size(r).x(), size(r).y()); }, 1e-5);
  check_inside<Ellipsoid>([&](Random& r) { return Ellipsoid(size(r)); }, 1e-5);
  check_inside<Superquadric>([&](Random& r) { return Superquadric(size(r), 4, 4); }, 1e-5);
}

TEST_CASE("outside a tube a convex body meets what it meets at a solid cylinder", "[detection][hollow]") {
  Random random(34, 2);
  const Tube tube(0.7, 3.0, true);
  const Cylinder solid(0.7, 3.0);
  const auto check = [&](const auto& body, double tolerance) {
    for (int k = 0; k < 12; ++k) {
      const Pose wall = random_pose(random, 1.0);
      const double angle = random.uniform(0.0, 2.0 * pi), out = random.uniform(0.9, 1.2);
      const Pose in_wall{{out * std::cos(angle), out * std::sin(angle), random.uniform(-1.4, 1.9)},
                         testing::random_turn(random)};
      const Pose pose{wall.to_world(in_wall.position), wall.orientation * in_wall.orientation};
      const auto c = touches(body, pose, tube, wall, 2.0), s = touches(body, pose, solid, wall, 2.0);
      REQUIRE(c.size() >= 1);
      REQUIRE(s.size() >= 1);
      CHECK_THAT(c.gap[deepest_of(c)], WithinAbs(s.gap[deepest_of(s)], tolerance));
    }
  };
  // both searches stop at 1e-10 of the size
  check(Box({0.3, 0.2, 0.25}), 1e-9);
  check(Ellipsoid({0.3, 0.2, 0.25}), 1e-8);
  check(Capsule(0.2, 0.4), 1e-9);
}

TEST_CASE("on the rim of an open tube bodies rest where the rim crosses them", "[detection][hollow]") {
  const Tube tube(1.0, 2.0, false);
  const auto at = [](double x, double z, const Quat& turn) { return Pose{{x, 0.0, z}, turn}; };
  // a lid
  const auto lid = touches(Box({1.5, 1.5, 0.1}), at(0.2, 1.09, Quat(1, 0, 0, 0)), tube, {}, 0.0);
  REQUIRE(lid.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK_THAT(lid.gap[k], WithinAbs(-0.01, 1e-12));
    CHECK((lid.normal[k] - Vec3(0, 0, -1)).norm() < 1e-9);
  }
  // a cube whose lower edge lies across the opening, along x: it touches at x = -1 and 1
  const Quat on_edge(Eigen::AngleAxisd(0.25 * pi, Vec3::UnitX()));
  const double half = 1.2, low = half * std::sqrt(2.0);
  const auto cube = touches(Box({half, half, half}), at(0.0, 1.0 + low - 0.01, on_edge), tube, {}, 0.0);
  REQUIRE(cube.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK_THAT(cube.gap[k], WithinAbs(-0.01, 1e-6));
    CHECK((cube.normal[k] - Vec3(0, 0, -1)).norm() < 1e-5);
    CHECK_THAT(std::abs(cube.arm[k].x()), WithinAbs(1.0, 1e-5));
  }
  // a capsule across it
  const Quat lying(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitY()));
  const auto rod = touches(Capsule(0.3, 4.0), at(0.0, 1.29, lying), tube, {}, 0.0);
  REQUIRE(rod.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) CHECK_THAT(rod.gap[k], WithinAbs(-0.01, 1e-9));
  // a rod that stands in it, tilted, leans on the rim: distance of the rim's point to the rod's axis
  const double tilt = 0.3;
  const auto leaning =
      touches(Capsule(0.1, 8.0), at(0.8, 1.0, Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()))), tube, {}, 0.5);
  REQUIRE(leaning.size() >= 1);
  CHECK_THAT(leaning.gap[deepest_of(leaning)], WithinAbs(0.2 * std::cos(tilt) - 0.1, 1e-9));
}

TEST_CASE("a cylinder that lies in a tube touches it along two points, one that stands on its closed end on the end",
          "[detection][hollow]") {
  const Tube tube(1.0, 4.0, true);
  const auto lying = touches(Cylinder(0.4, 1.0), {{0.61, 0, 0.2}, Quat(1, 0, 0, 0)}, tube, {}, 0.0);
  REQUIRE(lying.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK_THAT(lying.gap[k], WithinAbs(-0.01, 1e-12));
    CHECK((lying.normal[k] - Vec3(1, 0, 0)).norm() < 1e-6);
  }
  const auto standing = touches(Cylinder(0.4, 1.0), {{0.2, 0, -1.51}, Quat(1, 0, 0, 0)}, tube, {}, 0.0);
  REQUIRE(standing.size() >= 3);
  for (std::size_t k = 0; k < standing.size(); ++k) {
    CHECK_THAT(standing.gap[k], WithinAbs(-0.01, 1e-12));
    CHECK((standing.normal[k] - Vec3(0, 0, -1)).norm() < 1e-12);
  }
}

TEST_CASE("a tube and a cone are drawn on their surface, with their discs", "[detection][hollow]") {
  for (const bool closed : {false, true}) {
    const Cone cone(0.5, 1.5, 2.0, closed);
    const TriangleSurface drawn = tessellate(cone, {.segments = 192});
    double area = 0.0;
    for (const Triangle& t : drawn.triangles) {
      const Vec3 &a = drawn.vertices[t[0]], &b = drawn.vertices[t[1]], &c = drawn.vertices[t[2]];
      area += 0.5 * (b - a).cross(c - a).norm();
      for (const std::uint32_t k : t) CHECK(cone.wall.distance(drawn.vertices[k]) < 1e-15);
    }
    const double exact = pi * 2.0 * std::sqrt(5.0) + (closed ? pi * 2.5 : 0.0);
    CHECK(area == Approx(exact).epsilon(3e-4));  // sin(x)/x of a step: x^2/6 = 1.8e-4
  }
}

namespace {

/// Of a ball with walls that act as one surface.
template <class A, class B>
ContactSet of_joined(const A& a, double za, const B& b, double zb, double radius, const Vec3& centre) {
  ShapeStore shapes;
  World world(Columns{.rotation = true});
  Body body;
  body.shape = shapes.add(a).packed;
  body.position = {0, 0, za};
  world.add(body);
  body.shape = shapes.add(b).packed;
  body.position = {0, 0, zb};
  world.add(body);
  body.shape = shapes.add(Sphere{radius}).packed;
  body.position = centre;
  body.mass = 1.0;
  body.inertia = Vec3::Ones();
  world.add(body);
  return testing::united_contacts_of_last(world, shapes);
}

}  // namespace

TEST_CASE("tubes and cones that meet at their rims are one wall for a ball beside the seam", "[detection][hollow]") {
  Random random(35, 3);
  const Tube upper(1.0, 2.0, false), lower(1.0, 3.0, false);
  const Cone funnel(0.3, 1.0, 1.0, false);
  for (int k = 0; k < 200; ++k) {
    const double r = random.uniform(0.05, 0.3), depth = random.uniform(1e-5, 0.02) * r;
    const double angle = random.uniform(0.0, 2.0 * pi), side = k % 2 == 0 ? 1.0 : -1.0;
    // two tubes, from either side, within and beyond the range where the other's rim is felt
    const double out = 1.0 + side * (r - depth), z = random.uniform(-1.0, 1.0) * 2.0 * std::sqrt(2.0 * r * depth);
    const auto c = of_joined(upper, 1.0, lower, -1.5, r, {out * std::cos(angle), out * std::sin(angle), z});
    REQUIRE(c.size() == 1);
    CHECK_THAT(c.gap[0], WithinAbs(-depth, 1e-12));
    // from outside, where tube and funnel bend away from each other
    const double bend = random.uniform(0.0, 1.0) * std::atan(0.7);
    const Vec3 n(std::cos(bend), 0.0, -std::sin(bend));
    const auto edge = of_joined(upper, 1.0, funnel, -0.5, r, Vec3(1, 0, 0) + (r - depth) * n);
    REQUIRE(edge.size() == 1);
    CHECK_THAT(edge.gap[0], WithinAbs(-depth, 1e-12));
    const auto above = of_joined(upper, 1.0, funnel, -0.5, r, {1.0 + r - depth, 0.0, std::sqrt(r * depth)});
    REQUIRE(above.size() == 1);
    CHECK_THAT(above.gap[0], WithinAbs(-depth, 1e-12));
  }
}
