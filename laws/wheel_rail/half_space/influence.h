/// @file influence.h  Surface displacement of two elastic half-spaces from a uniform traction on a rectangle
/// (Boussinesq and Cerruti, integrated by Love 1929; Kalker 1990, section 4.3.2). Relative displacement, rail minus
/// wheel.
#pragma once
#include "laws/wheel_rail/elastic_pair.h"

namespace epafi {

/// Displacement [m] per traction [Pa] at a point from a rectangle: zz of pressure, xx xy yy of tangential traction.
struct Influence {
  double zz, xx, xy, yy;
};

/// At (x, y) from the centre of a rectangle of half sizes hx, hy [m].
Influence influence(double x, double y, double hx, double hy, const ElasticPair& pair);

}  // namespace epafi
