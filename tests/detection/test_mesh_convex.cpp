// Convex bodies that overlap the closed surface of a hull by less than a hundredth of their size: the surface must hold
// them as the hull would, on faces, edges and corners. The hull's answer is GJK's and EPA's.
#include <fmt/format.h>
#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"

#include <cstdio>

#include "tests/detection/mesh_floors.h"
#include "tests/support/catch.h"
#include "tests/support/mesh_sweep.h"

using namespace epafi;

namespace {

struct Way {
  double gap;
  Vec3 normal;  ///< world axes
};

template <class A, class B>
Way hull_answer(const A& a, const Pose& pa, const B& b, const Pose& pb) {
  const MinkowskiDifference difference(ConvexRef::to(a), ConvexRef::to(b), pa, pb);
  const GjkResult g = gjk(difference);
  if (g.status != GjkResult::Status::overlapping) return {g.lower - a.rounding(), pa.orientation * g.normal};
  const Penetration p = epa(difference);
  return {-p.upper - a.rounding(), pa.orientation * p.normal};
}

/// Deepest contact of the body, slot 0, with the mesh, slot 1; infinite where there is none.
template <class A>
double deepest(const ShapeStore& shapes, const World& world, double reach) {
  ContactSet contacts;
  support::ask_cell<A, TriangleMesh>(shapes, world, reach, contacts);
  return contacts.size() == 0 ? infinity : *std::min_element(contacts.gap.begin(), contacts.gap.end());
}

struct Found {
  int pairs = 0, missed = 0, too_deep = 0, off = 0;
  /// One pair: the deepest gap found against the right one, by 1e-6 of the size.
  void count(double gap, double exact, double size) {
    ++pairs;
    missed += gap == infinity;
    too_deep += gap < exact - 1e-6 * size;
    off += std::abs(gap - exact) > 1e-6 * size;
  }
};

template <class A>
Found held(int count) {
  Random random(501, 0);
  Found out;
  for (int k = 0; k < count; ++k) {
    ShapeStore shapes;
    World world(Columns{.rotation = true, .force = false});
    const A a = support::random_shape<A>(random);
    const ConvexHull hull = support::random_hull(random, 6 + random.bits() % 20);
    Body body;
    body.shape = shapes.add(a).packed;
    body.orientation = testing::random_turn(random);
    world.add(body);
    body.shape = shapes.add(support::surface_of(hull)).packed;
    body.orientation = testing::random_turn(random);
    body.position = (a.bounding_radius() + hull.bounding_radius()) * testing::random_direction(random);
    world.add(body);
    // twice: from apart along the normal to touch, and a little in
    const double size = std::min(a.bounding_radius(), hull.bounding_radius());
    for (int step = 0; step < 2; ++step) {
      const Way now = hull_answer(a, world.pose(0), hull, world.pose(1));
      world.position[1] -= (now.gap + (step == 0 ? 0.0 : random.uniform(0.0, 0.01) * size)) * now.normal;
    }
    const double exact = hull_answer(a, world.pose(0), hull, world.pose(1)).gap;
    const double gap = deepest<A>(shapes, world, 1e-3 * size);
    out.count(gap, exact, size);
  }
  return out;
}

/// Flat bodies laid over faces, edges and corners of the table, tilted by 1e-8 to 0.03 rad, up to a thousandth deep.
template <class A>
Found laid(const A& a, int count, std::uint64_t stream) {
  Random random(502, stream);
  Found out;
  const Vec3 half(0.5, 0.4, 0.3);
  const Box solid(half);
  for (int k = 0; k < count; ++k) {
    ShapeStore shapes;
    World world(Columns{.rotation = true, .force = false});
    Body body;
    body.shape = shapes.add(a).packed;
    const double tilt = k % 5 == 0 ? 0.0 : std::pow(10.0, random.uniform(-8, -1.5));
    const Quat down(
        Eigen::AngleAxisd(0.5 * testing::pi * static_cast<double>(random.bits() % 4), Vec3::Unit(random.bits() % 3)));
    const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
    const Quat in_table = Quat(Eigen::AngleAxisd(tilt, testing::random_direction(random))) * yaw * down;
    const Quat turn = testing::random_turn(random);
    body.orientation = turn * in_table;
    const Vec3 at(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.3 + a.bounding_radius());
    body.position = turn * at;
    world.add(body);
    body.shape =
        shapes.add(TriangleMesh::from_surface(support::table_surface(half, 1 + random.bits() % 4, random))).packed;
    body.orientation = turn;
    body.position = Vec3::Zero();
    world.add(body);
    const double size = a.bounding_radius();
    const double depth = std::pow(10.0, random.uniform(-7, -3)) * size;
    for (int step = 0; step < 2; ++step) {
      const Way now = hull_answer(a, world.pose(0), solid, world.pose(1));
      world.position[1] -= (now.gap + (step == 0 ? 0.0 : depth)) * now.normal;
    }
    const double exact = hull_answer(a, world.pose(0), solid, world.pose(1)).gap;
    const double gap = deepest<A>(shapes, world, 1e-3 * size);
    out.count(gap, exact, size);
  }
  return out;
}

/// How far x is from the surface of a box or cylinder along its nearest side; inside and outside alike.
double off_box(const Vec3& half, const Vec3& x) { return std::abs((x.cwiseAbs() - half).maxCoeff()); }
double off_cylinder(const Cylinder& c, const Vec3& x) {
  return std::abs(std::max(std::abs(x.z()) - c.half_length(), std::hypot(x.x(), x.y()) - c.radius));
}

/// A cylinder that leans on the rim of the table by its side, its end or its own rim: every contact joins a point of
/// its surface with one of the table's, as far apart as it says, and the deepest is the way out of the solid.
void check_leaning(Random& random) {
  const Vec3 half(0.5, 0.4, 0.3);
  const Box solid(half);
  const Cylinder can(random.uniform(0.05, 0.3), random.uniform(0.02, 0.6));
  const double size = can.bounding_radius(), depth = std::pow(10.0, random.uniform(-6, -2.5)) * size;
  ShapeStore shapes;
  World world(Columns{.rotation = true, .force = false});
  Body body;
  body.shape = shapes.add(can).packed;
  const Vec3 axis(std::cos(random.uniform(0, 6)), std::sin(random.uniform(0, 6)), 0.0);
  body.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.05, 1.5), axis.normalized()));
  const double side = random.uniform(-1.0, 1.0) * half.y();
  body.position =
      Vec3(half.x(), side, half.z()) + size * Vec3(random.uniform(-0.5, 1.0), 0.0, random.uniform(0.2, 1.0));
  world.add(body);
  body.shape = shapes.add(TriangleMesh::from_surface(support::table_surface(half, 3, random))).packed;
  body.orientation = testing::upright;
  body.position = Vec3::Zero();
  world.add(body);
  for (int step = 0; step < 20; ++step) {
    const Way now = hull_answer(can, world.pose(0), solid, world.pose(1));
    world.position[0] += (now.gap + depth) * now.normal;
  }
  ContactSet found;
  support::ask_cell<Cylinder, TriangleMesh>(shapes, world, 0.0, found);
  const double exact = hull_answer(can, world.pose(0), solid, world.pose(1)).gap;
  REQUIRE(found.size() > 0);
  CHECK(*std::min_element(found.gap.begin(), found.gap.end()) == Approx(exact).margin(1e-6 * size));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Vec3 middle = world.position[0] + found.arm[i], to_wall = 0.5 * found.gap[i] * found.normal[i];
    CHECK(off_box(half, middle + to_wall) < 1e-6 * size);
    // the corners of a round end stand for the rim between them
    CHECK(off_cylinder(can, world.pose(0).to_local(middle - to_wall)) < 1e-6 * size - 0.1 * exact);
  }
}

