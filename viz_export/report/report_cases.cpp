#include "viz_export/report/report_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "engine/units/error.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/report/html_text.h"
#include "viz_export/report/report_table.h"
#include "viz_export/report/run_facts.h"

namespace epafi {
namespace {

/// Overrides that differ between cases; for a single case, all of them.
std::vector<TableColumn> override_columns(const std::vector<ReportCase>& cases) {
  std::set<std::string> keys;
  for (const ReportCase& one : cases)
    for (const auto& [key, value] : one.set) keys.insert(key);
  std::vector<TableColumn> out;
  for (const std::string& key : keys) {
    TableColumn column{key};
    for (const ReportCase& one : cases) column.cells.push_back(one.set.contains(key) ? one.set.at(key) : "");
    if (!column.differs() && cases.size() != 1) continue;
    TableColumn few = column;
    few.shorten();
    // keep the digits that distinguish cases
    const bool alike =
        std::set(few.cells.begin(), few.cells.end()).size() < std::set(column.cells.begin(), column.cells.end()).size();
    if (!alike) column = std::move(few);
    out.push_back(std::move(column));
  }
  return out;
}

TableColumn summary_column(const std::vector<ReportCase>& cases, const std::string& name, const std::string& head) {
  TableColumn column{head};
  for (const ReportCase& one : cases) {
    const auto value = one.summary.number(name);
    column.cells.push_back(value ? fmt::format("{:.5g}", *value) : "");
  }
  return column;
}

std::vector<TableColumn> measured_columns(const std::vector<ReportCase>& cases) {
  std::map<std::string, MeasureUnit> measured;
  for (const ReportCase& one : cases) {
    measured.insert(one.measured.begin(), one.measured.end());
    for (const auto& [name, value] : one.summary.numbers)
      if (name.starts_with("measures.") && name.ends_with(".last"))
        measured.insert({name.substr(9, name.size() - 14), {}});
  }
  std::vector<TableColumn> out;
  for (const auto& [name, unit] : measured) {
    const std::string head = unit.unit.empty() ? name : name + " [" + unit.unit + "]";
    out.push_back(summary_column(cases, "measures." + name + ".last", head));
  }
  return out;
}

}  // namespace

bool has_ended(const ReportCase& one) {
  const std::string status = one.summary.text("status");
  return status != "running" && status != "cut" && status != "interrupted" && status != "unreadable";
}

ReportCase read_case(const std::filesystem::path& folder) {
  ReportCase out{folder.filename().string(), {}};
  try {
    out.summary = run_facts(folder);
  } catch (const FileError& e) {  // torn or unreadable: the other cases have their page all the same
    out.summary.texts = {{"status", "unreadable"}, {"failure", e.what()}};
  }
  if (out.summary.text("status") == "cut") out.summary.texts["failure"] = open_run(folder)->cut_text();
  try {
    const StoredRun run(folder / "run.h5");
    out.title = run.title();
    std::istringstream lines(run.overrides());
    for (std::string line; std::getline(lines, line);)
      if (const std::size_t equal = line.find('='); equal != line.npos)
        out.set[line.substr(0, equal)] = line.substr(equal + 1);
    for (const StoredMeasure& m : run.measures())
      for (const std::string& c : m.components) out.measured[m.name + "." + c] = measure_unit(m.kind, c);
  } catch (const FileError&) {
  }
  return out;
}

std::string cases_html(const std::vector<ReportCase>& cases) {
  TableColumn name{"case"}, status{"status"};
  for (const ReportCase& one : cases) {
    name.cells.push_back(one.name);
    status.cells.push_back(one.summary.text("status"));
  }
  std::vector<TableColumn> columns{name, status};
  const auto add = [&](std::vector<TableColumn> more) {
    for (TableColumn& column : more)
      if (column.says_something()) columns.push_back(std::move(column));
  };
  add(override_columns(cases));
  for (const auto& [key, head] : {std::pair{"bodies", "bodies"},
                                  {"simulated_time", "time [s]"},
                                  {"wall_time", "wall time [s]"},
                                  {"ns_per_body_step", "ns per body and step"},
                                  {"energy.relative_error", "energy error"},
                                  {"overlap.max_relative", "overlap over radius"},
                                  {"residual.max", "residual"}})
    add({summary_column(cases, key, head)});
  add(measured_columns(cases));
  return "<h2>Cases</h2>" + table_html(columns, cases.size(), "-");
}

std::string warnings_html(const std::vector<ReportCase>& cases) {
  constexpr std::size_t most = 3, most_folded = 100;
  std::vector<std::string> all;
  for (const ReportCase& one : cases)
    for (const auto& [name, text] : one.summary.texts)
      if (name.starts_with("warnings.") || (name == "failure" && !text.empty())) all.push_back(one.name + ": " + text);
  std::string html;
  const auto add = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < std::min(to, all.size()); ++k)
      html += "<p class='warning'>" + html_escaped(all[k]) + "</p>";
  };
  add(0, most);
  if (all.size() <= most) return html;
  html += fmt::format("<details class='warnings'><summary>{} more warning{}</summary>", all.size() - most,
                      all.size() > most + 1 ? "s" : "");
  add(most, most_folded);
  if (all.size() > most_folded) html += fmt::format("<p class='warning'>and {} more</p>", all.size() - most_folded);
  return html + "</details>";
}

}  // namespace epafi
