/// @file run_layout.h  What writer and reader of run.h5 share.
#pragma once
#include "viz_export/hdf5_file.h"

namespace epafi::run_layout {

inline constexpr const char* kind = "epafi run";
inline constexpr std::uint64_t format = 1;  ///< grows when old files can no longer be read

/// Throws FileError unless the file is a run that this program reads.
inline void check(const Hdf5File& file) {
  const std::string path = file.path().string();
  if (!file.has_attribute("/", "kind") || file.text_attribute("/", "kind") != kind)
    throw FileError(path + ": is not a run file of Epafi");
  const std::uint64_t found = file.count_attribute("/", "format");
  if (found != format)
    throw FileError(path + ": has run format " + std::to_string(found) + ", this program reads " +
                    std::to_string(format));
}

}  // namespace epafi::run_layout
