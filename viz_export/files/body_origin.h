/// @file body_origin.h  Description of a shape in the scene (text and axes), for files that a scene reads back.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "engine/state/types.h"

namespace epafi {

/// Description of a shape other than a sphere.
struct ShapeOrigin {
  /// Its name, or the table as written: "{ box = { size = [1, 1, 1] } }". Made on request, since it is long for a
  /// stone.
  std::function<std::string()> shape;
  double size = 1.0;                  ///< factor of all lengths, > 0
  Quat to_author = Quat(1, 0, 0, 0);  ///< principal axes to the author's
  Vec3 centre = Vec3::Zero();         ///< of mass, author's axes [m]
  bool is_turned() const { return to_author.vec().squaredNorm() > 0.0; }
};

/// By packed reference of the shape.
struct ShapeOrigins : std::map<std::uint32_t, ShapeOrigin> {
  /// Null for spheres.
  const ShapeOrigin* of(std::uint32_t shape) const {
    const auto found = find(shape);
    return found == end() ? nullptr : &found->second;
  }
};

}  // namespace epafi
