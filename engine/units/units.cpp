#include "engine/units/units.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "engine/units/nearest.h"

namespace epafi {
namespace {

using std::numbers::pi;
constexpr int largest_exponent = 9;

struct Symbol {
  const char* name;
  Dimension dimension;
  double numerator, denominator;
  bool takes_prefix;
};

//                                     m  kg   s  A  K mol rad
constexpr Symbol symbols[] = {
    {"in", {1, 0, 0, 0, 0, 0, 0}, 127, 5000, false},  {"m", {1, 0, 0, 0, 0, 0, 0}, 1, 1, true},
    {"g", {0, 1, 0, 0, 0, 0, 0}, 1, 1000, true},      {"t", {0, 1, 0, 0, 0, 0, 0}, 1000, 1, false},
    {"s", {0, 0, 1, 0, 0, 0, 0}, 1, 1, true},         {"min", {0, 0, 1, 0, 0, 0, 0}, 60, 1, false},
    {"h", {0, 0, 1, 0, 0, 0, 0}, 3600, 1, false},     {"A", {0, 0, 0, 1, 0, 0, 0}, 1, 1, true},
    {"K", {0, 0, 0, 0, 1, 0, 0}, 1, 1, true},         {"mol", {0, 0, 0, 0, 0, 1, 0}, 1, 1, true},
    {"rad", {0, 0, 0, 0, 0, 0, 1}, 1, 1, true},       {"deg", {0, 0, 0, 0, 0, 0, 1}, pi, 180, false},
    {"rev", {0, 0, 0, 0, 0, 0, 1}, 2 * pi, 1, false}, {"rpm", {0, 0, -1, 0, 0, 0, 1}, 2 * pi, 60, false},
    {"Hz", {0, 0, -1, 0, 0, 0, 0}, 1, 1, true},       {"N", {1, 1, -2, 0, 0, 0, 0}, 1, 1, true},
    {"Pa", {-1, 1, -2, 0, 0, 0, 0}, 1, 1, true},      {"bar", {-1, 1, -2, 0, 0, 0, 0}, 100000, 1, true},
    {"J", {2, 1, -2, 0, 0, 0, 0}, 1, 1, true},        {"W", {2, 1, -3, 0, 0, 0, 0}, 1, 1, true},
    {"L", {3, 0, 0, 0, 0, 0, 0}, 1, 1000, true},      {"%", {0, 0, 0, 0, 0, 0, 0}, 1, 100, false}};

struct Prefix {
  const char* name;
  double numerator, denominator;
};
constexpr Prefix prefixes[] = {{"n", 1, 1e9}, {"u", 1, 1e6}, {"\xc2\xb5", 1, 1e6}, {"m", 1, 1e3}, {"c", 1, 1e2},
                               {"d", 1, 10},  {"k", 1e3, 1}, {"M", 1e6, 1},        {"G", 1e9, 1}, {"T", 1e12, 1}};

/// What dimensions are called in messages.
struct Quantity {
  const char* name;
  const char* unit;
};
constexpr Quantity quantities[] = {{"a number without unit", ""},
                                   {"a length", "m"},
                                   {"a mass", "kg"},
                                   {"a time", "s"},
                                   {"an area", "m^2"},
                                   {"a volume", "m^3"},
                                   {"a velocity", "m/s"},
                                   {"an acceleration", "m/s^2"},
                                   {"a force", "N"},
                                   {"a pressure", "Pa"},
                                   {"a density", "kg/m^3"},
                                   {"a frequency", "Hz"},
                                   {"an energy", "J"},
                                   {"a power", "W"},
                                   {"a stiffness", "N/m"},
                                   {"a damping", "N s/m"},
                                   {"an angle", "rad"},
                                   {"an angular velocity", "rad/s"},
                                   {"a mass flow", "kg/s"},
                                   {"an inertia", "kg m^2"}};

std::optional<Unit> find_symbol(std::string_view word) {
  for (const auto& s : symbols)
    if (word == s.name) return Unit{s.dimension, s.numerator, s.denominator};
  for (const auto& p : prefixes) {
    const std::string_view prefix = p.name;
    if (word.substr(0, prefix.size()) != prefix) continue;
    for (const auto& s : symbols)
      if (s.takes_prefix && word.substr(prefix.size()) == s.name)
        return Unit{s.dimension, s.numerator * p.numerator, s.denominator * p.denominator};
  }
  return std::nullopt;
}

std::vector<std::string> all_symbols() {
  std::vector<std::string> names;
  for (const auto& s : symbols) names.emplace_back(s.name);
  for (const auto& s : symbols)
    for (const auto& p : prefixes)
      if (s.takes_prefix) names.push_back(std::string(p.name) + s.name);
  return names;
}

void multiply(Unit& unit, const Unit& factor, int exponent) {
  for (std::size_t k = 0; k < unit.dimension.size(); ++k) unit.dimension[k] += exponent * factor.dimension[k];
  for (int n = 0; n < std::abs(exponent); ++n) {
    unit.numerator *= exponent > 0 ? factor.numerator : factor.denominator;
    unit.denominator *= exponent > 0 ? factor.denominator : factor.numerator;
  }
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Splits "m^3" or "s-2" into symbol and exponent.
std::optional<int> take_exponent(std::string_view& factor) {
  const std::size_t at = factor.find_first_of("^-0123456789");
  if (at == 0 || at == std::string_view::npos) return 1;
  std::string_view digits = factor.substr(factor[at] == '^' ? at + 1 : at);
  factor = factor.substr(0, at);
  int exponent = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  const bool whole = end.ec == std::errc{} && end.ptr == digits.data() + digits.size();
  if (!whole || exponent == 0 || std::abs(exponent) > largest_exponent) return std::nullopt;
  return exponent;
}

/// The name of a dimension that has one, with its SI unit.
const Quantity* find_quantity(const Dimension& dimension) {
  for (const auto& q : quantities)
    if (parse_unit(q.unit).unit->dimension == dimension) return &q;
  return nullptr;
}

}  // namespace

UnitResult parse_unit(std::string_view text) {
  Unit unit;
  text = trimmed(text);
  int sign = 1;
  bool divided = false;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of(" */");
    std::string_view factor = text.substr(0, end);
    if (factor.empty()) return {std::nullopt, "a unit is missing before '" + std::string(text) + "'"};
    if (factor != "1") {
      const std::string whole(factor);
      const auto exponent = take_exponent(factor);
      if (!exponent) return {std::nullopt, "wrong exponent in unit '" + whole + "'"};
      const auto symbol = find_symbol(factor);
      if (!symbol) {
        const auto near = nearest(factor, all_symbols());
        return {std::nullopt,
                "unknown unit '" + std::string(factor) + "'" + (near ? "; did you mean '" + *near + "'?" : "")};
      }
      multiply(unit, *symbol, sign * *exponent);
    }
    if (end == std::string_view::npos) return {unit, {}};
    text = trimmed(text.substr(end));
    divided = !text.empty() && text.front() == '/';
    sign = divided ? -1 : 1;
    if (divided || (!text.empty() && text.front() == '*')) {
      text = trimmed(text.substr(1));
      if (text.empty()) return {std::nullopt, "a unit is missing at the end"};
    }
  }
  return {unit, {}};
}

std::string describe_unit(std::string_view si_unit) {
  if (si_unit == any_unit) return "a number with or without unit";
  const auto unit = parse_unit(si_unit).unit;
  const Quantity* q = unit ? find_quantity(unit->dimension) : nullptr;
  if (!q) return "a value in " + std::string(si_unit);
  return std::string(q->name) + (si_unit.empty() ? "" : " (" + std::string(si_unit) + ")");
}

QuantityResult read_quantity(std::string_view text, std::string_view si_unit) {
  const std::string_view whole = trimmed(text);
  double number = 0.0;
  const char* first = whole.data() + (!whole.empty() && whole.front() == '+' ? 1 : 0);
  const auto end = std::from_chars(first, whole.data() + whole.size(), number);
  const auto expected = [&](const std::string& found) {
    return "expected " + describe_unit(si_unit) + ", found " + found;
  };
  if (end.ec == std::errc::result_out_of_range)
    return {std::nullopt, "'" + std::string(whole) + "' is out of the range of numbers"};
  if (end.ec != std::errc{}) return {std::nullopt, expected("the text '" + std::string(text) + "'")};
  const std::string_view rest = trimmed(whole.substr(static_cast<std::size_t>(end.ptr - whole.data())));
  const auto parsed = parse_unit(rest);
  if (!parsed.unit) return {std::nullopt, parsed.problem};
  const bool checked = si_unit != any_unit;
  if (checked && rest.empty() && !si_unit.empty()) {
    return {std::nullopt,
            expected("'" + std::string(whole) + "' without a unit; write the number without quotes for SI")};
  }
  if (checked && parsed.unit->dimension != parse_unit(si_unit).unit->dimension) {
    const Quantity* q = find_quantity(parsed.unit->dimension);
    return {std::nullopt, expected("'" + std::string(rest) + "'" + (q ? ", " + std::string(q->name) : ""))};
  }
  const double value = number * parsed.unit->numerator / parsed.unit->denominator;
  if (!std::isfinite(value)) return {std::nullopt, "'" + std::string(whole) + "' is not a finite number"};
  return {value, {}};
}

}  // namespace epafi
