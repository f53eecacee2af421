#include "detection/mass_properties.h"
#include "detection/shape_store.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// Integrates 1, x^2, y^2, z^2 over a body by the midpoint rule on n^3 cells of its bounding box.
template <class Inside>
MassProperties by_sampling(const Vec3& half, int n, Inside&& inside) {
  double volume = 0;
  Vec3 second = Vec3::Zero();
  const Vec3 cell = 2 * half / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 p = -half + cell.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5));
        if (inside(p)) {
          volume += 1;
          second += p.cwiseProduct(p);
        }
      }
  const double dv = cell.prod();
  const Mat3 inertia = Vec3(dv * (Vec3::Constant(second.sum()) - second)).asDiagonal();
  return {volume * dv, Vec3::Zero(), inertia};
}

void check_same(const MassProperties& exact, const MassProperties& sampled, double tolerance) {
  CHECK(exact.mass == Approx(sampled.mass).epsilon(tolerance));
  for (int i = 0; i < 3; ++i) CHECK(exact.inertia(i, i) == Approx(sampled.inertia(i, i)).epsilon(tolerance));
  CHECK((exact.inertia - Mat3(exact.inertia.diagonal().asDiagonal())).norm() == 0.0);
}

/// The box of a convex shape is where its support in the six directions ends.
template <class S>
void check_box_is_support(const S& shape, Random& random) {
  for (int k = 0; k < 100; ++k) {
    const Pose pose{random_point(random), random_turn(random)};
    const Aabb box = shape.bounding_box(pose);
    for (int i = 0; i < 3; ++i)
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 d = sign * Vec3::Unit(i);
        const Vec3 p = pose.to_world(shape.support(pose.orientation.conjugate() * d));
        const double reach = p.dot(d) + shape.rounding();
        CHECK(reach == Approx(sign > 0 ? box.max[i] : -box.min[i]).margin(1e-14 * (1 + shape.bounding_radius())));
      }
  }
}

/// No point of the surface lies farther along d than the support; `surface(u, v)` runs over the core for u, v in [0,
/// 1).
template <class S, class Surface>
void check_support_is_farthest(const S& shape, Random& random, Surface&& surface) {
  for (int k = 0; k < 200; ++k) {
    const Vec3 d = random_direction(random) * std::pow(10.0, random.uniform(-6, 6));
    const double best = shape.support(d).dot(d);
    double sampled = -infinity;
    for (int i = 0; i < 2000; ++i) {
      const double u = random.uniform(), v = random.uniform();
      sampled = std::max(sampled, surface(u, v).dot(d));
    }
    const double size = shape.bounding_radius() * d.norm();
    CHECK(best >= sampled - 1e-14 * size);
    CHECK(best <= sampled + 0.1 * size);  // 2000 samples come that near
  }
}

}  // namespace

TEST_CASE("the cube root is right to 2 ulp without the library", "[detection][shapes]") {
  Random random(1, 0);
  for (int k = 0; k < 10000; ++k) {
    const double x = std::ldexp(random.uniform(0.5, 1.0), static_cast<int>(random.uniform(-300, 300)));
    // long double: the library's own double cube root is off by more than 1 ulp
    const long double exact = std::cbrt(static_cast<long double>(x));
    CHECK(std::abs(cube_root(x) - exact) <= 2 * 0x1.0p-52L * exact);
  }
  CHECK(cube_root(0.0) == 0.0);
  CHECK(cube_root(27e-18) == Approx(3e-6).epsilon(1e-15));
}

TEST_CASE("mass properties of capsule, cylinder and ellipsoid agree with sampling", "[detection][shapes]") {
  // midpoint rule with n = 120 cells a side: the staircase surface costs about 1/n^1.5 = 8e-4
  const Capsule capsule(0.3, 0.8);
  check_same(capsule.mass_properties(),
             by_sampling({0.3, 0.3, 0.7}, 120,
                         [&](const Vec3& p) {
                           const double z = std::max(0.0, std::abs(p.z()) - 0.4);
                           return p.x() * p.x() + p.y() * p.y() + z * z <= 0.09;
                         }),
             1.5e-3);
  const Cylinder cylinder(0.3, 0.8);
  check_same(cylinder.mass_properties(),
             by_sampling({0.3, 0.3, 0.4}, 120, [&](const Vec3& p) { return p.head<2>().squaredNorm() <= 0.09; }),
             1.5e-3);
  const Ellipsoid ellipsoid({0.3, 0.5, 0.9});
  check_same(ellipsoid.mass_properties(),
             by_sampling({0.3, 0.5, 0.9}, 120,
                         [&](const Vec3& p) { return p.cwiseQuotient(Vec3(0.3, 0.5, 0.9)).squaredNorm() <= 1; }),
             1.5e-3);
}

