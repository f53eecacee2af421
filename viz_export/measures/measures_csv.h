/// @file measures_csv.h  measures.csv, long format: `time,measure,component,value`, 17 digits, so that it reads back to
/// the same bits. Rows are buffered; flush() before a checkpoint, so that a resumed run can cut the file to the
/// checkpoint.
#pragma once
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace epafi {

/// A CSV field: quoted where it holds a comma, a quote or a line break (RFC 4180).
std::string csv_field(std::string_view text);

class MeasuresCsv {
 public:
  /// A new file with its header line.
  explicit MeasuresCsv(const std::filesystem::path& path);
  /// Continues a file: rows later than `time` [s] and a torn last line are cut off.
  MeasuresCsv(const std::filesystem::path& path, double time);
  ~MeasuresCsv();
  MeasuresCsv(const MeasuresCsv&) = delete;
  MeasuresCsv& operator=(const MeasuresCsv&) = delete;

  void add(double time, std::string_view measure, std::string_view component, double value);
  /// Hands the rows to the system; throws FileError where they could not be written.
  void flush();
  /// The same once a second, so that others can follow a run: to be called often.
  void flush_each_second();

 private:
  std::filesystem::path path_;
  std::ofstream out_;
  std::string buffer_;
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
};

}  // namespace epafi
