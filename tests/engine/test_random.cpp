#include "engine/units/random.h"

#include <cmath>
#include <set>

#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("mix_bits is SplitMix64: published first outputs for seed 1234567", "[engine][random]") {
  // Steele, Lea and Flood 2014; reference output of Vigna's splitmix64.c for x = 1234567 (Rosetta Code)
  const std::uint64_t expected[] = {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                    4593380528125082431ULL, 16408922859458223821ULL};
  std::uint64_t x = 1234567;
  for (std::uint64_t e : expected) {
    CHECK(mix_bits(x) == e);
    x += 0x9e3779b97f4a7c15ULL;
  }
}

TEST_CASE("uniform draws have the moments of the uniform distribution and stay from 0 to below 1", "[engine][random]") {
  Random random(42, 7);
  const int n = 100000;
  double m1 = 0, m2 = 0, lag = 0, last = 0.5;
  bool inside = true;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform();
    inside = inside && u >= 0 && u < 1;
    m1 += u;
    m2 += u * u;
    lag += (u - 0.5) * (last - 0.5);
    last = u;
  }
  CHECK(inside);
  // five standard deviations: 5 sqrt(1/12/n), 5 sqrt(4/45/n), 5/12/sqrt(n)
  CHECK(std::abs(m1 / n - 0.5) < 5 * std::sqrt(1.0 / 12 / n));
  CHECK(std::abs(m2 / n - 1.0 / 3) < 5 * std::sqrt(4.0 / 45 / n));
  CHECK(std::abs(lag / n) < 5.0 / 12 / std::sqrt(n));
}

TEST_CASE("streams and seeds are independent of each other and repeatable", "[engine][random]") {
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    for (std::uint64_t stream = 0; stream < 40; ++stream) first.insert(Random(seed, stream).bits());
  CHECK(first.size() == 1600);
  // first draws of neighbouring streams: mean 1/2
  double mean = 0;
  for (std::uint64_t stream = 0; stream < 10000; ++stream) mean += Random(1, stream).uniform() / 10000;
  CHECK(std::abs(mean - 0.5) < 5 * std::sqrt(1.0 / 12 / 10000));
  Random a(3, 4), b(3, 4);
  for (int i = 0; i < 10; ++i) CHECK(a.bits() == b.bits());
  Random c(3, 4);
  for (int i = 0; i < 1000; ++i) {
    const double u = c.uniform(-2, 5);
    REQUIRE((u >= -2 && u < 5));
  }
}