TEST_CASE("limits: a capsule without length and a round ellipsoid are spheres", "[detection][shapes]") {
  const Sphere sphere{0.7};
  const MassProperties s = sphere.mass_properties(), c = Capsule(0.7, 0.0).mass_properties(),
                       e = Ellipsoid({0.7, 0.7, 0.7}).mass_properties();
  CHECK(c.mass == Approx(s.mass).epsilon(1e-15));
  CHECK(e.mass == Approx(s.mass).epsilon(1e-15));
  CHECK((c.inertia - s.inertia).norm() < 1e-15);
  CHECK((e.inertia - s.inertia).norm() < 1e-15);
  CHECK(Capsule(0.7, 0.0).contact_radius() == Approx(0.7).epsilon(1e-15));
  CHECK(Ellipsoid({0.7, 0.7, 0.7}).contact_radius() == Approx(0.7).epsilon(1e-15));
  CHECK(sphere.contact_radius() == 0.7);
  CHECK(HalfSpace{}.contact_radius() == infinity);
}

TEST_CASE("a long capsule is a rod and its half spheres add their share", "[detection][shapes]") {
  const double r = 0.01, l = 10.0;
  const MassProperties m = Capsule(r, l).mass_properties();
  CHECK(m.inertia(0, 0) == Approx(m.mass * (l + 2 * r) * (l + 2 * r) / 12).epsilon(2e-3));  // rod, to order r/l
  CHECK(m.inertia(2, 2) == Approx(m.mass * r * r / 2).epsilon(1e-3));
}

TEST_CASE("the contact radius is that of the sphere of equal volume", "[detection][shapes]") {
  const auto check = [](const auto& shape) {
    CHECK(4.0 / 3.0 * pi * std::pow(shape.contact_radius(), 3) == Approx(shape.mass_properties().mass).epsilon(1e-14));
  };
  check(Cylinder(0.2, 1.1));
  check(Ellipsoid({1e-3, 2e-3, 5e-3}));
  check(Box(Vec3(1, 2, 3)));
}

TEST_CASE("bounding boxes are exact: each side touches the support point", "[detection][shapes]") {
  Random random(2, 0);
  check_box_is_support(Sphere{0.4}, random);
  check_box_is_support(Capsule(0.4, 1.3), random);
  check_box_is_support(Cylinder(0.4, 1.3), random);
  check_box_is_support(Ellipsoid({0.4, 1.3, 0.1}), random);
  check_box_is_support(Box(Vec3(0.4, 1.3, 0.1)), random);
}

TEST_CASE("no point of the body is farther along a direction than its support", "[detection][shapes]") {
  Random random(3, 0);
  check_support_is_farthest(Capsule(0.4, 1.3), random, [](double u, double) { return Vec3(0, 0, 1.3 * (u - 0.5)); });
  check_support_is_farthest(Cylinder(0.4, 1.3), random, [](double u, double v) {
    return Vec3(0.4 * std::cos(2 * pi * u), 0.4 * std::sin(2 * pi * u), v < 0.5 ? -0.65 : 0.65);
  });
  check_support_is_farthest(Ellipsoid({0.4, 1.3, 0.1}), random, [](double u, double v) {
    const double z = 2 * v - 1, s = std::sqrt(1 - z * z);
    return Vec3(0.4 * s * std::cos(2 * pi * u), 1.3 * s * std::sin(2 * pi * u), 0.1 * z);
  });
}

TEST_CASE("supports of degenerate directions are points of the body", "[detection][shapes]") {
  CHECK(Cylinder(0.4, 2.0).support({0, 0, -3}) == Vec3(0, 0, -1));
  CHECK(Cylinder(0.4, 2.0).support({0, 0, 0}) == Vec3(0, 0, 1));
  CHECK(Ellipsoid({1, 2, 3}).support({0, 0, 0}) == Vec3(1, 0, 0));
  CHECK(Capsule(0.4, 2.0).support({1, 0, 0}) == Vec3(0, 0, 1));
}

TEST_CASE("the bounding radius is the farthest point of the body", "[detection][shapes]") {
  CHECK(Capsule(0.3, 0.8).bounding_radius() == Approx(0.7));
  CHECK(Cylinder(0.3, 0.8).bounding_radius() == Approx(0.5));
  CHECK(Ellipsoid({0.3, 0.8, 0.5}).bounding_radius() == 0.8);
}

TEST_CASE("every shape of the list has an entry with its own name", "[detection][shapes]") {
  const auto entries = shape_entries(AllShapes{});
  CHECK(entries.size() == AllShapes::size);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    CHECK_FALSE(entries[i].summary.empty());
    for (std::size_t j = 0; j < i; ++j) CHECK(entries[i].name != entries[j].name);
  }
}
