#include "viz_export/measures/measure_units.h"

#include <string_view>

namespace epafi {
namespace {

struct Row {
  std::string_view kind;   ///< "" for all
  std::string_view start;  ///< of the component's name
  const char *quantity, *unit;
};

/// The first matching row counts.
constexpr Row rows[] = {
    {"run", "number", "contacts", ""},
    {"run", "overlap_relative", "overlap over radius", ""},
    {"run", "residual", "residual", ""},
    {"run", "iterations", "iterations", ""},
    {"energy", "relative_error", "relative error", ""},
    {"energy", "", "energy", "J"},
    {"position", "", "position", "m"},
    {"velocity", "", "velocity", "m/s"},
    {"angular_velocity", "", "angular velocity", "rad/s"},
    {"force", "", "force", "N"},
    {"drift", "", "displacement", "m"},
    {"stress", "", "stress", "Pa"},
    {"torque", "", "torque", "N m"},
    {"power", "", "power", "W"},
    {"profile", "velocity", "velocity", "m/s"},
    {"profile", "density", "density", "kg/m^3"},
    {"contact", "point", "position", "m"},
    {"contact", "slip", "slip velocity", "m/s"},
    {"mass_flow", "rate", "mass flow", "kg/s"},
    {"angle_of_repose", "angle", "angle", "degrees"},
    {"wheelset", "distance", "distance", "m"},
    {"wheelset", "lateral", "displacement", "m"},
    {"wheelset", "vertical", "displacement", "m"},
    {"wheelset", "yaw", "angle", "rad"},
    {"wheelset", "roll", "angle", "rad"},
    {"wheelset", "left", "force", "N"},
    {"wheelset", "right", "force", "N"},
    {"swing", "amplitude", "displacement", "m"},
    {"force_chains", "longest", "number", ""},
    {"", "overlap", "overlap", "m"},
    {"", "normal_force", "force", "N"},
    {"", "tangential_force", "force", "N"},
    {"", "loop_area", "energy", "J"},
    {"", "kinetic", "energy", "J"},
    {"", "potential", "energy", "J"},
    {"", "elastic", "energy", "J"},
    {"", "dissipated", "energy", "J"},
    {"", "work", "energy", "J"},
    {"", "pressure", "stress", "Pa"},
    {"", "mass", "mass", "kg"},
    {"", "rate", "mass flow", "kg/s"},
    {"", "height", "length", "m"},
    {"", "reach", "length", "m"},
    {"", "sag", "displacement", "m"},
    {"", "count", "number", ""},
    {"", "bodies", "number", ""},
    {"", "number", "number", ""},
    {"", "without_rattlers", "number", ""},
    {"", "rattlers", "number", ""},
    {"", "chains", "number", ""},
    {"", "fraction", "share", ""},
    {"", "share", "share", ""},
    {"", "strong", "share", ""},
    {"", "lacey", "mixing index", ""},
};

bool is_of(std::string_view row, std::string_view kind) { return row.empty() || row == kind; }

}  // namespace

MeasureUnit measure_unit(const std::string& kind, const std::string& component) {
  for (const Row& row : rows)
    if (is_of(row.kind, kind) && component.starts_with(row.start)) return {row.quantity, row.unit};
  return {component, ""};
}

std::string axis_label(const MeasureUnit& unit) {
  return unit.unit.empty() ? unit.quantity : unit.quantity + " [" + unit.unit + "]";
}

}  // namespace epafi
