#include "viz_export/measures/measures_csv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "engine/units/error.h"

namespace epafi {

namespace {

constexpr std::string_view header = "time,measure,component,value";
constexpr std::size_t buffer_bytes = 1 << 16;

/// Bytes of the file up to and including the last whole row not later than `time`. Rows are in order of time.
std::uintmax_t bytes_until(const std::filesystem::path& path, double time) {
  if (!std::filesystem::exists(path)) throw FileError(path.string() + ": cannot continue it: it is not there");
  std::ifstream in(path, std::ios::binary);
  std::string line;
  if (!in || !std::getline(in, line) || line != header || in.eof())
    throw FileError(path.string() + ": cannot continue it: its first line is not '" + std::string(header) + "'");
  std::uintmax_t kept = line.size() + 1;
  std::uintmax_t here = kept;
  while (std::getline(in, line) && !in.eof()) {  // at eof the line has no end: it is torn
    here += line.size() + 1;
    double row_time = 0.0;
    const char* end = line.data() + line.size();
    const auto result = std::from_chars(line.data(), end, row_time);
    const bool starts_row = result.ec == std::errc() && result.ptr != end && *result.ptr == ',';
    if (starts_row && row_time > time) return kept;  // else the rest of a quoted name with a line break: kept
    kept = here;
  }
  return kept;
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

MeasuresCsv::MeasuresCsv(const std::filesystem::path& path) : path_(path), out_(path, std::ios::binary) {
  if (!out_) throw FileError(path.string() + ": cannot create");
  buffer_ = std::string(header) + "\n";
  flush();
}

MeasuresCsv::MeasuresCsv(const std::filesystem::path& path, double time) : path_(path) {
  std::error_code cause;
  std::filesystem::resize_file(path, bytes_until(path, time), cause);
  if (cause) throw FileError(path.string() + ": cannot cut it to the checkpoint: " + cause.message());
  out_.open(path, std::ios::binary | std::ios::app);
  if (!out_) throw FileError(path.string() + ": cannot open to continue");
}

MeasuresCsv::~MeasuresCsv() {
  out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));  // an error is only reported by flush()
}

void MeasuresCsv::add(double time, std::string_view measure, std::string_view component, double value) {
  constexpr double no_value = std::numeric_limits<double>::quiet_NaN();  // of one sign
  fmt::format_to(std::back_inserter(buffer_), "{:.17g},{},{},{:.17g}\n", time, csv_field(measure), csv_field(component),
                 std::isnan(value) ? no_value : value);
  if (buffer_.size() > buffer_bytes) flush();
}

void MeasuresCsv::flush() {
  out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_.clear();
  out_.flush();
  flushed_ = std::chrono::steady_clock::now();
  if (!out_) throw FileError(path_.string() + ": cannot write (is the disk full?)");
}

void MeasuresCsv::flush_each_second() {
  if (buffer_.empty()) return;
  if (std::chrono::steady_clock::now() - flushed_ > std::chrono::seconds(1)) flush();
}

}  // namespace epafi
