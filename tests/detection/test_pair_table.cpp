#include "detection/narrow/pairs/pair_table.h"

#include <fstream>
#include <sstream>

#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("the method of every shape pair is the written one", "[detection][pair_table]") {
  // A closed form whose header is forgotten would fall back to GJK in silence: the file must be changed on purpose.
  std::ifstream in(EPAFI_SOURCE_DIR "/tests/golden/pair_table.txt");
  std::stringstream golden;
  golden << in.rdbuf();
  CHECK(describe_pair_table() == golden.str());
}

TEST_CASE("a pair has the same method in both orders; walls do not touch walls, wheelsets touch tracks alone",
          "[detection][pair_table]") {
  const auto entries = shape_entries(AllShapes{});
  const auto is_wall = [](const std::string& name) {
    return name == "half_space" || name == "mesh" || name == "tube" || name == "cone";
  };
  const auto is_railway = [](const std::string& name) { return name == "wheel_profile" || name == "rail_profile"; };
  const auto touch = [&](const std::string& a, const std::string& b) {
    return is_railway(a) || is_railway(b) ? is_railway(a) && is_railway(b) && a != b : !(is_wall(a) && is_wall(b));
  };
  for (std::size_t a = 0; a < entries.size(); ++a) {
    for (std::size_t b = 0; b < entries.size(); ++b) {
      INFO(entries[a].name << " " << entries[b].name);
      CHECK(std::string(pair_table()[a][b].method) == pair_table()[b][a].method);
      CHECK((pair_table()[a][b].batch != nullptr) == touch(entries[a].name, entries[b].name));
    }
  }
}
