#include "scenes/reader/expression.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace epafi;

namespace {

const Names names{[](std::string_view name) -> NameValue {
                    if (name == "d") return {NameValue::Status::found, 0.25};
                    if (name == "broken") return {NameValue::Status::failed, 0.0};
                    return {};
                  },
                  [] {
                    return std::vector<std::string>{"d", "broken"};
                  }};

double value(const char* text) {
  const auto result = evaluate(text, names);
  INFO(text << ": " << result.problem);
  REQUIRE(result.value);
  return *result.value;
}

std::string problem(const std::string& text) {
  const auto result = evaluate(text, names);
  CHECK_FALSE(result.value);
  return std::to_string(result.column) + ": " + result.problem;
}

}  // namespace

TEST_CASE("operators bind as in mathematics", "[scenes][expression]") {
  CHECK(value("1 + 2*3") == 7);
  CHECK(value("(1 + 2)*3") == 9);
  CHECK(value("7 - 2 - 1") == 4);
  CHECK(value("8/4/2") == 1);
  CHECK(value("-2^2") == -4);
  CHECK(value("2^3^2") == 512);
  CHECK(value("2^-1") == 0.5);
  CHECK(value("--3") == 3);
  CHECK(value("(3 + 0.5)*d") == 0.875);
  CHECK(value(" 1e-3 ") == 1e-3);
}

TEST_CASE("functions are those of the standard library", "[scenes][expression]") {
  CHECK(value("min(3, 1, 2)") == 1);
  CHECK(value("max(3, 1, 2)") == 3);
  CHECK(value("sqrt(2)") == std::sqrt(2.0));
  CHECK(value("abs(-2)") == 2);
  CHECK(value("sin(pi/2)") == 1);
  CHECK(value("cos(0) + tan(0)") == 1);
  CHECK(value("exp(log(5))") == Approx(5).epsilon(1e-15));
  CHECK(value("floor(2.7) + ceil(2.2)") == 5);
  CHECK(value("4*atan(1)") == Approx(value("pi")).epsilon(1e-15));
  CHECK(value("atan2(-1, -1)") == Approx(-0.75 * value("pi")).epsilon(1e-15));
  CHECK(value("asin(0.5) + acos(0.5)") == Approx(0.5 * value("pi")).epsilon(1e-15));
  CHECK(value("hypot(3, 4)") == 5);
  CHECK(value("cosh(2)^2 - sinh(2)^2") == Approx(1).epsilon(1e-13));
  CHECK(value("cbrt(-8) + round(2.6)") == 1);
}

TEST_CASE("what is wrong is named with its column", "[scenes][expression]") {
  CHECK(problem("1 + ") == "5: a value is missing at the end");
  CHECK(problem("2d") == "2: unexpected 'd'");
  CHECK(problem("1 + * 2") == "5: expected a value, found '*'");
  CHECK(problem("(1") == "3: expected ')'");
  CHECK(problem("1)") == "2: unexpected ')'");
  CHECK(problem("2*sqr(3)") == "3: unknown function 'sqr'; did you mean 'sqrt'?");
  CHECK(problem("sqrt(1, 2)") == "1: sqrt takes one argument");
  CHECK(problem("1/0") == "1: the result is not a finite number");
  CHECK(problem("sqrt(-1)") == "1: the result is not a finite number");
  CHECK(problem("system(1)") ==
        "1: unknown function 'system'; known functions: min, max, atan2, hypot, sqrt, abs, sin, cos, tan, "
        "exp, log, floor, ceil, asin, acos, atan, sinh, cosh, tanh, cbrt, round");
  CHECK(problem("x") == "1: unknown name 'x'; known names: d, broken, pi");
  CHECK(problem("2*broken") == "0: ");  // its own error has been reported where it stands
}

TEST_CASE("length and depth are bounded", "[scenes][expression]") {
  CHECK(value((std::string(40, '(') + "1" + std::string(40, ')')).c_str()) == 1);
  CHECK(problem(std::string(100, '-') + "1") == "51: the expression is nested too deeply");
  CHECK(problem(std::string(1001, '1')) == "1: the expression is longer than 1000 characters");
}

TEST_CASE("a name is mentioned only as a whole word", "[scenes][expression]") {
  CHECK(mentions("= 2*i", "i"));
  CHECK(mentions("=i+1", "i"));
  CHECK_FALSE(mentions("= pi*width", "i"));
  CHECK_FALSE(mentions("= i2 + _i", "i"));
}
