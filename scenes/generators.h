/// @file generators.h  Bodies of a [[fill]]: centres, sizes, orientations, own velocities, all by the fill and its
/// seed.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scenes/occupancy.h"
#include "scenes/scene.h"

namespace epafi {

/// Data of a shape for a fill.
struct FillShape {
  double radius = 0.0;  ///< of the bounding sphere at size factor 1 [m]
  double mass = 0.0;    ///< at size factor 1 [kg]
  bool is_sphere = false;
};

struct FillBody {
  std::size_t shape = 0;  ///< index into FillSpec::shapes
  double size = 1.0;      ///< factor of the shape's size
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();  ///< beside that of the fill [m/s]
  Quat orientation = Quat(1, 0, 0, 0);
};

struct FillResult {
  std::vector<FillBody> bodies;
  std::string shortfall;  ///< why there are fewer bodies than asked for; empty when all are placed
};

struct SizeBounds {
  double min, max;
};
/// Three deviations on both sides of the mean, of the logarithm for lognormal sizes.
SizeBounds natural_bounds(const FillSpec::Size& size);

/// Obstacles of a fill.
struct Obstacles {
  Occupancy occupied{};  ///< free bodies that are there: those of the fill are added where `keep` is set
  bool keep = false;     ///< another fill follows, or bodies may meet their own images
  std::function<bool(const FillBody&)> meets_held{};  ///< it would overlap a fixed or driven body; empty: none is near
  bool is_free(const FillBody& body, double radius) const {
    return (occupied.empty() || occupied.is_free(body.position, radius)) && !(meets_held && meets_held(body));
  }
};

/// Bounding spheres of the placed bodies overlap neither each other nor present free bodies, and stay in the region;
/// the bodies overlap no fixed or driven one. lattice: cubic cells of 1.02 of the largest diameter, filled from below,
/// each body at a random position in its cell; after three failed trials a cell stays empty. pour: bodies without
/// positions. random: sequential insertion, from below in slices; stops after 200 rejected trials in a row per body.
FillResult generate(const FillSpec& fill, const std::vector<FillShape>& shapes, Obstacles& obstacles);
FillResult generate(const FillSpec& fill, const std::vector<FillShape>& shapes);

/// Largest number of bodies of a fill: as requested, or as the region can hold.
double most_bodies_of(const FillSpec& fill, const std::vector<FillShape>& shapes);

}  // namespace epafi
