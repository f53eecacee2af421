#include <cstring>
#include <numbers>

#include "detection/narrow/gjk/common_normal.h"
#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/gjk/superquadric_pairs.h"
#include "detection/narrow/gjk/two_normals.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/sphere.h"
#include "detection/shapes/superquadric.h"
#include "engine/lanes/targets.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::difference;

namespace {

Superquadric random_superquadric(Random& random, int least, int most) {
  Vec3 axes;
  for (int k = 0; k < 3; ++k) axes[k] = std::pow(5.0, random.uniform(0, 1));
  const auto exponent = [&] { return std::min(most, least + static_cast<int>(random.uniform(0, most - least + 1))); };
  const int across = exponent();
  return {axes, across, random.uniform(0, 1) < 0.3 ? across : exponent()};
}

double gap_by_polytope(const MinkowskiDifference& d) {
  const GjkResult apart = gjk(d);
  return apart.status == GjkResult::Status::overlapping ? -epa(d).upper : apart.lower;
}

/// Poses in random turns where B overlaps A by `depth` times the smaller semi-axis, along some normal.
struct Met {
  Pose a, b;
};
template <class A, class B>
Met met_at(const A& a, const B& b, Random& random, double depth) {
  const Pose pa{testing::random_point(random), testing::random_turn(random)};
  const double far = 1.1 * (a.bounding_radius() + b.bounding_radius());
  Pose pb{pa.position + far * testing::random_direction(random), testing::random_turn(random)};
  const GjkResult way = gjk(difference(a, pa, b, pb));
  const double smaller = std::min(a.core_semi_axes().minCoeff(), b.core_semi_axes().minCoeff());
  pb.position -= (way.lower + depth * smaller) * (pa.orientation * way.normal);
  return {pa, pb};
}

}  // namespace

TEST_CASE("superquadrics of all exponents have the gap of the exact methods", "[detection][round]") {
  for (const auto& [least, most] : {std::pair(2, 4), std::pair(4, 8), std::pair(8, 20), std::pair(2, 20)}) {
    Random random(311, static_cast<std::uint64_t>(32 * least + most));
    int uncertain = 0, overlapping = 0;
    double worst = 0.0;
    for (int k = 0; k < 300; ++k) {
      const Superquadric a = random_superquadric(random, least, most), b = random_superquadric(random, least, most);
      const Met at = met_at(a, b, random, random.uniform(-0.02, 0.02));
      const MinkowskiDifference d = difference(a, at.a, b, at.b);
      const CommonNormal c = common_normal(RoundRef::to(a), RoundRef::to(b), d.rotation, d.offset, infinity);
      if (c.status != CommonNormal::Status::found) {
        ++uncertain;
        continue;
      }
      overlapping += c.gap < 0.0;
      worst = std::max(worst, std::abs(c.gap - gap_by_polytope(d)) / d.size());
      CHECK((c.on_b - c.on_a - c.gap * c.normal).norm() < 2e-13 * d.size());
      // the certificate of a distance, and that the normal is one of both
      CHECK(-c.normal.dot(d.support(c.normal).y) == Approx(c.gap).margin(1e-11 * d.size()));
    }
    INFO("exponents " << least << " to " << most);
    CHECK(uncertain <= 6);  // the exact method is asked for at most one in 50
    CHECK(overlapping > 100);
    CHECK(worst < 2e-11);  // the exact gap is known to 1e-12, of exponents of 20 to 1e-11
  }
}

