#include "scenes/study/chart_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <sstream>

#include "scenes/reader/text_cells.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

/// A table with the names of its columns in the first line.
class RowReader {
 public:
  RowReader(const std::string& file, const std::string& head) : file_(file) {
    const std::vector<TextCell> names = cells_of_line(head);
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
    cells_ = cells_of_line(line);
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
    const TextCell& cell = cells_[found->second];
    const auto value = read_number(cell.text);
    if (!value || *value < 0.0)
      throw SceneError(fmt::format("'{}' found as {}, expected a number >= 0", cell.text, name),
                       {file_, line_, cell.column});
    return *value;
  }

 private:
  std::string file_;
  std::map<std::string, std::size_t> columns_;
  std::vector<TextCell> cells_;
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
  std::istringstream in(read_whole_file(file));
  std::string line;
  int number = 0;
  next_text_line(in, line, number);
  RowReader row(file, line);
  std::vector<ChartPoint> points;
  while (next_text_line(in, line, number)) {
    if (line.empty()) continue;
    row.begin(line, number);
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
