#include <cmath>

#include "engine/units/units.h"
#include "scenes/reader/table_reader.h"

namespace epafi {
namespace {

constexpr int deepest_params = 100;          // parameters that are expressions of each other
constexpr std::size_t most_problems = 1000;  // a file with more is no scene

/// The expression behind "=", or an empty view.
std::string_view expression_of(const Node& node) {
  if (node.type != Node::Type::text) return {};
  const std::size_t start = node.text.find_first_not_of(' ');
  if (start == std::string::npos || node.text[start] != '=') return {};
  return std::string_view(node.text).substr(start + 1);
}

}  // namespace

void Reading::report(Problem::Level level, const Place& place, std::string text) {
  errors_ += level == Problem::Level::error;
  if (problems.size() < most_problems) problems.push_back({level, place, std::move(text)});
}

std::vector<std::string> Reading::known_names() const {
  std::vector<std::string> names;
  for (const auto& [name, value] : indices) names.push_back(name);
  if (const Node* params = root.find("params"))
    for (const auto& member : params->members) names.push_back(member.key);
  return names;
}

NameValue Reading::look_up(std::string_view name) {
  using Status = NameValue::Status;
  for (const auto& [index, value] : indices)
    if (index == name) return {Status::found, value};
  const Node* params = root.find("params");
  const Node* node = params ? params->find(name) : nullptr;
  if (!node && name == "seed") {  // that of [run], where no parameter has the name
    const Node* run = root.find("run");
    const Node* seed = run ? run->find(name) : nullptr;
    return {Status::found, seed && seed->is_number() ? seed->real : 1.0};
  }
  if (!node) return {};
  Param& param = params_[std::string(name)];
  if (param.state == Param::State::waiting) {
    param.state = Param::State::busy;
    const auto outer = std::move(indices);  // a parameter does not see i, j, k
    indices.clear();
    const std::string label = "[params] " + std::string(name);
    std::optional<double> value;
    if (++param_depth_ > deepest_params)
      error(node->place, label + ": more than 100 parameters depend on each other");
    else
      value = number(*node, std::string(any_unit), label);
    --param_depth_;
    indices = outer;
    param = {value ? Param::State::done : Param::State::failed, value.value_or(0.0)};
  } else if (param.state == Param::State::busy) {
    error(node->place, "[params] " + std::string(name) + " depends on itself");
    return {Status::failed, 0.0};
  }
  if (param.state == Param::State::done) return {Status::found, param.value};
  ++errors_;  // said once, at the parameter; whoever asks now goes without a value all the same
  return {Status::failed, 0.0};
}

std::optional<double> Reading::expression(const Node& node, const std::string& label) {
  return expression(node, label,
                    {[this](std::string_view name) { return look_up(name); }, [this] { return known_names(); }});
}

std::function<double(double)> Reading::time_expression(const Node& node, const std::string& label) {
  std::map<std::string, double, std::less<>> values;
  const auto look = [&](std::string_view name) {
    if (name == "t") return NameValue{NameValue::Status::found, 0.0};
    const NameValue found = look_up(name);
    if (found.status == NameValue::Status::found) values.emplace(name, found.value);
    return found;
  };
  const auto names = [this] {
    auto all = known_names();
    all.push_back("t");
    return all;
  };
  if (!expression(node, label, {look, names})) return [](double) { return 0.0; };
  return [text = std::string(expression_of(node)), values = std::move(values)](double t) {
    const auto value_of = [&](std::string_view name) {
      if (name == "t") return NameValue{NameValue::Status::found, t};
      const auto found = values.find(name);
      return found == values.end() ? NameValue{} : NameValue{NameValue::Status::found, found->second};
    };
    const auto result = evaluate(text, {value_of, [] { return std::vector<std::string>{}; }});
    return result.value.value_or(std::numeric_limits<double>::quiet_NaN());
  };
}

std::optional<double> Reading::expression(const Node& node, const std::string& label, const Names& names) {
  const std::string_view text = expression_of(node);
  const auto result = evaluate(text, names);
  if (result.value || result.problem.empty()) return result.value;
  const std::size_t offset = static_cast<std::size_t>(text.data() - node.text.data()) + result.column - 1;
  Place place = node.place;
  std::string where = " in \"" + node.text + "\"";
  if (node.quoted_inline)
    place.column += static_cast<int>(offset) + 1;
  else
    where += " at character " + std::to_string(offset + 1);
  error(place, label + ": " + result.problem + where);
  return std::nullopt;
}

std::optional<double> Reading::number(const Node& node, const std::string& unit, const std::string& label,
                                      bool may_be_infinite) {
  if (!expression_of(node).empty()) return expression(node, label);
  if (node.type == Node::Type::text) {
    const auto read = read_quantity(node.text, unit);
    if (!read.value) error(node.place, label + ": " + read.problem);
    return read.value;
  }
  if (!node.is_number()) {
    const std::string in = unit.empty() || unit == any_unit ? "" : " in " + unit;
    error(node.place, label + ": expected a number" + in + ", found " + type_name(node.type));
    return std::nullopt;
  }
  if (std::isfinite(node.real) || (may_be_infinite && node.real > 0)) return node.real;
  error(node.place, label + " = " +
                        (std::isnan(node.real) ? "nan"
                         : node.real > 0       ? "inf"
                                               : "-inf") +
                        " is not a finite number");
  return std::nullopt;
}

void Reading::check_params() {
  const Node* params = root.find("params");
  if (!params) return;
  if (params->type != Node::Type::table)
    return error(params->place, "[params]: expected a table, found " + std::string(type_name(params->type)));
  for (const auto& member : params->members) look_up(member.key);
}

}  // namespace epafi