TEST_CASE("contacts of superquadrics and other round bodies have the exact depth, shallow or deep",
          "[detection][round]") {
  Random random(312, 0);
  const auto worst_of = [&](const auto& a, const auto& b) {
    const Met at = met_at(a, b, random, random.uniform(0.0, 0.4));
    const double gap = gap_by_polytope(difference(a, at.a, b, at.b));
    const ContactSet found = support::contacts(a, at.a, b, at.b);
    REQUIRE(found.size() == 1);
    return std::abs(found.gap[0] - gap) / std::max(a.bounding_radius(), b.bounding_radius());
  };
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Superquadric a = random_superquadric(random, 2, 20);
    worst = std::max(worst, worst_of(a, random_superquadric(random, 2, 20)));
    worst = std::max(worst, worst_of(Ellipsoid(Vec3(1.0, 1.7, random.uniform(0.5, 3.0))), a));
  }
  CHECK(worst < 1e-9);
}

TEST_CASE("flat sides that face each other: gap, normal and place in closed form", "[detection][round]") {
  Random random(313, 0);
  for (int k = 0; k < 200; ++k) {
    const Superquadric a = random_superquadric(random, 3, 20), b = random_superquadric(random, 3, 20);
    // in one orientation, A's top against B's underside
    const Pose pa{testing::random_point(random), testing::random_turn(random)};
    const double gap = random.uniform(-0.01, 0.01) * std::min(a.semi_axes.z(), b.semi_axes.z());
    const Vec3 between(0.0, 0.0, a.semi_axes.z() + b.semi_axes.z() + gap);
    const Pose pb{pa.position + pa.orientation * between, pa.orientation};
    const MinkowskiDifference d = difference(a, pa, b, pb);
    const CommonNormal c = common_normal(RoundRef::to(a), RoundRef::to(b), d.rotation, d.offset, infinity);
    REQUIRE(c.status == CommonNormal::Status::found);
    CHECK(c.gap == Approx(gap).margin(1e-13 * d.size()));
    CHECK((c.normal - Vec3::UnitZ()).norm() < 1e-6);
    // a ball on the side: the place is where the ball is, which the normal of the flat side does not tell
    const double x = random.uniform(-0.1, 0.1) * a.semi_axes.x(), y = random.uniform(-0.1, 0.1) * a.semi_axes.y();
    const Superquadric flat(a.semi_axes, 20, 20);
    const Sphere ball{0.2 * a.semi_axes.minCoeff()};
    const Vec3 centre(x, y, a.semi_axes.z() + ball.radius);
    const CommonNormal on = common_normal(RoundRef::to(flat), RoundRef::to(ball), Mat3::Identity(), centre, infinity);
    REQUIRE(on.status == CommonNormal::Status::found);
    CHECK(on.gap == Approx(ball.radius).margin(1e-12 * a.bounding_radius()));  // the core of a ball is its centre
    CHECK((on.on_a - Vec3(x, y, a.semi_axes.z())).norm() < 1e-8 * a.bounding_radius());
  }
}

TEST_CASE("a limit ends the search of superquadrics with a normal that proves the distance", "[detection][round]") {
  Random random(314, 0);
  int beyond = 0;
  for (int k = 0; k < 200; ++k) {
    const Superquadric a = random_superquadric(random, 2, 20), b = random_superquadric(random, 2, 20);
    const Met at = met_at(a, b, random, -random.uniform(0.01, 1.0));
    const MinkowskiDifference d = difference(a, at.a, b, at.b);
    const double gap = gap_by_polytope(d), limit = random.uniform(0.5, 1.5) * gap;
    const CommonNormal c = common_normal(RoundRef::to(a), RoundRef::to(b), d.rotation, d.offset, limit);
    if (c.status == CommonNormal::Status::beyond) {
      ++beyond;
      CHECK(-c.normal.dot(d.support(c.normal).y) > limit);
      CHECK(gap > limit);
    } else if (c.status == CommonNormal::Status::found) {
      CHECK((c.gap > limit) == (gap > limit));
    }
  }
  CHECK(beyond > 40);
}

