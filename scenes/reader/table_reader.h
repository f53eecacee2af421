/// @file table_reader.h  Reads one table by its fields: types, units, expressions, ranges, unknown and missing keys.
/// Throws nothing: every problem is collected with its place, and reading continues.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/units/error.h"
#include "engine/units/registry.h"
#include "scenes/reader/document.h"
#include "scenes/reader/expression.h"
#include "scenes/reader/schema.h"
#include "scenes/scene.h"

namespace epafi {

/// Context of reading a scene.
class Reading {
 public:
  Reading(const Registry& r, const Node& document_root, std::string file)
      : registry(r), schema(make_schema(r)), root(document_root), main_file(std::move(file)) {}

  const Registry& registry;
  const SceneSchema schema;
  const Node& root;
  const std::string main_file;
  std::vector<Problem> problems;
  std::vector<std::pair<std::string, double>> indices;  ///< i, j, k of the `repeat` being unrolled
  std::vector<std::string> files;                       ///< that tables, bodies and shapes were read from

  void error(const Place& place, std::string text) { report(Problem::Level::error, place, std::move(text)); }
  void warning(const Place& place, std::string text) { report(Problem::Level::warning, place, std::move(text)); }
  std::size_t errors() const { return errors_; }  ///< number so far, including values that depend on a wrong parameter

  /// A number in SI: written plain, with a unit or as "= expression". Reports what is wrong under `label`.
  std::optional<double> number(const Node& node, const std::string& unit, const std::string& label,
                               bool may_be_infinite = false);
  /// "= expression" of t and of names whose values are those of this moment. Reports what is wrong at t = 0.
  std::function<double(double)> time_expression(const Node& node, const std::string& label);
  /// Evaluates every parameter once, so that a wrong one is reported even if nothing uses it.
  void check_params();

 private:
  struct Param {
    enum class State { waiting, busy, done, failed } state = State::waiting;
    double value = 0.0;
  };
  void report(Problem::Level level, const Place& place, std::string text);
  NameValue look_up(std::string_view name);
  std::vector<std::string> known_names() const;
  std::optional<double> expression(const Node& node, const std::string& label);
  std::optional<double> expression(const Node& node, const std::string& label, const Names& names);

  std::map<std::string, Param> params_;
  std::size_t errors_ = 0;
  int param_depth_ = 0;
};

/// The values of a table and where they stand.
struct TableValues : Parameters {
  std::map<std::string, Place> places;  ///< of written keys only
  std::set<std::string> misspelt;       ///< keys that an unknown one was most likely meant for
  Place place;                          ///< of the table

  bool written(const std::string& name) const { return places.count(name) != 0; }
  /// True for written or misspelt keys, whose problem is already reported: they are not missing.
  bool meant(const std::string& name) const { return written(name) || misspelt.count(name) != 0; }
  Place place_of(const std::string& name) const { return written(name) ? places.at(name) : Place{}; }
  Placed<double> placed_number(const std::string& name, double otherwise = 0.0) const {
    return {number_or(name, otherwise), place_of(name)};
  }
  std::optional<double> optional_number(const std::string& name) const {
    return has(name) ? std::optional(number(name)) : std::nullopt;
  }
  Placed<std::string> placed_text(const std::string& name) const {
    return {has(name) ? text(name) : std::string{}, place_of(name)};
  }
};

/// It is a table, or an expression in it has t and no parameter has that name.
bool follows_time(const Reading& reading, const Node& node);

/// `label` names the table in messages: "[contact]", "[[body]] 'floor'".
TableValues read_table(const Node& table, const std::string& label, const std::vector<Field>& fields, Reading& reading);
/// The same where `fields` are those of all variants: an unknown key gets the keys of `offered`, which the chosen
/// one takes.
TableValues read_table(const Node& table, const std::string& label, const std::vector<Field>& fields, Reading& reading,
                       const std::vector<Field>& offered);

/// 1.7e6, 0.25, -3: shortest text that gives the same number.
std::string format_number(double value);

/// "(0, 10]"
std::string format_range(const Range& range);

}  // namespace epafi
