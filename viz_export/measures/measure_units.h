/// @file measure_units.h  Quantity and SI unit of each component of each kind of measure, for axes and tables.
#pragma once
#include <string>

namespace epafi {

struct MeasureUnit {
  std::string quantity;  ///< components of one quantity share an axis: "energy", "length"
  std::string unit;      ///< "" for none
};

/// kind: as in the scene, "" where an older run does not tell: then as far as the component's name alone says it.
[[nodiscard]] MeasureUnit measure_unit(const std::string& kind, const std::string& component);

/// "energy [J]", or "share" where there is no unit.
[[nodiscard]] std::string axis_label(const MeasureUnit& unit);

}  // namespace epafi
