#include "engine/state/body_ids.h"
#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("body ids keep their order, whether in ranges or one by one", "[engine]") {
  BodyIds ids;
  CHECK(ids.empty());
  std::vector<std::uint32_t> expected;
  const auto add = [&](std::uint32_t first, std::uint32_t count) {
    ids.add(static_cast<BodyId>(first), count);
    for (std::uint32_t k = 0; k < count; ++k) expected.push_back(first + k);
  };
  add(5, 3);
  add(8, 1);
  add(2, 2);
  add(100, 50);
  add(4, 1);
  REQUIRE(ids.size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) CHECK(static_cast<std::uint32_t>(ids[k]) == expected[k]);
  for (std::uint32_t id = 0; id < 160; ++id)
    CHECK(ids.contains(static_cast<BodyId>(id)) == (std::ranges::count(expected, id) > 0));
}