/// Deepest way out of the parts, world axes.
template <class A>
Way parts_answer(const A& a, const Pose& pa, const std::vector<support::RockPart>& parts, const Pose& plate) {
  Way deepest{infinity, Vec3::Zero()};
  for (const support::RockPart& p : parts) {
    const Way w = hull_answer(a, pa, p.box, {plate.position + plate.orientation * p.centre, plate.orientation});
    if (w.gap < deepest.gap) deepest = w;
  }
  return deepest;
}

/// Flat bodies laid on plates with notches and holes, tilted by up to 0.03 rad, up to a thousandth deep.
template <class A>
Found notched(const A& a, int count, std::uint64_t stream) {
  Random random(503, stream);
  Found out;
  while (out.pairs < count) {
    ShapeStore shapes;
    World world(Columns{.rotation = true, .force = false});
    const int n = 2 + static_cast<int>(random.bits() % 3);
    const support::SteppedRock plate = support::random_rock(random, {n, n, 1});
    const auto parts = support::parts_of(plate);
    const double tilt = random.bits() % 5 == 0 ? 0.0 : std::pow(10.0, random.uniform(-8, -1.5));
    const Quat down(
        Eigen::AngleAxisd(0.5 * testing::pi * static_cast<double>(random.bits() % 4), Vec3::Unit(random.bits() % 3)));
    const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
    const Quat turn = testing::random_turn(random);
    Body body;
    body.shape = shapes.add(a).packed;
    body.orientation = turn * Quat(Eigen::AngleAxisd(tilt, testing::random_direction(random))) * yaw * down;
    const double size = a.bounding_radius();
    body.position = turn * (plate.corner(n, n, 1).cwiseProduct(Vec3(random.uniform(), random.uniform(), 1.0)) +
                            Vec3(0, 0, random.uniform(0.2, 1.0) * size));
    world.add(body);
    body.shape = shapes.add(TriangleMesh::from_surface(support::surface_of(plate, random))).packed;
    body.orientation = turn;
    body.position = Vec3::Zero();
    world.add(body);
    const double depth = std::pow(10.0, random.uniform(-7, -3)) * size;
    Way now{0, Vec3::Zero()};
    for (int step = 0; step < 30; ++step) {
      now = parts_answer(a, world.pose(0), parts, world.pose(1));
      if (std::abs(now.gap + depth) < 1e-9 * size) break;
      world.position[0] += (now.gap + depth) * now.normal;
    }
    if (!(std::abs(now.gap + depth) < 1e-9 * size)) continue;
    const double gap = deepest<A>(shapes, world, 1e-3 * size);
    out.count(gap, now.gap, size);
  }
  return out;
}

