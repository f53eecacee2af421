#include "viz_export/view/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/units/error.h"

namespace epafi {

const std::vector<std::pair<std::string, Vec3>>& camera_presets() {
  static const std::vector<std::pair<std::string, Vec3>> all{
      {"iso", {0.45, -1.0, 0.5}}, {"front", {0, -1, 0}}, {"back", {0, 1, 0}},   {"left", {-1, 0, 0}},
      {"right", {1, 0, 0}},       {"top", {0, 0, 1}},    {"bottom", {0, 0, -1}}};
  return all;
}

Vec3 upwards(const RunAbout& about) {
  if (!about.view.up.isZero(0.0)) return about.view.up;
  const double g = about.gravity.norm();
  return g > 0 && std::isfinite(g) ? Vec3(-about.gravity / g) : Vec3(Vec3::UnitZ());
}

Quat upright(const Vec3& up) {
  if (up.z() < -1 + 1e-12) return {0, 1, 0, 0};
  return Quat::FromTwoVectors(Vec3::UnitZ(), up);
}

Camera fitted_camera(const ViewBox& box, const Vec3& direction, const Vec3& upward, double aspect, double angle) {
  const Quat turn = upright(upward);
  const Vec3 towards = turn * direction.normalized();
  const bool level = std::abs(towards.dot(upward)) < 0.999;
  Camera camera{box.centre(), box.centre(), turn * (level ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitY())), angle};
  const Vec3 right = camera.up.cross(towards).normalized();
  const Vec3 up = towards.cross(right);
  constexpr double filled = 0.86;  // of the picture: the rest is margin
  const double high = filled * std::tan(0.5 * angle * std::numbers::pi / 180.0);
  const double wide = high * aspect;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? box.max.x() : box.min.x(), corner & 2 ? box.max.y() : box.min.y(),
                 corner & 4 ? box.max.z() : box.min.z());
    const Vec3 r = p - camera.target;
    const double sideways = std::max(std::abs(right.dot(r)) / wide, std::abs(up.dot(r)) / high);
    distance = std::max(distance, sideways + towards.dot(r));
  }
  if (!(distance > 0)) distance = 1;  // a point: nothing says how near
  camera.eye = camera.target + distance * towards;
  return camera;
}

Camera choose_camera(const std::string& name, const RunAbout& about, const ViewBox& box, double aspect) {
  const ViewSettings& settings = about.view;
  const bool by_scene = name.empty() || name == "scene";
  const std::string preset = !by_scene                 ? name
                             : settings.preset.empty() ? camera_presets().front().first
                                                       : settings.preset;
  const Vec3 up = upwards(about);
  if (by_scene && settings.from) {
    const Vec3 target = settings.to ? *settings.to : box.centre();
    const Vec3 towards = (*settings.from - target).normalized();
    const bool level = towards.cross(up).norm() > 1e-3;  // looking straight down leaves up undecided
    return {*settings.from, target, level ? up : Vec3(upright(up) * Vec3::UnitY()), settings.angle};
  }
  std::string known;
  for (const auto& [other, direction] : camera_presets()) {
    if (other == preset) return fitted_camera(box, direction, up, aspect, settings.angle);
    known += (known.empty() ? "" : ", ") + other;
  }
  throw SceneError("there is no camera '" + preset + "'; there are scene, " + known);
}

}  // namespace epafi
