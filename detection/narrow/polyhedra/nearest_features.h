/// @file nearest_features.h  The closest points of two separated polyhedra from the features they lie on.
/// Local optimality is global for the distance of convex bodies: points on two features are the closest where their
/// difference lies in the normal cones of both (Lin and Canny 1991). Here both conditions must hold by more than
/// rounding, so that exactly one pair of features can pass: the bits of the result do not depend on where the
/// candidates come from.
#pragma once
#include "detection/narrow/polyhedra/pair_memory.h"
#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi {

/// True where the features hold the closest points, clear of every border by more than 1e-10 of the size; `out` is then
/// the distance. False for bodies that touch, overlap or have no single closest pair.
bool certify(const PolyhedronPair& pair, const NearestFeatures& features, PolyhedronDistance& out);

/// The features that GJK's closest points lie on, where some certify.
bool find_nearest_features(const PolyhedronPair& pair, const GjkResult& gjk, NearestFeatures& features,
                           PolyhedronDistance& out);

}  // namespace epafi
