/// @file run_layout.h  Format numbers of run.h5, for writer and reader.
#pragma once
#include "viz_export/hdf5/hdf5_file.h"

namespace epafi::run_layout {

inline constexpr const char* kind = "epafi run";
/// Increases with each incompatible change.
inline constexpr std::uint64_t format = 2;
/// The oldest that is read. 1: points of shapes and orientations are of principal axes, not of those that the scene
/// wrote; shapes have no names; rows of bodies that came later may be empty.
inline constexpr std::uint64_t oldest_format = 1;

/// The file's format. Throws FileError unless it is a run that this program reads.
inline std::uint64_t check(const Hdf5File& file) {
  const std::string path = file.path().string();
  const std::string found_kind = file.has_attribute("/", "kind") ? file.text_attribute("/", "kind") : "";
  if (found_kind != kind)
    throw FileError(path + ": is not a run file of Epafi but " +
                    (found_kind.empty() ? "the HDF5 file of something else" : "an '" + found_kind + "'") +
                    "; `epafi run SCENE -o DIR` writes DIR/run.h5");
  const std::uint64_t found = file.count_attribute("/", "format");
  if (found < oldest_format || found > format)
    throw FileError(path + ": has run format " + std::to_string(found) + ", this program reads " +
                    std::to_string(oldest_format) + " to " + std::to_string(format));
  return found;
}

}  // namespace epafi::run_layout
