#include <fmt/format.h>

#include <algorithm>

#include "scenes/study/limits.h"
#include "viz_export/files/json_writer.h"
#include "viz_export/report/charts.h"

namespace epafi {
namespace {

std::string file_name(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
  return name;
}

}  // namespace

std::string limits_csv(const LimitMap& map) {
  const auto& parameters = map.study.parameters;
  std::string out = "method,parameter,value,status,kind_of_failure,parameter_2,value_2,settings,detail,state_hash\n";
  for (const auto& c : map.cases) {
    const auto& m = map.study.methods[c.method];
    const bool two = c.at.size() == 2;
    out +=
        fmt::format("{},{},{:.9g},{},{},{},{},{},{},{}\n", csv_text(m.name), parameters.back().key, c.at.back(),
                    c.status, c.kind, two ? parameters.front().key : "", two ? fmt::format("{:.9g}", c.at.front()) : "",
                    csv_text(m.settings()), csv_text(c.detail), c.state_hash);
  }
  return out;
}

std::string limits_json(const LimitMap& map) {
  const auto& parameters = map.study.parameters;
  JsonWriter json;
  json.begin_object().member("title", map.study.title).member("scene", map.study.scene).key("limits").begin_array();
  for (const auto& l : map.limits) {
    json.begin_object()
        .member("method", map.study.methods[l.method].name)
        .member("settings", map.study.methods[l.method].settings());
    json.member("parameter", map.study.parameters.back().key)
        .member("at", l.at)
        .member("last_good", l.last_good)
        .member("first_failing", l.first_failing);
    json.member("kind_of_failure", l.kind).member("theory", l.theory).end_object();
  }
  json.end_array().key("cases").begin_array();
  for (const auto& c : map.cases)
    json.begin_object()
        .member("method", map.study.methods[c.method].name)
        .member("settings", map.study.methods[c.method].settings())
        .member("parameter", parameters.back().key)
        .member("value", c.at.back())
        .member("status", c.status)
        .member("kind_of_failure", c.kind)
        .end_object();
  json.end_array().end_object();
  return json.text() + "\n";
}

std::string limits_verdict(const LimitMap& map) {
  std::string out;
  const auto value = [](const std::optional<double>& v) {
    return v ? fmt::format("{:.6g}", *v) : std::string("beyond the range");
  };
  for (const auto& l : map.limits) {
    const auto& m = map.study.methods[l.method];
    out += fmt::format("{} [{}]", m.name, m.settings());
    if (l.at) out += fmt::format(", {} = {:.6g}", map.study.parameters.front().key, *l.at);
    out += fmt::format(": {} last good {}, first failing {}", map.study.parameters.back().key, value(l.last_good),
                       value(l.first_failing));
    if (!l.kind.empty()) out += " (" + l.kind + ")";
    if (l.theory) out += fmt::format("; theory {:.6g}", *l.theory);
    if (l.theory && !map.study.theory_label.empty()) out += " (" + map.study.theory_label + ")";
    out += "\n";
  }
  if (!map.whole) out += "the budget was spent: bisections end coarser than asked, values of scans are missing\n";
  return out;
}

void draw_limits(const LimitMap& map, const std::filesystem::path& folder) {
  const auto& study = map.study;
  const bool two = study.parameters.size() == 2, many = study.methods.size() > 1;
  for (std::size_t m = 0; m < study.methods.size(); ++m) {
    if (!two && m > 0) break;  // one parameter: all methods share a picture, a row each
    KindMap picture;
    picture.title = (study.title.empty() ? std::filesystem::path(study.file).stem().string() : study.title) +
                    (two && many ? ": " + study.methods[m].name : "");
    picture.x_label = two ? study.parameters.front().label : study.parameters.back().label;
    picture.y_label = two ? study.parameters.back().label : "method";
    picture.log_x = two ? study.parameters.front().log : study.parameters.back().log;
    picture.log_y = two && study.parameters.back().log;
    picture.kinds = {"ok"};
    for (const auto& c : map.cases) {
      if (two && c.method != m) continue;
      auto kind = std::find(picture.kinds.begin(), picture.kinds.end(), c.kind.empty() ? "ok" : c.kind);
      if (kind == picture.kinds.end()) kind = picture.kinds.insert(picture.kinds.end(), c.kind);
      const auto number = static_cast<std::size_t>(kind - picture.kinds.begin());
      if (two)
        picture.cells.push_back({c.at[0], c.at[1], number});
      else
        picture.cells.push_back({c.at[0], static_cast<double>(c.method), number});
    }
    if (!two) {
      for (std::size_t k = 0; k < study.methods.size(); ++k) picture.y_names.push_back(study.methods[k].name);
      if (!map.limits.empty() && map.limits.front().theory) {
        const double x = *map.limits.front().theory;
        picture.curve = {{x, -0.5}, {x, static_cast<double>(study.methods.size()) - 0.5}};
      }
    } else {
      for (const auto& l : map.limits)
        if (l.method == m && l.theory && l.at) picture.curve.push_back({*l.at, *l.theory});
    }
    picture.curve_label = study.theory_label.empty() ? "theory" : study.theory_label;
    draw(picture, folder / (two && many ? "limits_" + file_name(study.methods[m].name) : "limits"));
  }
}

}  // namespace epafi
