/// @file patch_case.h  A case of `epafi patch`: one static contact, its load, and the models to compare.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "detection/profiles/wheel_rail.h"
#include "engine/units/error.h"
#include "laws/wheel_rail/half_space/normal.h"
#include "laws/wheel_rail/rolling.h"
#include "scenes/reader/document.h"

namespace epafi {

/// A wheel on a rail by their profiles.
struct ProfileCase {
  Profile wheel, rail;
  TrackGeometry track;
  WheelsetPosition position;  ///< height is found
  bool right = true;
  bool roll_given = false;               ///< else from the rigid geometry of both wheels
  std::optional<double> rolling_radius;  ///< speed over angular velocity [m]; else the mean of both wheels
  bool creepage_given = false;           ///< else from the kinematics of the rolling wheelset
  std::vector<std::string> doubts{};     ///< about the profiles: nothing computed from them need be right
};

struct PatchCase {
  std::string title, file;
  ElasticPair elastic;
  double friction = 0.0;  ///< mu [-], at rest
  struct Falling {
    double limit = 1.0, decay = 0.0;  ///< A, B [s/m]
    double speed = 0.0;               ///< V [m/s]
  } falling;                          ///< decrease of friction with the slip velocity (Polach 2005)
  std::optional<double> yield;        ///< shear yield stress k [Pa]
  NormalTarget target;                ///< load [N] or approach [m]
  Creepage creepage;
  double distance = 0.0;           ///< rolled since rest [m]; 0: the length of the patch
  std::optional<Ellipse> ellipse;  ///< semi_axes
  struct Radii {
    double x1, x2, y1, y2;
  };
  std::optional<Radii> radii;  ///< [m]; infinite: flat, negative: concave
  std::optional<ProfileCase> profiles;
  std::optional<double> length;  ///< of a line contact [m]
  std::vector<std::string> normal, tangential;
  double dx = 0.0, dy = 0.0;   ///< cells [m]; 0: the shorter axis has 32
  InfluenceRange influence{};  ///< between regions that lie apart
  double penalty = 100.0;      ///< stiffness of finite elements' contact over E* a
};

struct PatchReading {
  std::optional<PatchCase> patch;  ///< empty when there is an error
  std::vector<Problem> problems;
};

/// True for a file with a [patch] table.
bool is_patch_case(const Document& document);

/// Reads `path` with overrides on top. Never throws for what a user can do wrong.
PatchReading read_patch(const std::string& path, const std::vector<std::string>& overrides);
PatchReading read_patch_text(const std::string& text, const std::string& file,
                             const std::vector<std::string>& overrides);

}  // namespace epafi
