/// @file telling_rows.h  Selected rows of a long measure for a curve.
#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

#include "viz_export/hdf5/stored_run.h"

namespace epafi {

/// The first and the last row, and of each interval those with the least and the largest value of this component, so
/// that short peaks are not missed. Ascending, at most `most`.
[[nodiscard]] inline std::vector<std::size_t> telling_rows(const StoredMeasure& m, std::size_t component,
                                                           std::size_t most) {
  const std::size_t n = m.times.size(), width = m.components.size(), stretches = most > 4 ? most / 2 - 1 : 1;
  std::vector<std::size_t> out;
  const auto value = [&](std::size_t k) { return m.values[k * width + component]; };
  const auto add = [&](std::size_t k) {
    if (out.empty() || out.back() < k) out.push_back(k);
  };
  if (n <= most) {
    for (std::size_t k = 0; k < n; ++k) out.push_back(k);
    return out;
  }
  add(0);
  for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
    const std::size_t begin = stretch * n / stretches, end = (stretch + 1) * n / stretches;
    std::size_t low = begin, high = begin;
    for (std::size_t k = begin; k < end; ++k) {
      if (!std::isfinite(value(k))) continue;
      if (!std::isfinite(value(low)) || value(k) < value(low)) low = k;
      if (!std::isfinite(value(high)) || value(k) > value(high)) high = k;
    }
    add(low < high ? low : high);
    add(low < high ? high : low);
  }
  add(n - 1);
  return out;
}

}  // namespace epafi
