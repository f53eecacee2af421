// The row of bristles by itself; its friction law is held by test_contact_laws.cpp.
#include "laws/smooth/bristles.h"

#include <algorithm>
#include <vector>

#include "engine/lanes/targets.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

TEST_CASE("bristles that stick keep load and energy of those left where a shrinking row is split", "[laws][friction]") {
  // a row of stiffness 1 has 36 bristles; at 12 it is split into 24 of half the width
  constexpr double d = 1e-6, never = 1e9;
  Bristles row{}, next{};
  SlipStep step{Vec3::UnitZ(), 0.0, {d, 0.0, 0.0}, 0.0, 0.0};
  FrictionResponse r = pull_bristles(step, 1.0, never, row, next);
  CHECK(r.load.x() == Approx(d).epsilon(1e-13));
  step.displacement.setZero();
  row = next;
  r = pull_bristles(step, 12.0 / 36.0, never, row, next);
  CHECK(r.load.x() == Approx(12.0 / 36.0 * d).epsilon(1e-13));
  row = next;
  r = pull_bristles(step, 0.33, never, row, next);
  CHECK(next.width == Approx(0.5 / 36.0).epsilon(1e-14));  // it was split
  CHECK(r.load.x() == Approx(0.33 * d).epsilon(1e-13));    // 48 sums of numbers of one sign
  CHECK(r.energy == Approx(0.5 * 0.33 * d * d).epsilon(1e-13));
}

namespace {

/// Bristles one by one, each a spring: a row of one width, without lanes or axes that turn.
struct OneByOne {
  std::vector<Vec3> load = std::vector<Vec3>(Bristles::count, Vec3(0, 0, 0));
  double share = 0.0;

  FrictionResponse pull(const SlipStep& step, double width, double stiffness, double limit) {
    const double now = stiffness / width, s = now;
    FrictionResponse out;
    Vec3 before = Vec3::Zero();
    for (int i = 0; i < Bristles::count; ++i) {
      const double was = std::clamp(share - i, 0.0, 1.0), is = std::clamp(now - i, 0.0, 1.0), outer = i + is;
      Vec3& x = load[static_cast<std::size_t>(i)];
      if (was == 0.0) x.setZero();
      x = turn_load(x, step.normal, step.twist);
      before += x;
      const double part = 1.5 / s * (is - (outer * outer * outer - 1.0 * i * i * i) / (3.0 * s * s));
      const Spring spring = extend({x, width * was}, x, width * is, step.displacement, limit * part);
      x = spring.load;
      out.load += x;
      out.energy += energy_of(spring);
    }
    share = now;
    out.work = 0.5 * (before + out.load).dot(step.displacement);
    return out;
  }
};

}  // namespace

TEST_CASE("a row answers as its bristles one by one, with the same bits at every width", "[laws][friction]") {
  const Target best = target();
  for (int draw = 0; draw < 20; ++draw) {
    std::vector<Vec3> first;
    for (const Target most : {Target::baseline, Target::avx2, Target::avx512}) {
      limit_target(std::min(most, best));
      Random random(7, static_cast<unsigned>(draw));
      OneByOne plain;
      Bristles row;
      Vec3 normal = random_direction(random);
      double width = 0.0;
      for (int k = 0; k < 300; ++k) {
        normal = (normal + 1e-4 * random_direction(random)).normalized();
        Vec3 slip = 1e-6 * random_direction(random);
        slip -= slip.dot(normal) * normal;
        const double stiffness = k == 0 ? 1e5 : random.uniform(0.4e5, 1.2e5), limit = random.uniform(0.01, 0.3);
        const SlipStep step{normal, random.uniform(-1e-2, 1e-2), slip, 0.0, 0.0};
        const FrictionResponse r = pull_bristles(step, stiffness, limit, row, row);
        if (k == 0) width = row.width;
        const FrictionResponse want = plain.pull(step, width, stiffness, limit);
        REQUIRE(row.width == width);
        REQUIRE((r.load - want.load).norm() <= 1e-4 * limit);
        REQUIRE(r.energy == Approx(want.energy).epsilon(1e-3));
        REQUIRE(r.work == Approx(want.work).margin(1e-4 * limit * slip.norm()));
        if (most == Target::baseline)
          first.push_back(r.load);
        else
          REQUIRE(r.load == first[static_cast<std::size_t>(k)]);
      }
    }
  }
  limit_target(best);
}
