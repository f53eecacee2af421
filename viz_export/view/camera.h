/// @file camera.h  Camera of a run: page and `epafi render` use the same formulas (page/camera.js). Up is against
/// gravity.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "viz_export/view/settings.h"

namespace epafi {

/// An axis-aligned box [m]; empty while min > max.
struct ViewBox {
  Vec3 min = Vec3::Constant(1e300), max = Vec3::Constant(-1e300);
  bool is_empty() const { return !(min.x() <= max.x()); }
  void include(const Vec3& p, double radius = 0.0) {
    min = min.cwiseMin(p - Vec3::Constant(radius));
    max = max.cwiseMax(p + Vec3::Constant(radius));
  }
  void include(const ViewBox& other) {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
  }
  bool holds(const Vec3& p) const { return (p.array() >= min.array()).all() && (p.array() <= max.array()).all(); }
  Vec3 centre() const { return 0.5 * (min + max); }
  double diagonal() const { return (max - min).norm(); }
};

struct Camera {
  Vec3 eye, target;
  Vec3 up = Vec3::UnitZ();
  double angle = 30.0;  ///< of the picture's height, in degrees
};

/// Names and the direction from the target to the eye, as if up were z.
[[nodiscard]] const std::vector<std::pair<std::string, Vec3>>& camera_presets();

/// Up direction of pictures, unit: that of the scene, else against gravity, else z.
[[nodiscard]] Vec3 upwards(const RunAbout& about);

/// Turns z to `up` (unit) by the shortest way, by half a turn about x where they are opposite.
[[nodiscard]] Quat upright(const Vec3& up);

/// The camera that sees the whole box from `direction` (any length, as if up were z) in a picture of this width over
/// height.
[[nodiscard]] Camera fitted_camera(const ViewBox& box, const Vec3& direction, const Vec3& up, double aspect,
                                   double angle = 30.0);

/// name: a preset, "scene", or "" for the scene's choice and else the first preset. Throws FileError for another name.
[[nodiscard]] Camera choose_camera(const std::string& name, const RunAbout& about, const ViewBox& box, double aspect);

}  // namespace epafi
