/// @file domain.h  The box that bodies must not leave, and the test for states that are not finite.
#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "engine/state/world.h"

namespace epafi {

/// A run that cannot go on. The state before the step is the last good one.
struct Failure {
  std::string kind;  ///< "non-finite state", "lost body"
  std::uint64_t step = 0;
  std::optional<BodyId> body{};
  std::string text;  ///< cause with value and unit, next action
};

struct Domain {
  enum class Outside { error, remove };
  Vec3 min = Vec3::Constant(-std::numeric_limits<double>::infinity());
  Vec3 max = Vec3::Constant(std::numeric_limits<double>::infinity());
  Outside outside = Outside::error;
  bool contains(const Vec3& x) const { return (x.array() >= min.array()).all() && (x.array() <= max.array()).all(); }
};

/// Extent of all free bodies [m], and whether all their positions and velocities are finite.
struct Extent {
  static constexpr double none = std::numeric_limits<double>::infinity();
  Vec3 low = Vec3::Constant(none), high = Vec3::Constant(-none);
  Vec3 slowest = Vec3::Constant(none), fastest = Vec3::Constant(-none);  ///< by axis [m/s]; of SharedModel::begun
  bool finite = true;

  Extent& operator+=(const Extent& o) {
    low = low.cwiseMin(o.low);
    high = high.cwiseMax(o.high);
    slowest = slowest.cwiseMin(o.slowest);
    fastest = fastest.cwiseMax(o.fastest);
    finite = finite && o.finite;
    return *this;
  }
  /// True if certainly no body is outside or not finite.
  bool is_inside(const std::optional<Domain>& domain) const {
    return finite && (!domain || (domain->contains(low) && domain->contains(high)));
  }
};

/// Free bodies that are outside the domain or whose position or velocity is not finite, in the order of ids; one pass
/// over positions and velocities.
std::vector<Slot> find_strays(const World& world, const std::optional<Domain>& domain);
bool is_finite(const World& world, Slot s);

}  // namespace epafi
