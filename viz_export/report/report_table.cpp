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

constexpr std::size_t most_rows = 500;  // of a table; the CSV has them all
constexpr std::size_t open_rows = 60;   // longer tables are folded up

bool is_number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  return !text.empty() && std::from_chars(text.data(), end, value).ptr == end;
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

/// The first line that is not empty and no comment has the heads.
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

std::string table_html(const std::vector<TableColumn>& columns, std::size_t most, const std::string& empty) {
  std::vector<const char*> kind;
  std::size_t rows = 0;
  std::string html = "<div style='overflow-x:auto'><table><tr>";
  for (const TableColumn& column : columns) {
    kind.push_back(column.is_numeric() ? " class='n'" : "");
    rows = std::max(rows, column.cells.size());
    html += fmt::format("<th{}>{}</th>", kind.back(), html_escaped(column.head));
  }
  html += "</tr>";
  for (std::size_t row = 0; row < std::min(rows, most); ++row) {
    html += "<tr>";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string& cell = columns[c].cells[row];
      html += fmt::format("<td{}>{}</td>", kind[c], html_escaped(cell.empty() ? empty : cell));
    }
    html += "</tr>";
  }
  return html + "</table></div>";
}

std::string csv_html(const std::filesystem::path& path) {
  std::size_t rows = 0;
  std::string html = table_html(csv_columns(path, rows), most_rows, "");
  if (rows > most_rows) html += fmt::format("<p class='sub'>{} of {} rows</p>", most_rows, rows);
  if (rows > open_rows) html = fmt::format("<details><summary>{} rows</summary>{}</details>", rows, html);
  return "<h2>" + html_escaped(path.filename().string()) + "</h2>" + html;
}

}  // namespace epafi
