/// @file gap_field.h  The undeformed gap of two surfaces as a function over a local plane: what profiles give and patch
/// models take. Detection fills it, laws read it; neither knows the other.
#pragma once
#include <cstddef>
#include <vector>

#include "engine/state/frame.h"

namespace epafi {

/// h(x, y) on a regular grid of cells in the tangent plane of a frame; h < 0 where the undeformed surfaces
/// interpenetrate.
struct GapField {
  Vec3 origin = Vec3::Zero();  ///< of the plane, world axes [m]
  ContactFrame frame;          ///< normal from A to B, tangent1 = x, tangent2 = y
  double dx = 0.0, dy = 0.0;   ///< cell sizes [m], > 0
  std::size_t nx = 0, ny = 0;
  double curvature_x = 0.0, curvature_y = 0.0;  ///< of h at its lowest point [1/m]
  std::vector<double> gap;                      ///< h at cell centres, row by row in y: gap[iy * nx + ix] [m]

  double x(std::size_t ix) const { return (static_cast<double>(ix) + 0.5 - 0.5 * static_cast<double>(nx)) * dx; }
  double y(std::size_t iy) const { return (static_cast<double>(iy) + 0.5 - 0.5 * static_cast<double>(ny)) * dy; }
  double at(std::size_t ix, std::size_t iy) const { return gap[iy * nx + ix]; }

  /// A gap given as a function h(x, y) [m], on nx by ny cells of dx by dy around (cx, cy).
  template <class Height>
  static GapField of(double cx, double cy, double dx, double dy, std::size_t nx, std::size_t ny, Height h) {
    GapField out;
    out.dx = dx;
    out.dy = dy;
    out.nx = nx;
    out.ny = ny;
    out.gap.reserve(nx * ny);
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i) out.gap.push_back(h(cx + out.x(i), cy + out.y(j)));
    return out;
  }
};

}  // namespace epafi
