/// @file two_normals.h  Signed distance of two round cores of which one has flat sides, as superquadrics have.
/// On a flat the point runs away under a change of the normal (x ~ d^(1/(n - 1))), at an edge the normal under a change
/// of the point; steps of either alone overshoot by the power. Here each body has a normal of its own, which it turns
/// in the way that suits the place (RoundRef::turned_of), and a step asks for the one n from which both points
/// x_A + K_A (n - n_A) and x_B - K_B (n - n_B) lie on one line along n. The two normals meet where it ends, of second
/// order, and the points are those of that last line: the one on a flat, which rounding of n leaves open, lies where
/// the other one is. No value rises from step to step, so steps that do not become shorter are damped.
#pragma once
#include "detection/narrow/gjk/common_normal.h"

namespace epafi {

/// As common_normal(), which calls it.
CommonNormal two_normals(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset, double limit);

}  // namespace epafi
