#include "engine/state/hash.h"

#include <bitset>
#include <limits>
#include <set>

#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("mix_bits is a bijection on samples and flips half of the bits", "[engine][hash]") {
  std::set<std::uint64_t> images;
  double flipped = 0;
  for (std::uint64_t k = 0; k < 4096; ++k) {
    images.insert(mix_bits(k));
    for (int bit = 0; bit < 64; ++bit)
      flipped += static_cast<double>(std::bitset<64>(mix_bits(k) ^ mix_bits(k ^ 1ULL << bit)).count());
  }
  CHECK(images.size() == 4096);
  CHECK(flipped / (4096 * 64) == Approx(32.0).epsilon(0.01));
}

TEST_CASE("a hash depends on the values, their order and their number", "[engine][hash]") {
  const auto of = [](std::initializer_list<double> values) {
    Hash h;
    h.add(values.begin(), values.size());
    return h.value();
  };
  const double tiny = std::numeric_limits<double>::denorm_min();
  const std::set<std::uint64_t> all{of({}),     of({0.0}),      of({-0.0}),    of({0.0, 0.0}),
                                    of({tiny}), of({1.0, 2.0}), of({2.0, 1.0})};
  CHECK(all.size() == 7);
  CHECK(of({1.0, 2.0}) == of({1.0, 2.0}));
}

TEST_CASE("texts are told apart where their joins are equal", "[engine][hash]") {
  Hash a, b;
  a.add(std::string_view("ab"));
  a.add(std::string_view("c"));
  b.add(std::string_view("a"));
  b.add(std::string_view("bc"));
  CHECK(a.value() != b.value());
  const std::string hex = a.hex();
  CHECK(hex.size() == 16);
  CHECK(std::stoull(hex, nullptr, 16) == a.value());
}
