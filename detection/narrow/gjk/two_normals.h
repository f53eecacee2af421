/// @file two_normals.h  Signed distance of two round cores of which one has flat sides, as superquadrics have.
/// On a flat the support point is very sensitive to the normal (x ~ d^(1/(n - 1))), at an edge the normal to the point,
/// so Newton steps in either alone overshoot. Here each body has its own normal, updated in the variable that suits the
/// place (RoundRef::turned_of). A step solves for the n for which both points x_A + K_A (n - n_A) and x_B - K_B (n -
/// n_B) lie on one line along n. The two normals converge to each other at second order. The result is the last line,
/// so that a point on a flat, which n determines only to rounding, lies opposite the other one. No function decreases
/// monotonically, so steps that do not become shorter are damped.
#pragma once
#include "detection/narrow/gjk/common_normal.h"

namespace epafi {

/// Method of common_normal() for bodies with flat sides; same arguments and result.
CommonNormal two_normals(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset, double limit);

}  // namespace epafi
