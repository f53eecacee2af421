/// @file plain.h  Which types are their bytes: what a walk over all state may copy.
#pragma once
#include <type_traits>

#include "engine/state/types.h"

namespace epafi {

/// Plain bytes: trivially copyable types and Eigen's fixed-size vectors and quaternions (no pointers inside).
template <class T>
inline constexpr bool is_plain = std::is_trivially_copyable_v<T>;
template <class S, int R, int C, int O, int MR, int MC>
inline constexpr bool is_plain<Eigen::Matrix<S, R, C, O, MR, MC>> = R > 0 && C > 0 && std::is_arithmetic_v<S>;
template <class S, int O>
inline constexpr bool is_plain<Eigen::Quaternion<S, O>> = std::is_arithmetic_v<S>;

}  // namespace epafi
