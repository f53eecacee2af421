#include <numbers>

#include "engine/units/units.h"

#include "engine/units/nearest.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

double value(const char* text, const char* unit) {
  const auto result = read_quantity(text, unit);
  INFO(text << ": " << result.problem);
  REQUIRE(result.value);
  return *result.value;
}

std::string problem(const char* text, const char* unit) {
  const auto result = read_quantity(text, unit);
  CHECK_FALSE(result.value);
  return result.problem;
}

using std::numbers::pi;

}  // namespace

TEST_CASE("metric prefixes give the same bits as the number written in SI", "[engine][units]") {
  CHECK(value("5 mm", "m") == 0.005);
  CHECK(value("0.1 mm", "m") == 0.0001);
  CHECK(value("10mm", "m") == 0.010);
  CHECK(value("70 GPa", "Pa") == 70e9);
  CHECK(value("3 um", "m") == 3e-6);
  CHECK(value("3 \xc2\xb5m", "m") == 3e-6);
  CHECK(value("250 g", "kg") == 0.25);
  CHECK(value("-2e3 kN", "N") == -2e6);
}

TEST_CASE("units multiply and divide", "[engine][units]") {
  CHECK(value("5 kg/m^3", "kg/m^3") == 5.0);
  CHECK(value("5 g/cm^3", "kg/m^3") == Approx(5000.0).epsilon(1e-15));
  CHECK(value("2 kN/mm", "N/m") == 2e6);
  CHECK(value("3 N s/m", "N s/m") == 3.0);
  CHECK(value("3 N*s/m", "kg/s") == 3.0);
  CHECK(value("36 km/h", "m/s") == 10.0);
  CHECK(value("9.81 m s^-2", "m/s^2") == 9.81);
  CHECK(value("9.81 m/s2", "m/s^2") == 9.81);
  CHECK(value("20 1/s", "Hz") == 20.0);
  CHECK(value("1 bar", "N/m^2") == 1e5);
}

TEST_CASE("angles have a dimension of their own", "[engine][units]") {
  CHECK(value("30 deg", "rad") == 30 * pi / 180);
  CHECK(value("90 rpm", "rad/s") == Approx(3 * pi).epsilon(1e-15));
  CHECK(value("90 rev/min", "rad/s") == Approx(3 * pi).epsilon(1e-15));
  CHECK(problem("30 deg", "") == "expected a number without unit, found 'deg', an angle");
  CHECK(problem("2 Hz", "rad/s") == "expected an angular velocity (rad/s), found 'Hz', a frequency");
}

TEST_CASE("a number without unit may be a text where none is expected", "[engine][units]") {
  CHECK(value("0.5", "") == 0.5);
  CHECK(value("50 %", "") == 0.5);
  CHECK(value("7", "*") == 7.0);  // any unit
}

TEST_CASE("wrong quantities are named with what was expected", "[engine][units]") {
  CHECK(problem("3 kg", "m") == "expected a length (m), found 'kg', a mass");
  CHECK(problem("3 m^5", "m") == "expected a length (m), found 'm^5'");
  CHECK(problem("3 m", "kg m^3") == "expected a value in kg m^3, found 'm', a length");
  CHECK(problem("70 Gpa", "Pa") == "unknown unit 'Gpa'; did you mean 'GPa'?");
  CHECK(problem("70 Mpa", "Pa") == "unknown unit 'Mpa'; did you mean 'MPa'?");
  CHECK(problem("1 furlong", "m") == "unknown unit 'furlong'");
  CHECK(problem("big", "m") == "expected a length (m), found the text 'big'");
  CHECK(problem("3", "m") == "expected a length (m), found '3' without a unit; write the number without quotes for SI");
  CHECK(problem("1e999 m", "m") == "'1e999 m' is out of the range of numbers");
  CHECK(problem("inf m", "m") == "'inf m' is not a finite number");
  CHECK(problem("3 m^", "m") == "wrong exponent in unit 'm^'");
  CHECK(problem("3 m//s", "m/s") == "a unit is missing before '/s'");
  CHECK(problem("3 m/", "m") == "a unit is missing at the end");
}

TEST_CASE("the distance of two words counts insertions, deletions, changes and swaps", "[engine][nearest]") {
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("friction", "friction") == 0);
  CHECK(edit_distance("resitution", "restitution") == 1);
  CHECK(edit_distance("firction", "friction") == 1);
  CHECK(edit_distance("kitten", "sitting") == 3);  // Levenshtein's textbook pair
}

TEST_CASE("the nearest word is within a third of its length", "[engine][nearest]") {
  const std::vector<std::string> words{"sphere", "box", "half_space", "Hertz"};
  CHECK(nearest("spere", words) == "sphere");
  CHECK(nearest("BOX", words) == "box");
  CHECK(nearest("half-space", words) == "half_space");
  CHECK_FALSE(nearest("superquadric", words));
  CHECK_FALSE(nearest("bxy", words));  // 2 of 3 letters differ
  CHECK(suggestion("x", words, "available") == "; available: sphere, box, half_space, Hertz");
}
