/// @file problem_file.h  Friction-contact problems in files: FCLIB's HDF5 layout (local W, q, mu and global M, H, f, w,
/// mu; Acary, Bremond, Koziara and Perignon 2014) and the text form of Siconos (.dat, W in blocks or dense). Matrices
/// are triplets (nz >= 0), columns (nz = -1) or rows (nz = -2). Three rows per contact, normal first, mu per contact.
#pragma once
#include <filesystem>
#include <string>
#include <variant>

#include "laws/nonsmooth/assembled.h"

namespace epafi {

struct ProblemFile {
  std::string name;  ///< of the file, without folder and endings
  std::variant<GlobalForm, LocalForm> form;
};

/// Throws FileError when the file is missing, damaged, of another layout, or not in three dimensions.
[[nodiscard]] ProblemFile read_problem(const std::filesystem::path& path);

/// In FCLIB's global layout, with title and description.
void write_problem(const std::filesystem::path& path, const GlobalForm& form, const std::string& title);

}  // namespace epafi
