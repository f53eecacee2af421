#include "scenes/reader/expression.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "engine/units/nearest.h"

namespace epafi {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_word(char c) { return is_letter(c) || is_digit(c); }

struct Function {
  const char* name;
  double (*apply)(double);
};
constexpr Function functions[] = {
    {"sqrt", [](double x) { return std::sqrt(x); }},   {"abs", [](double x) { return std::abs(x); }},
    {"sin", [](double x) { return std::sin(x); }},     {"cos", [](double x) { return std::cos(x); }},
    {"tan", [](double x) { return std::tan(x); }},     {"exp", [](double x) { return std::exp(x); }},
    {"log", [](double x) { return std::log(x); }},     {"floor", [](double x) { return std::floor(x); }},
    {"ceil", [](double x) { return std::ceil(x); }},   {"asin", [](double x) { return std::asin(x); }},
    {"acos", [](double x) { return std::acos(x); }},   {"atan", [](double x) { return std::atan(x); }},
    {"sinh", [](double x) { return std::sinh(x); }},   {"cosh", [](double x) { return std::cosh(x); }},
    {"tanh", [](double x) { return std::tanh(x); }},   {"cbrt", [](double x) { return std::cbrt(x); }},
    {"round", [](double x) { return std::round(x); }},
};

struct Failed {};  // unwinds the recursion to `evaluate`; never leaves this file

/// Recursive descent that evaluates as it reads.
class Evaluator {
 public:
  Evaluator(std::string_view text, const Names& names) : text_(text), names_(names) {}

  ExpressionResult run() {
    ExpressionResult result;
    try {
      const double value = sum();
      skip_spaces();
      if (at_ < text_.size()) fail("unexpected '" + std::string(1, text_[at_]) + "'");
      if (std::isfinite(value))
        result.value = value;
      else
        fail_at(0, "the result is not a finite number");
    } catch (const Failed&) {
      result.problem = problem_;
      result.column = column_;
    }
    return result;
  }

 private:
  [[noreturn]] void fail_at(std::size_t at, std::string text) {
    problem_ = std::move(text);
    column_ = at + 1;
    throw Failed{};
  }
  [[noreturn]] void fail(std::string text) { fail_at(at_, std::move(text)); }
  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool take(char c) {
    skip_spaces();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  double sum() {
    double value = product();
    for (;;) {
      if (take('+'))
        value += product();
      else if (take('-'))
        value -= product();
      else
        return value;
    }
  }
  double product() {
    double value = signed_power();
    for (;;) {
      if (take('*'))
        value *= signed_power();
      else if (take('/'))
        value /= signed_power();
      else
        return value;
    }
  }
  double signed_power() {
    if (++depth_ > deepest_expression) fail("the expression is nested too deeply");
    double value = 0.0;
    if (take('-'))
      value = -signed_power();
    else if (take('+'))
      value = signed_power();
    else {
      value = primary();
      if (take('^')) value = std::pow(value, signed_power());
    }
    --depth_;
    return value;
  }
  double primary() {
    skip_spaces();
    if (at_ >= text_.size()) fail("a value is missing at the end");
    const char c = text_[at_];
    if (is_digit(c) || c == '.') return number();
    if (is_letter(c)) return name();
    if (!take('(')) fail("expected a value, found '" + std::string(1, c) + "'");
    const double value = sum();
    if (!take(')')) fail("expected ')'");
    return value;
  }
  double number() {
    double value = 0.0;
    const auto end = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (end.ec != std::errc{}) fail("this is not a number");
    at_ = static_cast<std::size_t>(end.ptr - text_.data());
    return value;
  }
  double name() {
    const std::size_t start = at_;
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    const std::string_view word = text_.substr(start, at_ - start);
    if (take('(')) return call(word, start);
    if (word == "pi") return std::numbers::pi;
    const NameValue found = names_.look_up(word);
    if (found.status == NameValue::Status::failed) throw Failed{};
    if (found.status == NameValue::Status::found) return found.value;
    auto known = names_.list();
    known.emplace_back("pi");
    fail_at(start, "unknown name '" + std::string(word) + "'" + suggestion(word, known, "known names"));
  }
  double call(std::string_view word, std::size_t start) {
    std::vector<double> arguments;
    do arguments.push_back(sum());
    while (take(','));
    if (!take(')')) fail("expected ')'");
    if (word == "min") return *std::min_element(arguments.begin(), arguments.end());
    if (word == "max") return *std::max_element(arguments.begin(), arguments.end());
    if (word == "atan2" || word == "hypot") {
      if (arguments.size() != 2) fail_at(start, std::string(word) + " takes two arguments");
      return word == "atan2" ? std::atan2(arguments[0], arguments[1]) : std::hypot(arguments[0], arguments[1]);
    }
    std::vector<std::string> known{"min", "max", "atan2", "hypot"};
    for (const auto& f : functions) {
      known.emplace_back(f.name);
      if (word != f.name) continue;
      if (arguments.size() != 1) fail_at(start, std::string(word) + " takes one argument");
      return f.apply(arguments[0]);
    }
    fail_at(start, "unknown function '" + std::string(word) + "'" + suggestion(word, known, "known functions"));
  }

  std::string_view text_;
  const Names& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::string problem_;
  std::size_t column_ = 0;
};

}  // namespace

ExpressionResult evaluate(std::string_view text, const Names& names) {
  if (text.size() > longest_expression) return {std::nullopt, "the expression is longer than 1000 characters", 1};
  return Evaluator(text, names).run();
}

bool mentions(std::string_view text, std::string_view name) {
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || !is_word(text[at - 1])) && (end == text.size() || !is_word(text[end]))) return true;
  }
  return false;
}

}  // namespace epafi
