/// @file expression.h  Arithmetic over names: "(i + 0.5)*d". Numbers only; no assignment, no loops, bounded length and
/// depth, so that reading a scene ends in a time proportional to its size. Operators + - * / ^ (right to left, binds
/// tighter than a leading minus), parentheses; min max (any number of arguments), sqrt abs sin cos tan exp log floor
/// ceil; pi.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace epafi {

/// Value of a name. `failed`: it exists, but has an error that was reported.
struct NameValue {
  enum class Status { found, unknown, failed };
  Status status = Status::unknown;
  double value = 0.0;
};

struct Names {
  std::function<NameValue(std::string_view)> look_up;
  std::function<std::vector<std::string>()> list;  ///< for suggestions
};

struct ExpressionResult {
  std::optional<double> value;  ///< finite
  std::string problem;          ///< empty with an empty value: a name failed, which has been reported
  std::size_t column = 0;       ///< of the problem, from 1
};

inline constexpr std::size_t longest_expression = 1000;  ///< characters
inline constexpr int deepest_expression = 50;            ///< parentheses, signs and powers inside each other

ExpressionResult evaluate(std::string_view text, const Names& names);

/// True if the name stands in the text as a word.
bool mentions(std::string_view text, std::string_view name);

}  // namespace epafi