/// No contact is missed or too deep; at most `off` are off.
template <class A>
void check_found(const Found& f, int off = 0) {
  INFO(A::name << ": " << f.missed << " missed, " << f.too_deep << " too deep, " << f.off << " off");
  CHECK(f.missed == 0);
  CHECK(f.too_deep == 0);
  CHECK(f.off <= off);
}

template <class A>
void check_laid(const A& a, int count, std::uint64_t stream) {
  check_found<A>(laid(a, count, stream));
}

template <class A>
void check_notched(const A& a, int count, std::uint64_t stream) {
  check_found<A>(notched(a, count, stream));
}

template <class A>
void check_held(int count, int off) {
  check_found<A>(held<A>(count), off);
}

/// Sizes from 0.03 to 0.6 m, up to 1 to 30 for those that may be flat or long.
template <class S>
S random_body(Random& random) {
  const auto size = [&] { return std::pow(10.0, random.uniform(-1.5, -0.2)); };
  const auto sizes = [&] {
    const double x = size(), y = size(), z = size();
    return Vec3(x, y, z);
  };
  if constexpr (std::is_same_v<S, Sphere>)
    return Sphere{size()};
  else if constexpr (std::is_same_v<S, ConvexHull>)
    return support::random_hull(random, 6 + random.bits() % 20, sizes());
  else if constexpr (std::is_same_v<S, Superquadric>) {
    const Vec3 axes = testing::random_point(random, 0.1, 0.3);
    const int second = 2 + static_cast<int>(random.bits() % 7), first = 2 + static_cast<int>(random.bits() % 7);
    return Superquadric(axes, first, second);
  } else if constexpr (std::is_same_v<S, Ellipsoid>)
    return Ellipsoid(testing::random_point(random, 0.05, 0.5));
  else if constexpr (std::is_same_v<S, Clump>) {
    Clump clump;
    const std::size_t count = 2 + random.bits() % 4;
    for (std::size_t k = 0; k < count; ++k)
      clump.parts.push_back({0.2 * testing::random_point(random), random.uniform(0.05, 0.2)});
    return clump;
  } else if constexpr (std::is_same_v<S, SolidParts>) {
    const support::SteppedRock cells =
        support::random_rock(random, {2, 2, 1 + static_cast<int>(random.bits() % 2)}, 0.6);
    return place_solid(support::surface_of(cells, random)).solid;
  } else if constexpr (std::is_constructible_v<S, double, double>) {
    const double second = size(), first = size();
    return S(first, second);
  } else
    return S(sizes());
}

