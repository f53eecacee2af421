/// @file damaged_run.h  A damaged run.h5: the damage, and the remaining files of the folder.
#pragma once
#include <filesystem>
#include <string>

#include "engine/units/error.h"

namespace epafi {

/// The message is the damage, then what can be done.
struct DamagedRun : FileError {
  DamagedRun(const std::filesystem::path& file, std::string found);
  std::string damage;  ///< with the file's name
};

/// In place of HDF5's words where the file is empty, cut or no HDF5 file at all; else `cause`, which names the file.
[[nodiscard]] std::string damage_text(const std::filesystem::path& file, const std::string& cause);

}  // namespace epafi
