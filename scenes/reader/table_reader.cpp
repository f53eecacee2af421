#include "scenes/reader/table_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/units/nearest.h"
#include "engine/units/units.h"

namespace epafi {
namespace {

constexpr double unit_quaternion_tolerance = 1e-3;  // digits people type: 0.707 is 2e-4 off

/// The key that is read.
struct Key {
  const Field& field;
  std::string label;  ///< "[contact] friction"
  Reading& reading;
};

std::string about(const Field& field) {
  return "(" + (field.help.empty() ? field.name : field.help) + ", " +
         (field.unit.empty() ? "no unit" : "in " + field.unit) + ")";
}

void wrong_type(const Node& node, const Key& key, const std::string& expected) {
  key.reading.error(node.place, key.label + ": expected " + expected + ", found " + type_name(node.type));
}

std::optional<double> read_number(const Node& node, const Key& key) {
  const auto value = key.reading.number(node, key.field.unit, key.label, key.field.may_be_infinite);
  if (!value) return std::nullopt;
  if (key.field.range.contains(*value)) return value;
  key.reading.error(node.place, fmt::format("{} = {} is outside {} {}", key.label, format_number(*value),
                                            format_range(key.field.range), about(key.field)));
  return std::nullopt;
}

std::optional<double> read_integer(const Node& node, const Key& key) {
  const auto value = read_number(node, key);
  if (!value) return std::nullopt;
  if (std::floor(*value) == *value && std::abs(*value) <= largest_integer) return value;
  key.reading.error(node.place, key.label + " = " + format_number(*value) + " is not a whole number");
  return std::nullopt;
}

/// Reads all elements by `read_one`; empty if one fails.
template <class T, class F>
std::optional<std::vector<T>> read_list(const Node& node, const Key& key, const std::string& expected, F&& read_one) {
  if (node.type != Node::Type::array) {
    wrong_type(node, key, expected);
    return std::nullopt;
  }
  std::vector<T> values;
  values.reserve(node.items.size());
  for (const auto& item : node.items)
    if (auto value = read_one(item, key)) values.push_back(*value);
  if (values.size() != node.items.size()) return std::nullopt;
  return values;
}

std::optional<std::vector<double>> read_tuple(const Node& node, const Key& key, std::size_t size,
                                              const std::string& expected) {
  if (node.type == Node::Type::array && node.items.size() != size) {
    key.reading.error(node.place, fmt::format("{}: expected {}, found {}", key.label, expected, node.items.size()));
    return std::nullopt;
  }
  return read_list<double>(node, key, expected, read_number);
}

std::optional<Vec3> read_vec3(const Node& node, const Key& key) {
  const auto v = read_tuple(node, key, 3, "a list of 3 numbers");
  return v ? std::optional(Vec3((*v)[0], (*v)[1], (*v)[2])) : std::nullopt;
}

std::optional<std::vector<double>> read_quaternion(const Node& node, const Key& key) {
  auto q = read_tuple(node, key, 4, "a quaternion w x y z of 4 numbers");
  if (!q) return std::nullopt;
  double largest = 0.0, squares = 0.0;
  for (const double c : *q) largest = std::max(largest, std::abs(c));
  if (largest == 0.0) {
    key.reading.error(node.place,
                      key.label + ": a quaternion of length 0 is no orientation; [1, 0, 0, 0] turns nothing");
    return std::nullopt;
  }
  for (const double c : *q) squares += (c / largest) * (c / largest);
  const double length = largest * std::sqrt(squares);
  if (std::abs(length - 1.0) > unit_quaternion_tolerance) {
    key.reading.warning(node.place, key.label + ": the quaternion of length " + fmt::format("{:.4g}", length) +
                                        " is scaled to length 1");
  }
  for (double& c : *q) c = c / largest / std::sqrt(squares);
  return q;
}

std::optional<std::vector<double>> read_quadruples(const Node& node, const Key& key) {
  const auto one = [](const Node& n, const Key& k) { return read_tuple(n, k, 4, "a list of 4 numbers"); };
  const auto rows = read_list<std::vector<double>>(node, key, "a list of [x, y, z, radius]", one);
  if (!rows) return std::nullopt;
  std::vector<double> flat;
  for (const auto& row : *rows) flat.insert(flat.end(), row.begin(), row.end());
  return flat;
}

/// A bare word after --set needs no quotes: where text is expected, one that looks like a number (60e1) is text.
bool is_text(const Node& node) {
  if (node.type == Node::Type::text) return true;
  const bool is_list = node.type == Node::Type::array || node.type == Node::Type::table;
  return is_override(node.place) && !is_list && !node.text.empty();
}

std::optional<std::string> read_word(const Node& node, const Key& key) {
  if (!is_text(node)) {
    wrong_type(node, key, "a text");
    return std::nullopt;
  }
  const auto& choices = key.field.choices;
  if (choices.empty() && !node.text.empty()) return node.text;
  if (node.text.empty()) {
    key.reading.error(node.place, key.label + " is empty");
    return std::nullopt;
  }
  if (std::find(choices.begin(), choices.end(), node.text) != choices.end()) return node.text;
  const std::size_t space = key.label.rfind(' ');
  key.reading.error(node.place, fmt::format("unknown {} '{}' in {}{}", key.field.name, node.text,
                                            key.label.substr(0, space), suggestion(node.text, choices, "available")));
  return std::nullopt;
}

std::optional<Value> read_number_or_word(const Node& node, const Key& key) {
  const auto& words = key.field.choices;
  const bool is_word =
      node.type == Node::Type::text && !node.text.empty() && std::isalpha(static_cast<unsigned char>(node.text[0]));
  if (words.empty() || !is_word) return read_number(node, key);
  if (std::find(words.begin(), words.end(), node.text) != words.end()) return node.text;
  std::string known;
  for (const std::string& word : words) known += fmt::format("{} \"{}\"", word != words.back() ? "," : " or", word);
  key.reading.error(node.place, fmt::format("{}: expected a number{}, found '{}'", key.label, known, node.text));
  return std::nullopt;
}

/// A single element stands for a list of one.
const Node as_list(const Node& node) {
  if (node.type == Node::Type::array) return node;
  Node list;
  list.type = Node::Type::array;
  list.place = node.place;
  list.items = {node};
  return list;
}

std::optional<Value> read_texts(const Node& node, const Key& key) {
  auto words = read_list<std::string>(as_list(node), key, "a list of texts", read_word);
  if (!words) return std::nullopt;
  const auto& size = key.field.range;  // of a list of texts the range is that of its length
  if (size.contains(static_cast<double>(words->size()))) return std::move(*words);
  key.reading.error(
      node.place, fmt::format("{}: expected {} {}, found {}", key.label, size.min == size.max ? "exactly" : "at least",
                              format_number(size.min), words->size()));
  return std::nullopt;
}

template <class T>
std::optional<Value> as_value(std::optional<T> value) {
  if (!value) return std::nullopt;
  return Value(std::move(*value));
}

/// The vector, or zero where a component follows time: such values are read elsewhere.
std::optional<Value> read_steady(const Node& node, const Key& key) {
  if (node.type != Node::Type::table &&
      !(node.type == Node::Type::array && node.items.size() == 3 && follows_time(key.reading, node)))
    return as_value(read_vec3(node, key));
  return Value(Vec3(Vec3::Zero()));
}

/// The number itself, or that under `below` in a table.
std::optional<double> read_bound(const Node& node, const Key& key) {
  if (node.type != Node::Type::table) return read_number(node, key);
  const Node* below = node.find("below");
  if (below) return read_number(*below, key);
  key.reading.error(node.place, "missing key 'below' in " + key.label + " " + about(key.field));
  return std::nullopt;
}

std::optional<Value> read_value(const Node& node, const Key& key) {
  switch (key.field.kind) {
    case Kind::number:
      return read_number_or_word(node, key);
    case Kind::integer:
      return as_value(read_integer(node, key));
    case Kind::text:
      return as_value(read_word(node, key));
    case Kind::vec3:
      return as_value(read_vec3(node, key));
    case Kind::quaternion:
      return as_value(read_quaternion(node, key));
    case Kind::numbers:
      return as_value(read_list<double>(node, key, "a list of numbers", read_number));
    case Kind::integers:
      return as_value(read_list<double>(as_list(node), key, "whole numbers", read_integer));
    case Kind::vectors:
      return as_value(read_list<Vec3>(node, key, "a list of points [x, y, z]", read_vec3));
    case Kind::quadruples:
      return as_value(read_quadruples(node, key));
    case Kind::texts:
      return read_texts(node, key);
    case Kind::boolean:
      if (node.type == Node::Type::boolean) return Value(node.boolean);
      wrong_type(node, key, "true or false");
      return std::nullopt;
    case Kind::load:
      return read_steady(node, key);
    case Kind::bound:
      return as_value(read_bound(node, key));
    case Kind::table:
    case Kind::shape:
    case Kind::rows:
    case Kind::motions:
    case Kind::tables:
      break;
  }
  return std::nullopt;
}

/// Reads nested values; with `choices`, also one of these words.
void read_nested(const Node& node, const Key& key, TableValues& out) {
  if (node.type == Node::Type::text && !key.field.choices.empty()) {
    if (auto word = read_word(node, key)) out.set(key.field.name, std::move(*word));
    return;
  }
  if (node.type != Node::Type::table) return wrong_type(node, key, "a table");
  const TableValues inner = read_table(node, key.label, key.field.fields, key.reading);
  for (const auto& [name, value] : inner.all()) out.set(key.field.name + "." + name, value);
  for (const auto& [name, place] : inner.places) out.places[key.field.name + "." + name] = place;
  for (const auto& name : inner.misspelt) out.misspelt.insert(key.field.name + "." + name);
}

}  // namespace

TableValues read_table(const Node& table, const std::string& label, const std::vector<Field>& fields,
                       Reading& reading) {
  return read_table(table, label, fields, reading, fields);
}

TableValues read_table(const Node& table, const std::string& label, const std::vector<Field>& fields, Reading& reading,
                       const std::vector<Field>& offered) {
  TableValues out;
  out.place = table.place;
  std::vector<std::string> known;
  for (const auto& field : offered) known.push_back(field.name);
  for (const auto& [name, place, value] : table.members) {
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&, &key = name](const Field& f) { return f.name == key; });
    if (field == fields.end()) {
      reading.error(place, "unknown key '" + name + "' in " + label + suggestion(name, known, "known keys"));
      if (const auto meant = nearest(name, known)) out.misspelt.insert(*meant);
      continue;
    }
    out.places[name] = value.place;
    const Key key{*field, label + " " + name, reading};
    if (field->kind == Kind::table)
      read_nested(value, key, out);
    else if (auto read = read_value(value, key))
      out.set(name, std::move(*read));
    else if (field->default_value)  // the error is reported; who reads on finds what would have stood there
      out.set(name, *field->default_value);
  }
  for (const auto& field : fields) {
    if (out.written(field.name)) continue;
    if (field.default_value)
      out.set(field.name, *field.default_value);
    else if (!field.optional && !out.meant(field.name))
      reading.error(table.place, "missing key '" + field.name + "' in " + label + " " + about(field));
  }
  return out;
}

std::string format_number(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const double size = std::abs(value);
  if (size == 0.0 || (size >= 1e-3 && size < 1e5))
    return fmt::format("{}", value == std::floor(value) ? value + 0.0 : value);
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific);
  std::string text(buffer, end.ptr);
  std::size_t at = text.find('e') + 1;
  if (text[at] == '+')
    text.erase(at, 1);
  else if (text[at] == '-')
    ++at;
  while (text[at] == '0' && at + 1 < text.size()) text.erase(at, 1);
  return text;
}

std::string format_range(const Range& range) {
  const bool open_low = range.open_min || std::isinf(range.min), open_high = range.open_max || std::isinf(range.max);
  return (open_low ? "(" : "[") + format_number(range.min) + ", " + format_number(range.max) + (open_high ? ")" : "]");
}

}  // namespace epafi
