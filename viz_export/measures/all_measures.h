/// @file all_measures.h  The list of measures: one line per kind.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "viz_export/measures/measure.h"

namespace epafi {

struct MeasureEntry {
  Entry entry;
  std::function<std::unique_ptr<Measure>(MeasureSetup)> make;
};

const std::vector<MeasureEntry>& all_measures();

}  // namespace epafi
