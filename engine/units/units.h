/// @file units.h  Values with units, as users write them: "2.5 mm", "70 GPa", "5 kg/m^3", "90 rpm". Inside everything
/// is SI. Angles count as a dimension of their own (rad), so that "30 deg" is refused where a plain number is meant.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace epafi {

/// Exponents of m, kg, s, A, K, mol, rad.
using Dimension = std::array<int, 7>;

/// SI value = number * numerator / denominator: both are exact for metric prefixes, so that "5 mm" is 0.005 to the last
/// bit.
struct Unit {
  Dimension dimension{};
  double numerator = 1.0;
  double denominator = 1.0;
};

/// Either the unit or what is wrong with the text.
struct UnitResult {
  std::optional<Unit> unit;
  std::string problem;
};

/// "N s/m", "kg/m^3", "1/s", "m s^-2": factors by space, * or /; a / divides by the next factor only.
UnitResult parse_unit(std::string_view text);

/// Value of `si_unit` of read_quantity that accepts any unit.
inline constexpr std::string_view any_unit = "*";

/// Either the value in SI or what is wrong with the text.
struct QuantityResult {
  std::optional<double> value;
  std::string problem;
};

/// Reads a number with a unit whose dimension must be that of `si_unit` ("" for none).
QuantityResult read_quantity(std::string_view text, std::string_view si_unit);

/// "a length (m)", "a pressure (Pa)", or "a value in N s/m".
std::string describe_unit(std::string_view si_unit);

}  // namespace epafi
