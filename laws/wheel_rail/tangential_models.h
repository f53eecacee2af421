/// @file tangential_models.h  The list of tangential models: name, what it is, and the function that solves one patch
/// with it.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/units/registry.h"
#include "laws/wheel_rail/half_space/tangential.h"
#include "laws/wheel_rail/normal_patch.h"

namespace epafi {

/// Kalker's K of unlike bodies above which the neglected coupling of pressure and traction matters.
inline constexpr double most_coupling = 0.05;

struct TangentialInput {
  const NormalPatch& patch;
  ElasticPair elastic;
  double friction = 0.0;
  Creepage creepage;      ///< at the origin of the tangent plane
  PatchGrid cells;        ///< cells over an elliptic patch; those of the patch's own grid otherwise
  bool store = false;     ///< keep tractions and slips by cell
  double distance = 0.0;  ///< rolled since rest, for what is not steady [m]; 0: the length of the patch
};

/// Creepage at (x, y) of the tangent plane: spin turns it over the patch.
inline Creepage creepage_at(const Creepage& c, double x, double y) {
  return {c.longitudinal - c.spin * y, c.lateral + c.spin * x, c.spin};
}
/// For cells whose coordinates count from the middle of the patch's grid.
inline Creepage creepage_of_cells(const TangentialInput& in) {
  return creepage_at(in.creepage, in.patch.grid_x, in.patch.grid_y);
}

/// Tractions, slips and stick of one patch on points (x, y) for files and pictures.
struct TractionMap {
  std::vector<double> x, y, pressure, traction_x, traction_y;
  std::vector<double> slip_x, slip_y;  ///< empty: the law finds tractions and stick without a slip
  std::vector<std::uint8_t> sticks;    ///< 1 in stick, 0 in slip
  bool knows_slip() const { return !slip_x.empty(); }
};

struct TangentialOutcome {
  PatchForce force;
  double stick_share = -1.0;    ///< < 0: the model does not know
  double wear_number = 0.0;     ///< T gamma = |F_x xi| + |F_y eta| + |M_z phi| [N]
  double error_estimate = 0.0;  ///< of the force, over mu N [-]
  std::vector<std::string> reasons;
  TractionMap map;
};

struct TangentialModel {
  Entry entry;
  TangentialOutcome (*solve)(const TangentialInput&);
  bool steady = true;  ///< of steady rolling: what a wheelset in motion may use
};

const std::vector<TangentialModel>& all_tangential_models();

}  // namespace epafi
