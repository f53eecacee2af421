/// @file chart_rows.h  Rows that others measured on the problem of a study: `epafi chart STUDY --with FILE.csv`.
#pragma once
#include <string>

#include "scenes/study/chart.h"

namespace epafi {

/// Rows of a CSV file with the columns of chart.csv (another chart.csv is one): method, time and error, in the units of
/// the study's chart; settings, status, error_spread, time_spread and error:NAME where there are any. Throws SceneError
/// with the place of what is wrong, FileError where the file cannot be read.
std::vector<ChartPoint> read_rows(const Study& study, const std::string& file);

/// Adds them to a chart. They may lie on the front; they are never recommended, as no scene can set them.
void add_rows(Chart& chart, const std::vector<ChartPoint>& rows);

}  // namespace epafi