const char* const rock_names[] = {"table", "plate", "steps", "hull", "holed"};

/// Of all poses, those that may be wrong: at corners where faces that bend both ways meet the way out of one region
/// leans on another.
template <class S>
double known_share(support::RockKind kind) {
  if constexpr (std::is_same_v<S, Sphere>) return 0.0;
  if (kind == support::RockKind::holed && PolyhedralShape<S>) return 1e-3;
  const bool steps = kind == support::RockKind::steps;
  if constexpr (std::is_same_v<S, SolidParts>) return steps ? 5e-4 : 2e-4;
  if constexpr (std::is_same_v<S, ConvexHull>) return steps ? 2e-3 : 1e-3;
  if constexpr (std::is_same_v<S, Box>) return steps ? 5e-4 : 1e-4;
  return std::is_same_v<S, Cylinder> && steps ? 2e-4 : 1e-4;
}

template <class S>
void sweep(long count, bool told) {
  for (const support::RockKind kind : {support::RockKind::table, support::RockKind::plate, support::RockKind::steps,
                                       support::RockKind::hull, support::RockKind::holed}) {
    Random random(650, static_cast<std::uint64_t>(kind));
    support::MeshSweep<S> poses(kind, random);
    support::SweepTally t;
    while (t.poses < count / 4) poses.take(random_body<S>(random), t);
    const auto text = fmt::format(
        "{:12} {:6} {:7} poses, {} wrong, {:7} contacts, {} missed, {} too deep, {} off, {} invented, {} crowded, {} "
        "of {} walls "
        "missed, worst {:.1e}",
        S::name, rock_names[static_cast<int>(kind)], t.poses, t.wrong, t.contacts, t.missed, t.too_deep, t.off,
        t.invented, t.crowded, t.missed_walls, t.walls, t.worst);
    if (told) std::puts(text.c_str());
    INFO(text);
    CHECK(static_cast<double>(t.wrong) <= known_share<S>(kind) * static_cast<double>(t.poses));
  }
}

/// A body that crosses the rim of a hole at its corner leans on two sides: neither may let it go, and none is added to
/// what holds it there.
template <class S>
void check_at_holes(long count) {
  Random random(664, 0);
  support::MeshSweep<S> poses(support::RockKind::holed, random);
  support::SweepTally t;
  while (t.poses < count) poses.take(random_body<S>(random), t);
  INFO(S::name << ": " << t.missed << " missed, " << t.off << " off, " << t.invented << " invented of " << t.poses);
  CHECK(t.wrong == 0);
}

template <class... S>
void sweep_all(long count, bool told) {
  (sweep<S>(count, told), ...);
}

}  // namespace

TEST_CASE("a convex surface of triangles holds every body as the solid would, at faces, edges and corners",
          "[detection][mesh][ridge][long]") {
  check_held<Sphere>(400, 0);
  check_held<Capsule>(400, 0);
  check_held<Cylinder>(400, 0);
  check_held<Ellipsoid>(400, 0);
  check_held<Superquadric>(100, 0);
  check_held<Box>(1500, 0);
  check_held<ConvexHull>(1500, 0);
}

