/// @file contact_file.h  Reads the contacts of a frame back from the .vtp that the run wrote (run.h5 has none).
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// A contact as files show it.
struct StoredContact {
  std::uint32_t a = 0, b = 0;           ///< ids
  Eigen::Vector3f from, to;             ///< centres; the contact point in place of a wall's centre [m]
  Eigen::Vector3f force;                ///< on A [N]
  float normal_force = 0, overlap = 0;  ///< [N], [m]
  float residual = 0;                   ///< its part of the solver's; 0 where the run has none
};

/// Contacts of one frame.
struct ContactFile {
  std::vector<StoredContact> contacts;
  bool has_residual = false;
};

/// Throws FileError where the file is not one of ours, or is cut.
[[nodiscard]] ContactFile read_contacts(const std::filesystem::path& path);

}  // namespace epafi
