#include "engine/state/state_snapshot.h"

#include <filesystem>
#include <numeric>

#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Two columns and a value, as a stage would show them.
struct State {
  std::vector<double> first;
  std::vector<std::uint32_t> second;
  double value = 0.0;
  auto walk() {
    return [this](StateVisitor& v) {
      v.column("first", first);
      v.column("second", second);
      v.value("value", value);
    };
  }
};

State state_of(std::size_t size, double begin) {
  State s{std::vector<double>(size), std::vector<std::uint32_t>(size / 2, 7), begin};
  std::iota(s.first.begin(), s.first.end(), begin);
  return s;
}

}  // namespace

TEST_CASE("a small state is kept in memory, a large one in a file without a name, both come back as they were",
          "[engine][snapshot]") {
  const std::filesystem::path scratch = std::filesystem::temp_directory_path() / "epafi_test_last_good";
  for (const std::size_t size : {std::size_t{10}, std::size_t{1} << 20}) {  // the larger one: 10 MB
    INFO(size);
    StateSnapshot kept(scratch);
    CHECK_FALSE(kept.saved());
    State s = state_of(size, 0.0);
    kept.save(s.walk());
    s = state_of(size + 4, 1.0);  // the second save is the one that counts
    kept.save(s.walk());
    CHECK(kept.in_file() == (size > 10));
    CHECK_FALSE(std::filesystem::exists(scratch));
    const State before = s;
    s = state_of(3, -1.0);
    kept.restore(s.walk());
    CHECK(s.first == before.first);
    CHECK(s.second == before.second);
    CHECK(s.value == before.value);
  }
}

TEST_CASE("where no scratch file can be made a large state stays in memory", "[engine][snapshot]") {
  StateSnapshot kept("/nowhere/at/all/last_good");
  State s = state_of(std::size_t{1} << 20, 2.0);
  kept.save(s.walk());
  CHECK_FALSE(kept.in_file());
  const State before = s;
  s = {};
  kept.restore(s.walk());
  CHECK(s.first == before.first);
}
