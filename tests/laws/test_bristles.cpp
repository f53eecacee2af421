// The row of bristles by itself; its friction law is held by test_contact_laws.cpp.
#include "laws/smooth/bristles.h"

#include "tests/support/catch.h"

using namespace epafi;

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
