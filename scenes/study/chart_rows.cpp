#include "scenes/study/chart_rows.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>

#include "viz_export/side_file.h"

namespace epafi {
namespace {

struct Cell {
  std::string text;
  int column = 1;  ///< where it begins in its line
};

/// The cells of a line. Quotes keep commas; two in quotes are one.
std::vector<Cell> cells_of(const std::string& line) {
  std::vector<Cell> cells(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (c == '"' && quoted && k + 1 < line.size() && line[k + 1] == '"') {
      cells.back().text += c;
      ++k;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.push_back({"", static_cast<int>(k) + 2});
    } else if (c != '\r') {
      cells.back().text += c;
    }
  }
  return cells;
}

/// A table with the names of its columns in the first line.
class RowReader {
 public:
  RowReader(const std::string& file, const std::string& head) : file_(file) {
    const std::vector<Cell> names = cells_of(head);
    for (std::size_t k = 0; k < names.size(); ++k) columns_[names[k].text] = k;
    for (const char* needed : {"method", "time", "error"})
      if (!columns_.contains(needed))
        throw SceneError(fmt::format("no column '{}'; rows have the columns of chart.csv: method, time, error; "
                                     "settings, status, error_spread, time_spread, error:NAME where there are any",
                                     needed),
                         {file, 1, 1});
  }

  void begin(const std::string& line, int number) {
    line_ = number;
    cells_ = cells_of(line);
    if (cells_.size() != columns_.size())
      throw SceneError(fmt::format("{} cells below {} columns", cells_.size(), columns_.size()), {file_, line_, 1});
  }
  std::string text(const std::string& name, const std::string& otherwise) const {
    const auto found = columns_.find(name);
    return found == columns_.end() ? otherwise : cells_[found->second].text;
  }
  /// >= 0; NaN where the cell is empty or there is no such column.
  double number(const std::string& name) const {
    const auto found = columns_.find(name);
    if (found == columns_.end() || cells_[found->second].text.empty()) return NAN;
    const Cell& cell = cells_[found->second];
    double value = 0.0;
    const char* end = cell.text.data() + cell.text.size();
    const auto [stop, trouble] = std::from_chars(cell.text.data(), end, value);
    if (trouble != std::errc{} || stop != end || !(value >= 0.0) || std::isinf(value))
      throw SceneError(fmt::format("'{}' found as {}, expected a number >= 0", cell.text, name),
                       {file_, line_, cell.column});
    return value;
  }

 private:
  std::string file_;
  std::map<std::string, std::size_t> columns_;
  std::vector<Cell> cells_;
  int line_ = 1;
};

ChartPoint point_of(const RowReader& row, const Study& study) {
  ChartPoint p;
  p.method.name = row.text("method", "");
  if (const std::string settings = row.text("settings", ""); !settings.empty()) p.method.overrides = {settings};
  p.status = row.text("status", "completed");
  if (p.status == "ok" || p.status.empty()) p.status = "completed";
  p.time = row.number("time");
  p.error = row.number("error");
  p.error_spread = std::max(0.0, row.number("error_spread"));
  p.time_spread = std::max(0.0, row.number("time_spread"));
  p.least_time = std::max(0.0, p.time - 0.5 * p.time_spread);
  for (const ErrorSpec& e : study.more_errors)
    p.more_errors.push_back(row.number("error:" + e.name + (e.component.empty() ? "" : "." + e.component)));
  if (!(p.time > 0.0)) {
    p.status = "not_run";
    p.time = 0.0;
  }
  if (p.good() && std::isnan(p.error)) p.status = "no error";
  return p;
}

}  // namespace

std::vector<ChartPoint> read_rows(const Study& study, const std::string& file) {
  if (!study.axis.empty())
    throw SceneError(file + ": rows have no value of the axis '" + study.axis + "' of this study");
  const std::string text = read_whole_file(file);
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  RowReader row(file, lines.empty() ? "" : lines.front());
  std::vector<ChartPoint> points;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    if (lines[k].empty() || lines[k] == "\r") continue;
    row.begin(lines[k], static_cast<int>(k) + 1);
    points.push_back(point_of(row, study));
  }
  return points;
}

void add_rows(Chart& chart, const std::vector<ChartPoint>& rows) {
  chart.points.insert(chart.points.end(), rows.begin(), rows.end());
  for (ChartPoint& p : chart.points) p.pareto = false;
  mark_front(chart);
}

}  // namespace epafi
