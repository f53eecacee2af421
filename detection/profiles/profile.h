/// @file profile.h  Cross-section of a wheel or rail as z(y): points, smoothed by a cubic spline (Reinsch 1967) to a
/// stated tolerance; slope and curvature from the spline. z must be a function of y: undercut flanks are refused.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace epafi {

/// Points of a profile [m], y increasing.
struct ProfilePoints {
  std::vector<double> y, z;
};

class Profile {
 public:
  Profile() = default;
  /// `tolerance`: root mean square distance of the spline from the points [m]; 0 goes through them (natural ends).
  explicit Profile(const ProfilePoints& points, double tolerance = 0.0);

  struct Value {
    double z, slope, second;  ///< z, dz/dy, d2z/dy2
  };
  Value at(double y) const;  ///< beyond the ends: the tangent
  double y_min() const { return y_.front(); }
  double y_max() const { return y_.back(); }
  std::size_t size() const { return y_.size(); }
  double z_of_point(std::size_t k) const { return z_[k]; }
  double y_of_point(std::size_t k) const { return y_[k]; }

 private:
  void make_index();
  /// z = c[0] + t (c[1] + t (c[2] + t c[3])), t from y: without a division, for contact searches spend a quarter of
  /// their time here.
  struct Piece {
    double y, c[4];
  };
  std::vector<double> y_, z_, second_;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> first_;  ///< last knot at or before each of equal buckets
  double per_bucket_ = 0.0;           ///< 1 / width
};

/// Either the points or what is wrong, with the line.
struct ProfileFile {
  ProfilePoints points;
  std::string problem;
  int line = 0;
};

/// Reads a CSV of y, z; its first line states the unit: `# unit: mm`. Lines with # are comments; a header line may
/// follow.
ProfileFile read_profile(const std::string& text);

/// Turned by `cant` [rad] towards the gauge side (positive y becomes lower), the highest point at z = 0.
ProfilePoints canted_rail(ProfilePoints points, double cant);

/// A cone of this slope over the tread with a flange of 70 degrees 38 mm beside the tape circle, a fillet of 13 mm
/// between.
ProfilePoints cone_profile(double conicity);

/// Built-in profiles: "s1002" (wheel), "60e1", "uic60" (rails, upright). Null for another name.
const ProfilePoints* built_in_profile(const std::string& name);

}  // namespace epafi