TEST_CASE("flat bodies over the edges of a table of triangles are as deep as in the solid",
          "[detection][mesh][ridge]") {
  check_laid(Box(Vec3(0.6, 0.05, 0.01)), 300, 0);
  check_laid(Box(Vec3(0.1, 0.15, 0.2)), 300, 1);
  check_laid(Cylinder(0.1, 0.2), 300, 2);
  check_laid(Cylinder(0.3, 0.02), 300, 3);
}

TEST_CASE("cylinders that lean on the rim of a table touch it where both are", "[detection][mesh][ridge]") {
  Random random(505, 0);
  for (int k = 0; k < 300; ++k) {
    INFO("draw " << k);
    check_leaning(random);
  }
}

TEST_CASE("bodies stand on few points of one normal on a fan of slivers in single precision", "[detection][mesh]") {
  Random random(651, 0);
  for (int draw = 0; draw < 60; ++draw) {
    const std::uint32_t n = static_cast<std::uint32_t>(100 + random.bits() % 300);
    const double width = std::pow(10.0, random.uniform(-2, 0));
    const Pose at{std::pow(10.0, random.uniform(-1, 2)) * testing::random_direction(random),
                  testing::random_turn(random)};
    TriangleSurface fan;
    double most = 0.0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2.0 * testing::pi * k / n;
      const Vec3 exact = at.to_world({std::cos(angle), width * std::sin(angle), 0.0});
      fan.vertices.push_back(exact.cast<float>().cast<double>());
      most = std::max(most, fan.vertices.back().cwiseAbs().maxCoeff());
      if (k > 1) fan.triangles.push_back({0, k - 1, k});
    }
    const TriangleMesh mesh = TriangleMesh::from_surface(fan, std::ldexp(most, -24));
    for (int k = 0; k < 20; ++k) {
      const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
      const Quat tilt(Eigen::AngleAxisd(k % 2 == 0 ? 0.0 : 1e-4, Vec3::UnitX()));
      const Vec3 place(random.uniform(-0.7, 0.7), 0.0, 0.2 - std::pow(10.0, random.uniform(-4, -2)));
      const Pose body{at.to_world(place), at.orientation * tilt * yaw};
      INFO("draw " << draw << ", body " << k << ": " << n << " slivers, width " << width);
      for (const double reach : {0.0, 1e-3})
        CHECK(testing::contacts_with(Box(Vec3(0.15, 0.1, 0.2)), body, mesh, {}, reach).size() <= 6);
    }
  }
}

TEST_CASE("flat bodies over notches and holes of plates are as deep as in the largest of their boxes",
          "[detection][mesh][ridge]") {
  check_notched(Box(Vec3(0.6, 0.05, 0.01)), 300, 0);
  check_notched(Box(Vec3(0.1, 0.15, 0.2)), 300, 1);
  check_notched(Cylinder(0.1, 0.2), 300, 2);
  check_notched(Cylinder(0.3, 0.02), 300, 3);
  check_notched(Sphere(0.1), 300, 4);
}

TEST_CASE("bodies at the corners of holes are held as by the solids inside", "[detection][mesh][ridge]") {
  check_at_holes<Box>(900);
  check_at_holes<ConvexHull>(400);
  check_at_holes<Cylinder>(100);
}

TEST_CASE("bodies on surfaces of triangles are held as by the solids inside", "[detection][mesh][sweep][long]") {
  sweep_all<Sphere, Capsule, Cylinder, Box, ConvexHull, Ellipsoid, Superquadric, Clump, SolidParts>(800, false);
}

TEST_CASE("1e5 poses of every shape on surfaces of triangles", "[detection][mesh][sweep][slow]") {
  sweep_all<Sphere, Capsule, Cylinder, Box, ConvexHull, Ellipsoid, Superquadric, Clump, SolidParts>(100000, true);
}
