/// @file projected_field.h  The undeformed gap of two meshes over a grid in their common tangent plane: what boundary
/// elements on half-spaces take (laws/wheel_rail/half_space/normal.h).
/// h(x, y) is the sum of the distances from the plane's point to its closest-point projections on both surfaces, each
/// negative where the point is inside that body. Against the gap along the plane's own normal it
/// is short by half the square of the surfaces' slope, relative: of the order of what a half-space leaves out.
#pragma once
#include "detection/surfaces/surface_gap.h"
#include "engine/railway/gap_field.h"

namespace epafi {

/// Fills field.gap; origin, frame, cell sizes and counts are given, the frame's normal from the first surface to the
/// second. Surfaces: outward counter-clockwise, over `nodes`. Not a number where one of them is farther than `band` [m]
/// from the plane. Curvatures are left alone.
void project_gaps(std::span<const Vec3> nodes, std::span<const Triangle> first, std::span<const Triangle> second,
                  double band, GapField& field);

}  // namespace epafi
