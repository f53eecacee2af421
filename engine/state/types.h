/// @file types.h  The words every floor shares: vectors, poses, body handles. SI units throughout.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

namespace epafi {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion w x y z, body axes to world axes. Unaligned, so that its layout is the same for every instruction
/// set.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// A body's name for life: never reused, written to files, the same on every machine.
enum class BodyId : std::uint32_t {};

/// Present row of a body in the columns; changes when bodies are sorted or removed.
using Slot = std::uint32_t;
inline constexpr Slot no_slot = 0xffffffffu;

/// Position [m] of a body's centre of mass and its orientation.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat(1, 0, 0, 0);

  Vec3 to_world(const Vec3& local) const { return position + orientation * local; }
  Vec3 to_local(const Vec3& world) const { return orientation.conjugate() * (world - position); }
};

}  // namespace epafi
