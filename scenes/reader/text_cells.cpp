#include "scenes/reader/text_cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace epafi {
namespace {

constexpr const char* byte_order_mark = "\xef\xbb\xbf";
constexpr const char* blank = " \t\r";

/// End of the cell that begins at `begin`: the next separator outside quotes.
std::size_t end_of_cell(const std::string& line, std::size_t begin, char separator) {
  if (separator == ' ') return std::min(line.find_first_of(blank, begin), line.size());
  bool quoted = false;
  for (std::size_t k = begin; k < line.size(); ++k) {
    if (line[k] == '"') quoted = !quoted;
    if (line[k] == separator && !quoted) return k;
  }
  return line.size();
}

/// Removes quotes: "a ""b""" becomes a "b"; other texts are unchanged.
std::string without_quotes(const std::string& text) {
  if (text.size() < 2 || text.front() != '"' || text.back() != '"') return text;
  std::string out;
  for (std::size_t k = 1; k + 1 < text.size(); ++k) {
    out += text[k];
    if (text[k] == '"') ++k;  // the second of two
  }
  return out;
}

TextCell cell_between(const std::string& line, std::size_t begin, std::size_t end) {
  const std::size_t first = std::min(line.find_first_not_of(blank, begin), end);
  std::size_t last = end;
  while (last > first && std::string(blank).find(line[last - 1]) != std::string::npos) --last;
  return {without_quotes(line.substr(first, last - first)), static_cast<int>(first) + 1};
}

}  // namespace

bool next_text_line(std::istream& in, std::string& line, int& number) {
  if (!std::getline(in, line)) return false;
  ++number;
  if (number == 1 && line.rfind(byte_order_mark, 0) == 0) line.erase(0, 3);
  line.erase(line.find_last_not_of(std::string("\r\0", 2)) + 1);
  return true;
}

std::vector<TextCell> cells_of_line(const std::string& line, char separator, std::size_t begin) {
  std::vector<TextCell> cells;
  if (separator == ' ') begin = line.find_first_not_of(blank, begin);
  while (begin <= line.size()) {
    const std::size_t end = end_of_cell(line, begin, separator);
    cells.push_back(cell_between(line, begin, end));
    begin = separator == ' ' ? line.find_first_not_of(blank, end) : end + 1;
  }
  return cells;
}

std::optional<double> read_number(const std::string& text) {
  double value = 0.0;
  const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(begin, end, value);
  if (read.ec != std::errc{} || read.ptr != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace epafi
