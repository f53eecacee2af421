// Random pairs of boxes, tetrahedra, hulls of 8 to 64 vertices, ellipsoids, capsules and cylinders, each answer judged
// by what the bodies themselves say, in extended precision and without the code under test:
// - the separation along the returned normal, by brute force over vertices or by closed forms, bounds the distance from
// below;
// - apart, the two points lie in their bodies and are as far from each other: the distance is bounded from above too;
// - overlapping polyhedra: the expanding polytope, which knows no faces, bounds the depth from below;
// - smooth bodies: no sampled direction, anywhere or near the normal, separates by more.
#include "detection/narrow/gjk/convex_answer.h"
#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/shapes/all_shapes.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

using Long3 = Eigen::Matrix<long double, 3, 1>;

/// One body of the pool: its support and membership by closed forms of this file.
struct Solid {
  enum class Kind { polyhedron, ellipsoid, capsule, cylinder } kind = Kind::polyhedron;
  ConvexHull hull;
  Vec3 size = Vec3::Ones();  ///< semi-axes; radius and half length in x and z
  double radius() const {
    return kind == Kind::polyhedron  ? hull.radius
           : kind == Kind::ellipsoid ? size.maxCoeff()
           : kind == Kind::capsule   ? size.x() + size.z()
                                     : std::hypot(size.x(), size.z());
  }
  /// max over the body of d.x, body axes, d unit.
  long double support(const Long3& d) const {
    const long double across = std::sqrt(d.x() * d.x() + d.y() * d.y()), up = std::abs(d.z());
    switch (kind) {
      case Kind::ellipsoid:
        return size.cast<long double>().cwiseProduct(d).norm();
      case Kind::capsule:
        return size.x() + size.z() * up;
      case Kind::cylinder:
        return size.x() * across + size.z() * up;
      default:
        break;
    }
    long double most = -std::numeric_limits<long double>::infinity();
    for (const Vec3& v : hull.vertices) most = std::max(most, d.dot(v.cast<long double>()));
    return most;
  }
  /// Distance by which x (body axes) lies outside, about; <= 0 inside.
  double outside(const Vec3& x) const {
    const double across = std::hypot(x.x(), x.y()), up = std::abs(x.z());
    switch (kind) {
      case Kind::ellipsoid:
        return (x.cwiseQuotient(size).norm() - 1.0) * size.minCoeff();
      case Kind::capsule:
        return std::hypot(across, std::max(0.0, up - size.z())) - size.x();
      case Kind::cylinder:
        return std::max(across - size.x(), up - size.z());
      default:
        break;
    }
    double most = -infinity;
    for (std::size_t f = 0; f < hull.face_normals.size(); ++f)
      most = std::max(most, hull.face_normals[f].dot(x) - hull.face_offsets[f]);
    return most;
  }
};

std::vector<Solid> make_pool(Random& random) {
  std::vector<Solid> pool;
  const auto size = [&] { return Vec3(random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)); };
  for (int k = 0; k < 40; ++k) {
    pool.push_back({Solid::Kind::polyhedron, Box(size()).hull, Vec3::Ones()});
    pool.push_back({Solid::Kind::polyhedron, support::random_hull(random, 4), Vec3::Ones()});
    pool.push_back({Solid::Kind::polyhedron,
                    support::random_hull(random, 8 + static_cast<std::size_t>(random.uniform() * 57)), Vec3::Ones()});
    pool.push_back({Solid::Kind::ellipsoid, {}, size()});
    pool.push_back({Solid::Kind::capsule, {}, size()});
    pool.push_back({Solid::Kind::cylinder, {}, size()});
  }
  return pool;
}

struct Tally {
  long pairs = 0, overlapping = 0, named = 0, wrong_bound = 0, wrong_points = 0, shallow = 0, capped = 0;
  double worst_polyhedra = 0.0, worst_smooth = 0.0;
};

long double separation(const Solid& a, const Pose& pa, const Solid& b, const Pose& pb, const Vec3& n) {
  const auto local = [](const Pose& p, const Vec3& d) -> Long3 {
    return p.orientation.cast<long double>().toRotationMatrix().transpose() * d.cast<long double>();
  };
  const Long3 between = pb.position.cast<long double>() - pa.position.cast<long double>();
  return n.cast<long double>().dot(between) - b.support(local(pb, -n)) - a.support(local(pa, n));
}

template <class F>
auto with_shape(const Solid& s, const F& f) {
  switch (s.kind) {
    case Solid::Kind::ellipsoid:
      return f(Ellipsoid(s.size));
    case Solid::Kind::capsule:
      return f(Capsule(s.size.x(), 2 * s.size.z()));
    case Solid::Kind::cylinder:
      return f(Cylinder(s.size.x(), 2 * s.size.z()));
    default:
      return f(s.hull);
  }
}

/// Gap, normal (world) and the two points relative to the own body.
struct Answer {
  double gap = 0.0;
  Vec3 normal, on_a, on_b;
  bool named = false;  ///< reported as uncertain
};

Answer ask_cores(const Solid& a, const Pose& pa, const Solid& b, const Pose& pb) {
  ContactSet set;
  ContactSink sink(set);
  sink.begin(0, 1);
  with_shape(a, [&](const auto& sa) {
    with_shape(b, [&](const auto& sb) {
      const CorePair cores{ConvexRef::to(sa), ConvexRef::to(sb), nullptr};
      collide_cores(cores, rounded_pair(sa, sb), {pa, pb, 1e3, false, nullptr}, sink);
    });
  });
  sink.end();
  Answer answer{set.gap.at(0), set.normal[0], Vec3::Zero(), Vec3::Zero(), sink.degenerate() > 0};
  answer.on_a = set.arm[0] - 0.5 * answer.gap * answer.normal;
  answer.on_b = set.arm[0] + 0.5 * answer.gap * answer.normal - (pb.position - pa.position);
  return answer;
}

