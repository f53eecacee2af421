/// @file contact_region.h  Geometry of a region where wheel and rail touch or nearly touch: result of a search, input
/// of normal models. For models of strips across the track; others use gap_field.h.
#pragma once
#include <cstddef>
#include <vector>

#include "engine/railway/gap_field.h"
#include "engine/railway/gap_operator.h"

namespace epafi {

/// The undeformed gap along one line across the track, and its curvature along the track there.
struct GapProfile {
  double start = 0.0, step = 0.0;   ///< lateral coordinate in the tangent plane: y(k) = start + k step [m]
  std::vector<double> gap;          ///< smallest gap over x [m]
  std::vector<double> curvature_x;  ///< second derivative of the gap along x [1/m]
  std::vector<double> centre_x;     ///< where along x the gap is smallest [m]
  double y(std::size_t k) const { return start + static_cast<double>(k) * step; }
  std::size_t size() const { return gap.size(); }
};

struct ContactRegion {
  Vec3 point = Vec3::Zero();                    ///< rigid contact point, track axes (x forwards, y right, z down) [m]
  double y_wheel = 0.0;                         ///< from the tape circle, flange side negative [m]
  double y_rail = 0.0;                          ///< from the rail's axis, gauge side positive [m]
  double angle = 0.0;                           ///< of the tangent plane against the track's, y towards z [rad]
  double rolling_radius = 0.0;                  ///< [m]
  double offset = 0.0;                          ///< rigid gap here when the deepest region touches [m], >= 0
  double curvature_x = 0.0, curvature_y = 0.0;  ///< of the gap at the point [1/m]
  double wheel_curvature = 0.0, rail_curvature = 0.0;  ///< of the profiles there, > 0 convex [1/m]
  GapProfile profile;                                  ///< empty where the gap is a quadratic
};

/// Undeformed gaps that can be sampled on any grid.
class GapSource {
 public:
  virtual ~GapSource() = default;
  virtual std::vector<ContactRegion> regions() const = 0;
  /// The same region with the tangent plane at another y, at this angle; curvatures remain those of the rigid contact
  /// point.
  virtual ContactRegion moved(const ContactRegion& region, double y, double angle) const = 0;
  /// Angle of the rail's surface at y of the tangent plane, in track axes [rad].
  virtual double angle_at(const ContactRegion& region, double y) const = 0;
  /// Cells dx by dy, centred on (x, y) of the region's tangent plane.
  virtual GapField field(const ContactRegion& region, double x, double y, double dx, double dy, std::size_t nx,
                         std::size_t ny) const = 0;
  /// Gaps between two meshes of triangles over these nodes, outward counter-clockwise: of `second` to its projection on
  /// `first`, up to `band` on either side [m].
  virtual std::unique_ptr<GapOperator> gaps_between(GapMethod method, std::span<const Vec3> nodes,
                                                    std::span<const std::array<std::uint32_t, 3>> first,
                                                    std::span<const std::array<std::uint32_t, 3>> second,
                                                    double band) const = 0;
};

}  // namespace epafi
