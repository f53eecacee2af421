#include "viz_export/measures/measure_rows.h"

#include <algorithm>
#include <charconv>
#include <fstream>

namespace epafi {
namespace {

bool is_number(const std::string& line, std::size_t begin, std::size_t end, double& out) {
  const auto result = std::from_chars(line.data() + begin, line.data() + end, out);
  return result.ec == std::errc() && result.ptr == line.data() + end;
}

/// Reads a field written by csv_field.
std::string unquoted(std::string text) {
  if (text.size() < 2 || text.front() != '"') return text;
  text = text.substr(1, text.size() - 2);
  for (std::size_t at = text.find("\"\""); at != text.npos; at = text.find("\"\"", at + 1)) text.erase(at, 1);
  return text;
}

}  // namespace

std::optional<MeasureRow> measure_row(const std::string& line) {
  const std::size_t first = line.find(','), last = line.rfind(',');
  if (first == line.npos || last <= first) return std::nullopt;
  const std::size_t middle = line.rfind(',', last - 1);  // components are words without commas
  MeasureRow row;
  const bool numbers = is_number(line, 0, first, row.time) && is_number(line, last + 1, line.size(), row.value);
  if (!numbers || middle == line.npos || middle <= first) return std::nullopt;
  row.measure = unquoted(line.substr(first + 1, middle - first - 1));
  row.component = unquoted(line.substr(middle + 1, last - middle - 1));
  return row;
}

std::string GarbledRows::text(const std::filesystem::path& path) const {
  if (count == 0) return {};
  const std::string place = first_line > 0 ? ":" + std::to_string(first_line) : "";
  const std::string more = count > 1 ? " (and " + std::to_string(count - 1) + " more such lines)" : "";
  return path.string() + place + ": no row 'time,measure,component,value'" + more + "; it is left out";
}

std::vector<MeasureRow> measure_rows(const std::filesystem::path& path, double after, GarbledRows* garbled) {
  constexpr std::uintmax_t most = 8 << 20;
  std::vector<MeasureRow> out;
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  std::ifstream in(path, std::ios::binary);
  if (none || !in) return out;
  std::string line;
  if (size > most) {
    in.seekg(static_cast<std::streamoff>(size - most));
    std::getline(in, line);
  }
  const bool from_start = size <= most;
  for (std::size_t number = 1; std::getline(in, line) && !in.eof(); ++number) {  // at eof the line is not whole yet
    auto row = measure_row(line);
    const bool is_head = from_start && number == 1;
    if (!row && garbled != nullptr && !is_head && garbled->count++ == 0) garbled->first_line = from_start ? number : 0;
    if (row && row->time > after) out.push_back(std::move(*row));
  }
  return out;
}

}  // namespace epafi