void judge_polyhedra(const Solid& a, const Pose& pa, const Solid& b, const Pose& pb, Tally& tally) {
  const double size = std::max(a.radius(), b.radius());
  const ConvexAnswer d = ask(ConvexMethod::automatic, a.hull.view(), b.hull.view(), pa, pb);
  const double bound = static_cast<double>(separation(a, pa, b, pb, d.normal));
  double error = std::abs(bound - d.distance) / size;
  tally.wrong_bound += error > 1e-13;
  if (d.distance > 0.0) {
    const double apart = (pb.position + d.witness_b - pa.position - d.witness_a).norm();
    const double out = std::max(a.outside(pa.orientation.conjugate() * d.witness_a),
                                b.outside(pb.orientation.conjugate() * d.witness_b));
    error = std::max(error, std::max(std::abs(apart - d.distance), out) / size);
    tally.wrong_points += std::max(std::abs(apart - d.distance), out) > 1e-12 * size;
  } else {
    ++tally.overlapping;
    const Penetration p = epa(MinkowskiDifference(ConvexRef::to(a.hull), ConvexRef::to(b.hull), pa, pb), 1e-12);
    if (p.status == Penetration::Status::degenerate) {
      ++tally.named;
    } else {
      error = std::max(error, (-d.distance - p.lower) / size);
      tally.wrong_points += -d.distance - p.lower > 3e-12 * size;
    }
  }
  tally.worst_polyhedra = std::max(tally.worst_polyhedra, error);
}

void judge_smooth(const Solid& a, const Pose& pa, const Solid& b, const Pose& pb, Random& random, Tally& tally) {
  const double size = std::max(a.radius(), b.radius());
  const Answer d = ask_cores(a, pa, b, pb);
  if (d.named) {
    ++tally.named;
    return;
  }
  const double bound = static_cast<double>(separation(a, pa, b, pb, d.normal));
  tally.wrong_bound += std::abs(bound - d.gap) > 1e-12 * size;
  tally.overlapping += d.gap < 0.0;
  // The distance is the largest separation over all directions: none may exceed the one found.
  double better = -infinity;
  for (int k = 0; k < 40; ++k) {
    const double spread = k < 10 ? 1e3 : std::pow(10.0, -1 - k % 6);
    const Vec3 n = (d.normal + spread * testing::random_direction(random)).normalized();
    better = std::max(better, static_cast<double>(separation(a, pa, b, pb, n)));
  }
  const double error = std::max(std::abs(bound - d.gap), better - d.gap) / size;
  tally.shallow +=
      error >
      1e-7;  // the narrow phase names pairs from 1e-6 on; 2.6e-8 is the worst of a million that it does not name
  tally.worst_smooth = std::max(tally.worst_smooth, error);
  // Points: an interval of 1e-14 leaves them sqrt(2e-14 of size times distance) to the side; the longest bodies are 10
  // by 1.
  const double out =
      std::max(a.outside(pa.orientation.conjugate() * d.on_a), b.outside(pb.orientation.conjugate() * d.on_b)) / size;
  if (d.gap > 0.0) tally.wrong_points += out > 5e-6;
}

Tally judge_pairs(long count, std::uint64_t seed) {
  Random random(seed, 0);
  const std::vector<Solid> pool = make_pool(random);
  Tally tally;
  const auto draw = [&]() -> const Solid& {
    return pool[static_cast<std::size_t>(random.uniform() * static_cast<double>(pool.size()))];
  };
  for (long k = 0; k < count; ++k) {
    const Solid &a = draw(), &b = draw();
    const Pose pa{testing::random_point(random), testing::random_turn(random)};
    const double reach = a.radius() + b.radius();
    const Pose pb{pa.position + random.uniform(0.1, 1.2) * reach * testing::random_direction(random),
                  testing::random_turn(random)};
    ++tally.pairs;
    const bool polyhedra = a.kind == Solid::Kind::polyhedron && b.kind == Solid::Kind::polyhedron;
    const bool axes = a.kind == Solid::Kind::capsule && b.kind == Solid::Kind::capsule;
    if (polyhedra)
      judge_polyhedra(a, pa, b, pb, tally);
    else if (!axes)
      judge_smooth(a, pa, b, pb, random, tally);  // two capsules have a closed form, tested with it
    if (!polyhedra)
      with_shape(a, [&](const auto& sa) {
        with_shape(b, [&](const auto& sb) {
          tally.capped +=
              gjk(MinkowskiDifference(ConvexRef::to(sa), ConvexRef::to(sb), pa, pb), {infinity, 1e-14, Vec3::Zero()})
                  .iterations >= gjk_cap;
        });
      });
  }
  return tally;
}

void check(const Tally& t) {
  INFO(t.pairs << " pairs, " << t.overlapping << " overlapping, " << t.named << " named uncertain, worst of polyhedra "
               << t.worst_polyhedra << ", of smooth bodies " << t.worst_smooth << " of the size, " << t.wrong_bound
               << " bounds, " << t.wrong_points << " points, " << t.shallow << " too deep, " << t.capped
               << " at the cap");
  CHECK(t.overlapping > t.pairs / 5);
  CHECK(t.wrong_bound == 0);
  CHECK(t.wrong_points == 0);
  CHECK(t.shallow == 0);
  CHECK(t.capped == 0);
  CHECK(t.named < t.pairs / 100);
}

}  // namespace

TEST_CASE("4000 random pairs: no body says otherwise", "[detection][random]") { check(judge_pairs(4000, 91)); }

TEST_CASE("a million random pairs: no body says otherwise", "[detection][random][slow]") {
  check(judge_pairs(1000000, 92));
}
