/// @file registry.h  Entries of all lists of variants: name, summary, parameters and needs. The same entry feeds the
/// scene parser, `epafi list`, `epafi explain`, the JSON Schema and the reference pages.
#pragma once
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// Admissible values of a number.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;  ///< min itself is not allowed
  bool open_max = false;

  bool contains(double v) const { return (open_min ? v > min : v >= min) && (open_max ? v < max : v <= max); }
};
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr Range any_number{};
inline constexpr Range positive{0, infinity, true, false};
inline constexpr Range not_negative{0, infinity, false, false};
inline constexpr Range unit_interval{0, 1, false, false};

/// Type of the value of a field.
enum class Kind {
  number,  ///< with `choices`: or one of these words ("auto")
  integer,
  boolean,
  text,
  vec3,
  quaternion,  ///< w x y z, stored as four numbers of unit length
  numbers,
  integers,  ///< one integer or a list of them
  vectors,
  quadruples,  ///< a list of four numbers each, stored one behind the other
  texts,       ///< one word or a list of them
  table,       ///< a nested table; its values are stored flat as `name.key`
  shape,       ///< a name under [shape.*] or a shape written in place; has its own parser
  rows,        ///< a list of rows of numbers; has its own parser, like the next ones
  load,        ///< a vector with components that may depend on time, or a table of it; the constant part is stored
  motions,     ///< a table by `fields`, or a list of them
  bound,       ///< a number, or a table with that number in `below`
  tables,      ///< a table or list of tables with its own declaration
};

/// A resolved value of a field (numbers in SI).
using Value =
    std::variant<double, bool, std::string, Vec3, std::vector<double>, std::vector<Vec3>, std::vector<std::string>>;

/// One parameter of an entry or one key of a scene table.
struct Field {
  std::string name;    ///< scene key
  std::string symbol;  ///< as in the cited formula, may be empty
  std::string unit;    ///< SI unit ("m", "Pa", "N s/m"), "" for none
  Kind kind = Kind::number;
  std::optional<Value> default_value{};  ///< absent: the key must be written, unless `optional`
  Range range{};
  std::string help;
  bool optional = false;               ///< may be absent and has no default: absence is meaningful
  std::vector<std::string> choices{};  ///< for text: the admissible words, empty = any
  std::vector<Field> fields{};         ///< for a table: its keys
  bool may_be_infinite = false;        ///< inf means something ("rigid")
};

/// Parameters of one entry after validation, by field name.
class Parameters {
 public:
  bool has(const std::string& name) const { return values_.count(name) != 0; }
  double number(const std::string& name) const { return std::get<double>(values_.at(name)); }
  double number_or(const std::string& name, double otherwise) const { return has(name) ? number(name) : otherwise; }
  long long integer(const std::string& name) const { return static_cast<long long>(number(name)); }
  bool boolean(const std::string& name) const { return std::get<bool>(values_.at(name)); }
  const std::string& text(const std::string& name) const { return std::get<std::string>(values_.at(name)); }
  const Vec3& vec3(const std::string& name) const { return std::get<Vec3>(values_.at(name)); }
  const std::vector<double>& numbers(const std::string& name) const {
    return std::get<std::vector<double>>(values_.at(name));
  }
  const std::vector<Vec3>& vectors(const std::string& name) const {
    return std::get<std::vector<Vec3>>(values_.at(name));
  }
  const std::vector<std::string>& texts(const std::string& name) const {
    return std::get<std::vector<std::string>>(values_.at(name));
  }
  void set(const std::string& name, Value value) { values_[name] = std::move(value); }
  const std::map<std::string, Value>& all() const { return values_; }

 private:
  std::map<std::string, Value> values_;
};

/// Columns and features that a part needs from the engine; a scene's StepPlan is the union over its parts, all else is
/// absent.
struct Needs {
  bool rotation = false;        ///< orientation, angular velocity, torque of free bodies
  bool slip_velocity = false;   ///< tangential velocity at the contact
  bool memory = false;          ///< a state carried by contact key from step to step
  bool curvature = false;       ///< effective radius of the contact
  bool manifold = false;        ///< several points per pair
  bool contact_moment = false;  ///< a moment beside the force (rolling friction)
  bool area = false;            ///< contacts are cells of the overlap volume, each with its mean area

  constexpr Needs operator|(const Needs& o) const {
    return {rotation || o.rotation, slip_velocity || o.slip_velocity,   memory || o.memory, curvature || o.curvature,
            manifold || o.manifold, contact_moment || o.contact_moment, area || o.area};
  }
};

/// One line of a list: a shape, a law part, a solver, a broad phase, a scheme, a measure, an observer.
struct Entry {
  std::string name;
  std::string summary;  ///< one line
  std::vector<Field> fields{};
  Needs needs{};
  std::string source{};  ///< author, year
};

}  // namespace epafi
