/// @file precompiled.h  What nearly every file includes, compiled once per build: Eigen alone costs 1.9 s per file.
/// A convenience of the build only: every file includes what it uses.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>
