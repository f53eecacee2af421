// Convex bodies that overlap the closed surface of a hull by less than a hundredth of their size: the surface must hold
// them as the hull would, on faces, edges and corners. The hull's answer is GJK's and EPA's.
#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "tests/support/catch.h"
#include "tests/support/pair_errors.h"

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

/// A table as a file may have it: every side in n by n squares, every triangle with corners of its own.
TriangleSurface table_surface(const Vec3& half, int n, Random& random) {
  TriangleSurface s;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            Vec3 x;
            x[axis] = side * half[axis];
            x[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * (i + di) / n - 1.0);
            x[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * (j + dj) / n - 1.0);
            return x;
          };
          const std::array<Vec3, 4> q{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          const std::size_t first = random.bits() & 1u;
          for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
            const auto at = static_cast<std::uint32_t>(s.vertices.size());
            for (const std::size_t c : {first, first + k, first + k + 1}) s.vertices.push_back(q[c % 4]);
            s.triangles.push_back({at, at + 1, at + 2});
          }
        }
  return s;
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
    const Quat down(Eigen::AngleAxisd(0.5 * testing::pi * (random.bits() % 4), Vec3::Unit(random.bits() % 3)));
    const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
    const Quat in_table = Quat(Eigen::AngleAxisd(tilt, testing::random_direction(random))) * yaw * down;
    const Quat turn = testing::random_turn(random);
    body.orientation = turn * in_table;
    const Vec3 at(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.3 + a.bounding_radius());
    body.position = turn * at;
    world.add(body);
    body.shape = shapes.add(TriangleMesh::from_surface(table_surface(half, 1 + random.bits() % 4, random))).packed;
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

struct Plate {
  std::vector<std::vector<bool>> filled;  ///< cells of the plan
  Vec3 cell;                              ///< [m]

  bool at(int i, int j) const {
    const int n = static_cast<int>(filled.size());
    return i >= 0 && j >= 0 && i < n && j < n && filled[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  Vec3 corner(int i, int j, int k) const { return cell.cwiseProduct(Vec3(i, j, k)); }
};

/// No two filled cells touch at a corner only.
Plate random_plate(Random& random, int n) {
  while (true) {
    Plate p{std::vector<std::vector<bool>>(static_cast<std::size_t>(n), std::vector<bool>(static_cast<std::size_t>(n))),
            Vec3(random.uniform(0.1, 0.3), random.uniform(0.1, 0.3), random.uniform(0.1, 0.3))};
    int count = 0;
    for (auto& row : p.filled)
      for (std::size_t j = 0; j < row.size(); ++j) count += row[j] = random.uniform() < 0.75;
    bool pinched = count == 0;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        pinched = pinched || (p.at(i, j) == p.at(i - 1, j - 1) && p.at(i - 1, j) == p.at(i, j - 1) &&
                              p.at(i, j) != p.at(i - 1, j));
    if (!pinched) return p;
  }
}

TriangleSurface surface_of(const Plate& p, Random& random) {
  TriangleSurface s;
  const auto add = [&](const std::array<Vec3, 4>& q) {
    const std::size_t first = random.bits() & 1u;
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
      const auto at = static_cast<std::uint32_t>(s.vertices.size());
      for (const std::size_t c : {first, first + k, first + k + 1}) s.vertices.push_back(q[c % 4]);
      s.triangles.push_back({at, at + 1, at + 2});
    }
  };
  const int n = static_cast<int>(p.filled.size());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      if (!p.at(i, j)) continue;
      const auto c = [&](int di, int dj, int k) { return p.corner(i + di, j + dj, k); };
      add({c(0, 0, 1), c(1, 0, 1), c(1, 1, 1), c(0, 1, 1)});
      add({c(0, 0, 0), c(0, 1, 0), c(1, 1, 0), c(1, 0, 0)});
      if (!p.at(i - 1, j)) add({c(0, 0, 0), c(0, 0, 1), c(0, 1, 1), c(0, 1, 0)});
      if (!p.at(i + 1, j)) add({c(1, 0, 0), c(1, 1, 0), c(1, 1, 1), c(1, 0, 1)});
      if (!p.at(i, j - 1)) add({c(0, 0, 0), c(1, 0, 0), c(1, 0, 1), c(0, 0, 1)});
      if (!p.at(i, j + 1)) add({c(0, 1, 0), c(0, 1, 1), c(1, 1, 1), c(1, 1, 0)});
    }
  return s;
}

struct SolidPart {
  Box box;
  Vec3 centre;
};

/// The largest boxes in the plate: a way out of it is a way out of all of them.
std::vector<SolidPart> parts_of(const Plate& p) {
  const int n = static_cast<int>(p.filled.size());
  const auto all = [&](int i0, int i1, int j0, int j1) {
    for (int i = i0; i < i1; ++i)
      for (int j = j0; j < j1; ++j)
        if (!p.at(i, j)) return false;
    return true;
  };
  std::vector<SolidPart> out;
  for (int i0 = 0; i0 < n; ++i0)
    for (int i1 = i0 + 1; i1 <= n; ++i1)
      for (int j0 = 0; j0 < n; ++j0)
        for (int j1 = j0 + 1; j1 <= n; ++j1) {
          if (!all(i0, i1, j0, j1) || all(i0 - 1, i1, j0, j1) || all(i0, i1 + 1, j0, j1) || all(i0, i1, j0 - 1, j1) ||
              all(i0, i1, j0, j1 + 1))
            continue;
          const Vec3 low = p.corner(i0, j0, 0), high = p.corner(i1, j1, 1);
          out.push_back({Box(0.5 * (high - low)), 0.5 * (low + high)});
        }
  return out;
}

/// Deepest way out of the parts, world axes.
template <class A>
Way parts_answer(const A& a, const Pose& pa, const std::vector<SolidPart>& parts, const Pose& plate) {
  Way deepest{infinity, Vec3::Zero()};
  for (const SolidPart& p : parts) {
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
    const Plate plate = random_plate(random, n);
    const auto parts = parts_of(plate);
    const double tilt = random.bits() % 5 == 0 ? 0.0 : std::pow(10.0, random.uniform(-8, -1.5));
    const Quat down(Eigen::AngleAxisd(0.5 * testing::pi * (random.bits() % 4), Vec3::Unit(random.bits() % 3)));
    const Quat yaw(Eigen::AngleAxisd(random.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
    const Quat turn = testing::random_turn(random);
    Body body;
    body.shape = shapes.add(a).packed;
    body.orientation = turn * Quat(Eigen::AngleAxisd(tilt, testing::random_direction(random))) * yaw * down;
    const double size = a.bounding_radius();
    body.position = turn * (plate.corner(n, n, 1).cwiseProduct(Vec3(random.uniform(), random.uniform(), 1.0)) +
                            Vec3(0, 0, random.uniform(0.2, 1.0) * size));
    world.add(body);
    body.shape = shapes.add(TriangleMesh::from_surface(surface_of(plate, random))).packed;
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

TEST_CASE("flat bodies over notches and holes of plates are as deep as in the largest of their boxes",
          "[detection][mesh][ridge]") {
  check_notched(Box(Vec3(0.6, 0.05, 0.01)), 300, 0);
  check_notched(Box(Vec3(0.1, 0.15, 0.2)), 300, 1);
  check_notched(Cylinder(0.1, 0.2), 300, 2);
  check_notched(Cylinder(0.3, 0.02), 300, 3);
  check_notched(Sphere(0.1), 300, 4);
}
