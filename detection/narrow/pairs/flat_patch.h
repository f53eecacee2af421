/// @file flat_patch.h  Several contact points of two smooth bodies whose flat sides face each other: a cylinder on a
/// cylinder, end on end, side on end, side along side. With one point, found anew in every step, standing bodies would
/// vibrate.
#pragma once
#include "detection/narrow/pairs/core_patch.h"

namespace epafi {

/// The sides that face each other, both in A's axes relative to A's centre.
struct FlatPair {
  FlatSide a, b;
  double size;  ///< of the smaller body [m]
  double sweep_a, sweep_b;
};

/// Points with gap < reach along the common normal: corners of the sides where they lie over each other and, where none
/// of them is the nearest, the nearest point. That alone where the sides do not face each other or cross.
Patch flat_patch(const FlatPair& pair, const NearestPoint& nearest, double reach);

}  // namespace epafi
