#include "viz_export/report/report_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <sstream>

#include "viz_export/files/side_file.h"
#include "viz_export/report/html_text.h"

namespace epafi {
namespace {

constexpr std::size_t most_rows = 500;    // of a table; the CSV has them all
constexpr std::size_t open_rows = 60;     // longer tables are folded up
constexpr std::size_t seen_columns = 9;   // of a page at least; more may lie beyond its edge
constexpr std::size_t longest_line = 40;  // characters of a cell; longer ones are broken between words

bool is_number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  return !text.empty() && std::from_chars(text.data(), end, value).ptr == end;
}

/// Lets lines break after the dots of keys.
std::string breakable(const std::string& head) {
  std::string out;
  for (std::size_t k = 0; k < head.size(); ++k) {
    out += head[k];
    if (head[k] == '.' && k + 1 < head.size()) out += "<wbr>";
  }
  return out;
}

/// Rounds to six digits; integers are unchanged.
std::string shortened(const std::string& number) {
  constexpr std::size_t few = 7;  // characters
  const bool whole = number.find_first_not_of("-0123456789") == number.npos;
  double value = 0;
  std::from_chars(number.data(), number.data() + number.size(), value);
  return whole || number.size() <= few ? number : fmt::format("{:.6g}", value);
}

/// Removes columns that are empty or constant over several rows; returns the constants as a text below the table.
std::string take_out_constants(std::vector<TableColumn>& columns) {
  std::string same, nothing;
  std::erase_if(columns, [&](const TableColumn& column) {
    const bool says = column.says_something();
    if (says && (column.differs() || column.cells.size() < 2)) return false;
    std::string& list = says ? same : nothing;
    list += (list.empty() ? "" : ", ") + column.head + (says ? " = " + column.cells.front() : "");
    return true;
  });
  std::string html;
  if (!same.empty()) html += "<p class='sub'>The same in all rows: " + html_escaped(same) + "</p>";
  if (!nothing.empty()) html += "<p class='sub'>Empty in all rows: " + html_escaped(nothing) + "</p>";
  return html;
}

/// Fields of a line; quotes as in RFC 4180, without line breaks inside.
std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      out.emplace_back();
    else if (c != '\r')
      out.back() += c;
  }
  return out;
}

/// Reads the columns; the first line that is neither empty nor a comment has their names.
std::vector<TableColumn> csv_columns(const std::filesystem::path& path, std::size_t& rows) {
  std::vector<TableColumn> columns;
  std::istringstream in(read_whole_file(path));
  bool has_heads = false;
  rows = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string> fields = csv_fields(line);
    if (columns.size() < fields.size()) columns.resize(fields.size());
    for (std::size_t c = 0; c < fields.size(); ++c) {
      if (!has_heads) columns[c].head = fields[c];
      if (!has_heads || rows >= most_rows) continue;
      columns[c].cells.resize(rows);
      columns[c].cells.push_back(fields[c]);
    }
    rows += has_heads ? 1 : 0;
    has_heads = true;
  }
  for (TableColumn& column : columns) column.cells.resize(std::min(rows, most_rows));
  return columns;
}

}  // namespace

bool TableColumn::says_something() const {
  return std::any_of(cells.begin(), cells.end(), [](const std::string& c) { return !c.empty(); });
}

bool TableColumn::differs() const {
  return std::adjacent_find(cells.begin(), cells.end(), std::not_equal_to<>()) != cells.end();
}

bool TableColumn::is_numeric() const {
  const auto fits = [](const std::string& c) { return c.empty() || is_number(c); };
  return says_something() && std::all_of(cells.begin(), cells.end(), fits);
}

void TableColumn::shorten() {
  if (!is_numeric()) return;
  for (std::string& cell : cells)
    if (!cell.empty()) cell = shortened(cell);
}

std::string table_html(const std::vector<TableColumn>& columns, std::size_t most, const std::string& empty) {
  std::vector<const char*> kind;
  std::size_t rows = 0;
  std::string html = "<div class='wide'><table class='data'><tr>";
  for (const TableColumn& column : columns) {
    kind.push_back(column.is_numeric() ? " class='n'" : "");
    rows = std::max(rows, column.cells.size());
    html += fmt::format("<th{}>{}</th>", kind.back(), breakable(html_escaped(column.head)));
  }
  html += "</tr>";
  for (std::size_t row = 0; row < std::min(rows, most); ++row) {
    html += "<tr>";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string& cell = columns[c].cells[row];
      const std::string text = html_escaped(cell.empty() ? empty : cell);
      html += cell.size() > longest_line ? "<td><div class='long'>" + text + "</div></td>"
                                         : fmt::format("<td{}>{}</td>", kind[c], text);
    }
    html += "</tr>";
  }
  html += "</table></div>";
  if (columns.size() > seen_columns) html += "<p class='sub'>This table moves sideways: more columns to the right.</p>";
  return html;
}

std::string csv_html(const std::filesystem::path& path) {
  std::size_t rows = 0;
  std::vector<TableColumn> columns = csv_columns(path, rows);
  for (TableColumn& column : columns) column.shorten();
  const std::string below = rows > 0 && rows <= most_rows ? take_out_constants(columns) : "";
  std::string html = (columns.empty() ? "" : table_html(columns, most_rows, "")) + below;
  if (rows > most_rows) html += fmt::format("<p class='sub'>{} of {} rows</p>", most_rows, rows);
  if (rows > open_rows) html = fmt::format("<details><summary>{} rows</summary>{}</details>", rows, html);
  return "<h2>" + html_escaped(path.filename().string()) + "</h2>" + html;
}

}  // namespace epafi
