/// @file pairs.cpp  The table "worst error and ns of every shape pair": perf_pairs > docs/reference/pair_accuracy.md
/// With a path it also draws it: perf_pairs docs/atlas/narrow_pairs (svg and png).
/// Errors by tests/support/pair_errors.h over 400 random pairs per cell; the test of the same name holds the table to
/// them.
#include <algorithm>
#include <cstdio>

#include "tests/support/pair_errors.h"
#include "viz_export/report/charts.h"

using namespace epafi;

namespace {

/// Error over time, one mark per pair of shapes, one colour per method.
void draw_cells(const std::vector<support::PairError>& cells, const char* path) {
  ScatterPlot plot{"Every pair of shapes: worst error of 400 random pairs",
                   "processor seconds per cold query with contact points",
                   "error of the gap / larger bounding radius",
                   {},
                   {},
                   {},
                   {},
                   false};
  for (const auto& e : cells) {
    auto line =
        std::find_if(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& l) { return l.label == e.method; });
    if (line == plot.lines.end()) line = plot.lines.insert(plot.lines.end(), PlotLine{e.method, {}, {}});
    line->points.push_back({1e-9 * e.nanoseconds, std::max(e.worst, 1e-16)});
  }
  draw(plot, path);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf(
      "# Accuracy and cost of every pair of shapes\n\n"
      "Made by `perf_pairs`; `tests/detection/test_pair_errors.cpp` holds the code to it. 400 random pairs per cell, "
      "from deep\n"
      "overlap to a radius apart. Error: of the gap, in units of the larger bounding radius, against the largest "
      "separation that\n"
      "climbing over directions finds. Uncertain: pairs that the narrow phase itself reports (interval wider than 1e-6 "
      "of the\n"
      "size). A mesh is the closed surface of a hull of 6 to 25 vertices (8 to 46 triangles), apart from the other "
      "body or\n"
      "entered by at most a hundredth of the size; its ns hold the search for candidates. ns: CPU of one thread per "
      "cold query\n"
      "with contact points, on the machine that made the table; compare ratios.\n\n"
      "| A | B | method | worst error | uncertain | ns |\n|---|---|---|---|---|---|\n");
  bool sound = true;
  const auto cells = support::measure_cells(AllShapes{}, 400, true);
  for (const auto& e : cells) {
    std::printf("| %s | %s | %s | %.0e | %zu | %.0f |\n", e.a.c_str(), e.b.c_str(), e.method.c_str(),
                std::max(e.worst, 1e-16), e.degenerate, e.nanoseconds);
    sound = sound && e.worst < 1e-6;
  }
  if (argc > 1) draw_cells(cells, argv[1]);
  return sound ? 0 : 1;
}
