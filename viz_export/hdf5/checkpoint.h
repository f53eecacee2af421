/// @file checkpoint.h  The whole state in one HDF5 file, column by column, without knowing what a column means.
/// Written beside its place, synced and renamed: checkpoint.h5 is always the last good one. Every column carries a hash
/// of its name and bytes; a file that is cut, torn, of another format or of another scene is refused before any state
/// changes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/state/state_visitor.h"

namespace epafi {

/// Header of a checkpoint.
struct CheckpointHeader {
  std::string version;                 ///< of the program that wrote it
  std::string scene_hash;              ///< of scene text and overrides
  std::string scene_path;              ///< as the user gave it
  std::string scene_text;              ///< fully resolved input, enough to rebuild the simulation
  std::vector<std::string> overrides;  ///< the --set values, in order
  std::uint64_t step = 0;              ///< steps done
  double time = 0.0;                   ///< [s]
  std::string record{};                ///< of its stages, opaque here; empty in files of programs without stages
};

using StateWalk = std::function<void(StateVisitor&)>;

/// Throws FileError; the previous checkpoint at `path` then stands as it was.
void save_checkpoint(const std::filesystem::path& path, const CheckpointHeader& header, const StateWalk& walk);

/// The header alone: to rebuild the simulation before its state is loaded.
CheckpointHeader read_checkpoint_header(const std::filesystem::path& path);

/// Fills the walked columns. Throws FileError where the file is of a scene with another hash, is damaged, or its
/// columns are not exactly those of the walk; after an error inside the walk the walked state is unusable. Bits are
/// promised within one version of the program; the header says which wrote the file.
CheckpointHeader load_checkpoint(const std::filesystem::path& path, const std::string& scene_hash,
                                 const StateWalk& walk);

/// Fills the columns that the walk shows from a checkpoint that holds more; what is damaged or missing is a FileError.
void load_state(const std::filesystem::path& path, const StateWalk& walk);

}  // namespace epafi
