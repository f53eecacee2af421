/// @file measure_rows.h  Reads measures.csv and progress.csv back: what a run that goes on or was cut has written there
/// since run.h5.
#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace epafi {

/// A row of these files. A line that is none (the head, one that is torn) has no value.
struct MeasureRow {
  double time = 0.0;  ///< [s]
  std::string measure, component;
  double value = 0.0;
};
[[nodiscard]] std::optional<MeasureRow> measure_row(const std::string& line);

/// Lines of a file that are no valid rows, except its head and a truncated last line.
struct GarbledRows {
  std::size_t count = 0, first_line = 0;  ///< line: from 1; 0 where the beginning of the file was passed over
  /// "FILE:LINE: ..."; empty where all rows can be read.
  [[nodiscard]] std::string text(const std::filesystem::path& path) const;
};

/// The rows after a time [s], in their order; of a very large file those of its last 8 MB. Empty where there is no
/// file.
[[nodiscard]] std::vector<MeasureRow> measure_rows(const std::filesystem::path& path,
                                                   double after = -std::numeric_limits<double>::infinity(),
                                                   GarbledRows* garbled = nullptr);

}  // namespace epafi
