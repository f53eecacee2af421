/// @file evaluate_patch.h  Evaluates every pair of chosen normal and tangential models on one case.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "laws/wheel_rail/tangential_models.h"
#include "scenes/patch/patch_case.h"

namespace epafi {

struct PatchContact {
  double y_wheel = 0.0, y_rail = 0.0;  ///< lateral position of the centre of pressure [m]
  Vec3 point = Vec3::Zero();           ///< track axes: x forwards, y to the right, z down [m]
  double angle = 0.0;                  ///< [rad]
  Ellipse semi_axes;
  double area = 0.0, max_pressure = 0.0, normal_force = 0.0;
  PatchForce force;                           ///< on the rail, in the patch's own plane
  TractionMap map;                            ///< if asked for
  std::shared_ptr<const BlockStress> stress;  ///< of finite elements, with the map
};

/// Result of one pair of models.
struct PatchResult {
  std::string normal, tangential;  ///< tangential empty: frictionless
  double normal_force = 0.0, approach = 0.0, max_pressure = 0.0, area = 0.0;
  std::vector<PatchContact> contacts;
  PatchForce force;                           ///< on the rail, sum over the contacts
  double stick_share = -1.0;                  ///< < 0: unknown
  double wear_number = 0.0;                   ///< [N]
  std::optional<double> fatigue_index;        ///< mu_used - 2 pi a b k / (3 N) (Ekberg, Kabo, Andersson 2002)
  std::optional<double> pressure_over_yield;  ///< p0 / k: with F/N the point in the shakedown map (Johnson 1989)
  double milliseconds = 0.0;                  ///< processor time of this pair, geometry kept
  double error_estimate = 0.0;                ///< larger of: peak pressure, relative; force over mu N
  bool friction = false;                      ///< a tangential model was asked for
  std::vector<std::string> reasons;           ///< empty: valid
  std::vector<std::string> notes;             ///< deviations of a model from the case
  /// A contact was found; else `reasons` say why there is none.
  bool solved() const { return normal_force > 0.0; }
};

std::vector<PatchResult> evaluate_patch(const PatchCase& patch, bool maps = false);

/// The list as `patch --json` prints it.
std::string patch_json(const std::vector<PatchResult>& results);
/// Writes pressures, tractions, slips and stick or slip of every solved patch to FOLDER/NORMAL_TANGENTIAL.csv, .vti and
/// .svg, stresses and displacements inside the body of finite elements to FOLDER/NORMAL_stress.vtr, and the results
/// to FOLDER/patch.csv. title: of the pictures.
void write_patch_maps(const std::string& folder, const std::vector<PatchResult>& results,
                      const std::string& title = "");
/// Rigid geometry of the case's wheelset at shifts of 0 to 8 mm as CSV: roll, contact places, rolling radius
/// difference, equivalent conicity (EN 15302). Cells are empty where the wheelset does not stand on both rails.
struct PatchGeometry {
  std::string csv;
  int shifts = 0, standing = 0;  ///< rows, and those with contacts on both rails
};
PatchGeometry patch_geometry(const PatchCase& patch);
/// A row per result in SI. units: in the heads of the columns.
std::string patch_csv(const std::vector<PatchResult>& results, bool units = false);
/// One line per result for people.
std::string patch_table(const std::vector<PatchResult>& results);

}  // namespace epafi
