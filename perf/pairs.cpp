/// @file pairs.cpp  The table "worst error and ns of every shape pair": perf_pairs > docs/reference/pair_accuracy.md
/// Errors by tests/support/pair_errors.h over 400 random pairs per cell; the test of the same name holds the table to
/// them.
#include <cstdio>

#include "tests/support/pair_errors.h"

using namespace epafi;

int main() {
  std::printf(
      "# Accuracy and cost of every pair of shapes\n\n"
      "Made by `perf_pairs`; `tests/detection/test_pair_errors.cpp` holds the code to it. 400 random pairs per cell, "
      "from deep\n"
      "overlap to a radius apart. Error: of the gap, in units of the larger bounding radius, against the largest "
      "separation that\n"
      "climbing over directions finds. Uncertain: pairs that the narrow phase itself reports (interval wider than 1e-6 "
      "of the\n"
      "size). ns: CPU of one thread per cold query with contact points, on the machine that made the table; compare "
      "ratios.\n\n"
      "| A | B | method | worst error | uncertain | ns |\n|---|---|---|---|---|---|\n");
  bool sound = true;
  for (const auto& e : support::measure_cells(AllShapes{}, 400, true)) {
    std::printf("| %s | %s | %s | %.0e | %zu | %.0f |\n", e.a.c_str(), e.b.c_str(), e.method.c_str(),
                std::max(e.worst, 1e-16), e.degenerate, e.nanoseconds);
    sound = sound && e.worst < 1e-6;
  }
  return sound ? 0 : 1;
}
