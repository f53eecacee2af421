#include <algorithm>
#include <cmath>
#include <sstream>

#include "detection/profiles/track.h"
#include "engine/units/units.h"

namespace epafi {
namespace {

std::vector<std::string> words_of(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::replace(line.begin(), line.end(), ';', ' ');
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string w; in >> w;) out.push_back(w);
  return out;
}

/// The column of the track that a header's word names; null for another word.
std::vector<double>* column(MeasuredTrack& t, const std::string& word) {
  return word == "s"             ? &t.distance
         : word == "lateral"     ? &t.lateral
         : word == "vertical"    ? &t.vertical
         : word == "cross_level" ? &t.cross_level
         : word == "gauge"       ? &t.gauge
                                 : nullptr;
}

/// '# unit: mm'. Each of these says what is wrong, or "".
std::string read_unit(const std::vector<std::string>& words, double& unit) {
  const auto at = std::find(words.begin(), words.end(), "unit:");
  if (at == words.end() || at + 1 == words.end()) return "";
  const QuantityResult q = read_quantity("1 " + *(at + 1), "m");
  if (!q.value) return "unit '" + *(at + 1) + "': " + q.problem;
  unit = *q.value;
  return "";
}

std::string read_heads(const std::vector<std::string>& words, MeasuredTrack& track,
                       std::vector<std::vector<double>*>& columns) {
  for (const auto& w : words) {
    columns.push_back(column(track, w));
    if (!columns.back()) return "unknown column '" + w + "'; s, lateral, vertical, cross_level, gauge";
  }
  return columns[0] == &track.distance ? "" : "the first column must be s";
}

std::string read_row(const std::vector<std::string>& words, double unit,
                     const std::vector<std::vector<double>*>& columns) {
  if (words.size() != columns.size())
    return "expected " + std::to_string(columns.size()) + " numbers, found " + std::to_string(words.size());
  for (std::size_t k = 0; k < words.size(); ++k) {
    char* end = nullptr;
    const double v = std::strtod(words[k].c_str(), &end);
    if (*end != '\0' || !std::isfinite(v)) return "'" + words[k] + "' is not a number";
    columns[k]->push_back(k == 0 ? v : v * unit);
  }
  const std::vector<double>& s = *columns[0];
  return s.size() > 1 && !(s.back() > s[s.size() - 2]) ? "s does not increase" : "";
}

}  // namespace

MeasuredFile read_irregularity(const std::string& text) {
  MeasuredFile out;
  std::istringstream in(text);
  double unit = 0.0;
  std::vector<std::vector<double>*> columns;
  for (std::string line; std::getline(in, line);) {
    ++out.line;
    const auto words = words_of(line);
    if (words.empty()) continue;
    if (words[0][0] == '#')
      out.problem = read_unit(words, unit);
    else if (unit == 0.0)
      out.problem = "the first line must state the unit, as in '# unit: mm'; s is in m";
    else if (columns.empty())
      out.problem = read_heads(words, out.track, columns);
    else
      out.problem = read_row(words, unit, columns);
    if (!out.problem.empty()) return out;
  }
  if (out.track.distance.size() < 2) {
    out.problem = "a measured track has at least 2 lines of numbers";
    return out;
  }
  out.line = 0;
  return out;
}

}  // namespace epafi