TEST_CASE("no radius of curvature is below the least one", "[detection][superquadric]") {
  Random random(315, 0);
  for (int k = 0; k < 30; ++k) {
    const Superquadric s = random_superquadric(random, 2, 20);
    double least = infinity;
    for (int j = 0; j < 3000; ++j) {
      const Vec3 d = testing::random_direction(random).cwiseQuotient(s.semi_axes).normalized();
      const Tangents t(d);
      const Mat3 m = s.curved_support(d).derivative;
      const double uu = t.u.dot(m * t.u), uv = t.u.dot(m * t.v), vv = t.v.dot(m * t.v);
      const double apart = 0.5 * (uu - vv);
      least = std::min(least, (uu * vv - uv * uv) / (0.5 * (uu + vv) + std::sqrt(apart * apart + uv * uv)));
    }
    CHECK(s.least_radius() <= least);
    CHECK(s.least_radius() > 0.9 * least);
  }
  const Vec3 axes(3.0, 2.0, 1.0);  // of an ellipsoid: the shortest axis squared over the longest
  CHECK(Superquadric(axes, 2, 2).least_radius() == Approx(0.98 / 3.0).epsilon(1e-9));
}

TEST_CASE("a direction is turned by the step to first order", "[detection][superquadric]") {
  Random random(316, 0);
  for (int k = 0; k < 200; ++k) {
    const Superquadric s = random_superquadric(random, 2, 20);
    const Vec3 x = testing::random_direction(random).cwiseProduct(s.semi_axes);
    const Vec3 d = x.cwiseQuotient(s.semi_axes.cwiseProduct(s.semi_axes)).normalized();
    const CurvedSupport at = s.curved_support(d);
    const auto error = [&](double h, const Vec3& t) {
      return (s.turned(d, at, h * t) - (d + h * t).normalized()).norm() / h;
    };
    const Vec3 t = d.cross(testing::random_direction(random)).normalized();
    const double h = 1e-5 * d.cwiseAbs().minCoeff();
    CHECK(error(h, t) < 1e-3);
    CHECK(error(0.1 * h, t) < 0.2 * error(h, t) + 1e-6);
  }
}

TEST_CASE("pairs of superquadrics asked together have the bits of those asked one by one", "[detection][round]") {
  const auto same = [](const Vec3& x, const Vec3& y) {
    return std::memcmp(x.data(), y.data(), 3 * sizeof(double)) == 0;
  };
  for (const Target most : {Target::baseline, Target::avx2, Target::avx512}) {
    limit_target(most);
    Random random(317, 0);
    int found = 0, beyond = 0, different = 0;
    for (int round = 0; round < 60; ++round) {
      std::vector<Superquadric> shapes;
      std::vector<SuperquadricPair> pairs;
      for (int k = 0; k < 4; ++k) shapes.push_back(random_superquadric(random, 2, round % 2 == 0 ? 20 : 5));
      for (int k = 0; k < 40; ++k) {
        const Superquadric &a = shapes[random.bits() % 2], &b = shapes[2 * (random.bits() % 2)];
        const Met at = met_at(a, b, random, random.uniform(-0.1, 0.1));
        const MinkowskiDifference d = difference(a, at.a, b, at.b);
        pairs.push_back({&a, &b, d.rotation, d.offset, random.uniform(0, 1) < 0.3 ? infinity : 0.0});
      }
      std::vector<CommonNormal> together(pairs.size());
      two_normals(pairs, together);
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        const SuperquadricPair& p = pairs[k];
        const CommonNormal alone = two_normals(RoundRef::to(*p.a), RoundRef::to(*p.b), p.rotation, p.offset, p.limit);
        const CommonNormal& c = together[k];
        found += c.status == CommonNormal::Status::found;
        beyond += c.status == CommonNormal::Status::beyond;
        different += !(c.status == alone.status && same(Vec3(c.gap, 0, 0), Vec3(alone.gap, 0, 0)) &&
                       same(c.normal, alone.normal) && same(c.on_a, alone.on_a) && same(c.on_b, alone.on_b));
      }
    }
    CHECK(different == 0);
    CHECK(found > 800);
    CHECK(beyond > 100);
  }
  limit_target(Target::avx512);
}
