// The table of a page of the atlas: all points of a short chart; of a long one the front and the best of each method.
#include <map>
#include <random>

#include "scenes/study/atlas_page.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

std::size_t rows_of(const std::string& text) {
  std::size_t rows = 0;
  for (std::size_t at = text.find("\n| "); at != std::string::npos; at = text.find("\n| ", at + 1)) ++rows;
  return rows - 1;  // without the heading
}

/// Methods a, b, c at random settings and errors; c never completes.
Chart random_chart(std::size_t points, std::mt19937& random) {
  Chart chart;
  std::uniform_real_distribution<double> error(1e-6, 1.0);
  for (std::size_t k = 0; k < points; ++k) {
    ChartPoint p;
    p.method.name = std::string(1, "abc"[k % 3]);
    p.method.overrides = {"run.time_step=" + std::to_string(k)};
    p.status = k % 3 == 2 ? "outside_its_range" : "completed";
    p.error = error(random);
    p.pareto = k % 3 != 2 && random() % 8 == 0;
    chart.points.push_back(p);
  }
  return chart;
}

}  // namespace

TEST_CASE("a page of the atlas shows the front and the most accurate point of each method", "[scenes][study]") {
  std::mt19937 random(68);
  for (int trial = 0; trial < 20; ++trial) {
    const std::size_t points = 1 + random() % 150;
    const Chart chart = random_chart(points, random);
    const std::string text = measured_text(chart, "study", {});
    INFO(text);
    std::map<std::string, std::size_t> best;
    for (std::size_t k = 0; k < points; ++k) {
      const ChartPoint& p = chart.points[k];
      const auto [found, is_new] = best.emplace(p.method.name, k);
      if (!is_new && p.good() && p.error < chart.points[found->second].error) found->second = k;
    }
    std::size_t expected = 0;
    for (std::size_t k = 0; k < points; ++k) {
      const bool shown = points <= 60 || chart.points[k].pareto || best[chart.points[k].method.name] == k;
      CHECK((text.find("time_step=" + std::to_string(k) + " |") != text.npos) == shown);
      expected += shown;
    }
    CHECK(rows_of(text) == expected);
    CHECK((text.find("all " + std::to_string(points) + " rows") != text.npos) == (points > 60));
  }
}
