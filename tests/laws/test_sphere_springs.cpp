// Springs of the contacts that touch, one behind the other: what a step, a new list or a crowd of new contacts leaves.
#include <numeric>
#include <vector>

#include "laws/smooth/fused/sphere_springs.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Contacts 0, 1 ... with loads that say which they are.
SphereSprings numbered(std::uint32_t count, bool rolls) {
  SphereSprings springs({.friction = true, .rolling = rolls});
  springs.choose(std::vector<std::uint32_t>(count, SphereSprings::fresh));
  for (std::uint32_t rank = 0; rank < count; ++rank) {
    CHECK(springs.friction(rank).load[3] == 0.0);
    springs.friction(rank).load = lanes(1.0 + rank);
    if (rolls) springs.rolling(rank).load = lanes(-1.0 - rank);
  }
  return springs;
}

std::vector<double> loads(const SphereSprings& springs) {
  std::vector<double> out;
  for (std::uint32_t rank = 0; rank < springs.count(); ++rank) out.push_back(springs.friction(rank).load[2]);
  return out;
}

}  // namespace

TEST_CASE("springs of contacts that go on are chosen from those that were", "[laws][fused]") {
  SphereSprings springs = numbered(5, true);
  springs.choose(std::vector<std::uint32_t>{0, SphereSprings::fresh, 2, 3, SphereSprings::fresh});
  CHECK(loads(springs) == std::vector<double>{1, 0, 3, 4, 0});
  CHECK(springs.rolling(2).load[0] == -3.0);
  springs.choose(std::vector<std::uint32_t>{3, 0});
  CHECK(loads(springs) == std::vector<double>{4, 1});
  springs.choose(std::vector<std::uint32_t>{});
  CHECK(springs.count() == 0);
}

TEST_CASE("a step over springs writes no spring that it has not read, however many begin", "[laws][fused]") {
  const std::uint32_t begins = GENERATE(0u, 3u, 400u);  // contacts before the first of those that were
  SphereSprings springs = numbered(300, false);
  std::vector<double> expected = loads(springs);
  for (int step = 0; step < 40; ++step) {  // often enough to come to the start of the column
    SphereSprings::Places at = springs.begin_step();
    for (std::uint32_t k = 0; k < begins; ++k) {
      if (at.write == at.read) at.read += springs.make_room(at.read);
      springs.friction()[at.write++].load = lanes(0.5);
    }
    for (std::size_t k = 0; k < expected.size(); ++k) {
      if (at.write > at.read) at.read += springs.make_room(at.read);
      springs.friction()[at.write++] = springs.friction()[at.read++];
    }
    springs.end_step(at);
    expected.insert(expected.begin(), begins, 0.5);
    REQUIRE(loads(springs) == expected);
    CHECK(springs.friction()[SphereSprings::unloaded].load[0] == 0.0);
  }
}
