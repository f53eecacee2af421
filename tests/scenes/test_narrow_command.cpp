#include "scenes/cli/narrow.h"

#include <fstream>
#include <sstream>

#include "detection/convex_corpus.h"
#include "engine/units/error.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const std::string corpus_path = EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin";

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

TEST_CASE("narrow prints a row per pair whose normal separates by the distance, then the means", "[scenes][narrow]") {
  const std::string out = EPAFI_BINARY_DIR "/narrow.csv";
  CHECK(command_narrow({corpus_path, "auto", out, false}) == 0);
  const auto lines = lines_of(out);
  const auto pairs = read_corpus(corpus_path);
  REQUIRE(lines.size() == pairs.size() + 2);
  CHECK(lines.front() == "pair,status,distance,nx,ny,nz,pax,pay,paz,pbx,pby,pbz,ns");
  CHECK(lines.back().rfind("# mean ns cold ", 0) == 0);
  CHECK(lines.back().find(", warm ") != std::string::npos);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto cells = cells_of(lines[k + 1]);
    REQUIRE(cells.size() == 13);
    CHECK(cells[0] == std::to_string(k));
    CHECK(cells[1] == "ok");
    const auto at = [&](std::size_t i) { return std::stod(cells[i]); };
    const Vec3 n(at(3), at(4), at(5)), pa(at(6), at(7), at(8)), pb(at(9), at(10), at(11));
    CHECK(std::abs(at(2) - pairs[k].distance) <= pairs[k].resolution());
    CHECK(static_cast<double>(pairs[k].distance - pairs[k].separation(n)) <= pairs[k].resolution());
    const Vec3 between = pairs[k].b.centre - pairs[k].a.centre + pb - pa;
    CHECK(std::abs(between.dot(n) - at(2)) <= 10 * pairs[k].resolution());
    CHECK(at(12) > 0.0);
  }
}

TEST_CASE("narrow as JSON holds the same pairs; an unknown method names the nearest", "[scenes][narrow]") {
  const std::string out = EPAFI_BINARY_DIR "/narrow.json";
  CHECK(command_narrow({corpus_path, "gjk-epa", out, true}) == 0);
  const auto lines = lines_of(out);
  const auto rows = std::count_if(lines.begin(), lines.end(),
                                  [](const std::string& l) { return l.find("\"pair\":") != std::string::npos; });
  CHECK(static_cast<std::size_t>(rows) == read_corpus(corpus_path).size());
  CHECK(lines[lines.size() - 2].find("\"mean_ns\": {\"cold\": ") != std::string::npos);
  CHECK_THROWS_WITH(command_narrow({corpus_path, "gjk", "", false}), Catch::Contains("gjk-epa"));
  CHECK_THROWS_AS(command_narrow({corpus_path + "x", "auto", "", false}), FileError);
}
