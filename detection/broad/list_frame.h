/// @file list_frame.h  Frame of a pair list: the predicted common motion (engine/step/common_motion.h) and the uniform
/// flow of a deforming periodic cell. Only displacements relative to it use up margins. With x0 the position when the
/// list was built, F = diag(f) the stretch of the cell about its low corner, c the common displacement and u = x - (F
/// x0 + c): the distance of two bodies is at least |F (x0 - y0)| - |u| - |v|. A pair that was not listed was further
/// apart than the sum of its fat radii H; it stays out of reach while |u| + max|f - 1| H is below half the margin for
/// both.
#pragma once
#include <algorithm>

#include "engine/state/periodic_cell.h"
#include "engine/state/types.h"

namespace epafi {

struct ListFrame {
  Vec3 common = Vec3::Zero();   ///< c [m]
  Vec3 low = Vec3::Zero();      ///< of the cell [m]
  Vec3 stretch = Vec3::Ones();  ///< f
  double strain = 0.0;          ///< largest |f - 1|
  double strain_use = 0.0;      ///< strain times the largest fat radius over half its margin

  bool flows() const { return strain != 0.0; }
  /// Displacement of the frame at x0 [m]: exactly 0 along axes without common motion and flow.
  Vec3 way_from(const Vec3& x0) const { return (stretch - Vec3::Ones()).cwiseProduct(x0 - low) + common; }
  /// Position at the list's update of a point of the frame that is at x now [m].
  Vec3 back(const Vec3& x) const {
    return flows() ? Vec3(low + (x - common - low).cwiseQuotient(stretch)) : Vec3(x - common);
  }
  /// Largest factor by which distances between points `back` have grown.
  double growth() const { return flows() ? std::max(1.0, stretch.maxCoeff()) : 1.0; }

  void take_cell(const PeriodicCell& cell, const Vec3& size_then) {
    for (int k = 0; k < 3; ++k)
      if (cell.repeats[static_cast<std::size_t>(k)]) stretch[k] = cell.size[k] / size_then[k];
    strain = (stretch - Vec3::Ones()).cwiseAbs().maxCoeff();
    low = cell.low;
  }
};

}  // namespace epafi
