/// @file start_run.h  An earlier run, opened with its last state, as the start of another one.
#pragma once
#include <filesystem>

#include "scenes/assemble.h"
#include "viz_export/hdf5/checkpoint.h"

namespace epafi {

struct MadeRun {
  CheckpointHeader header;
  RunRecord record;
  std::unique_ptr<Assembly> assembly;  ///< its scene with all bodies, also those of fills
  std::string hash;                    ///< of its state
};

/// Throws FileError where a folder has no checkpoint; that of a sweep names its runs.
void check_is_run(const std::filesystem::path& run);

/// run: its folder, or a checkpoint. Throws FileError and SceneError: not there, of another version, its scene is
/// gone or has changed.
std::shared_ptr<MadeRun> open_made_run(const std::filesystem::path& run);

/// The scene of a checkpoint at its present stage, as when it was written; a SceneError where it has changed.
Scene scene_of(const CheckpointHeader& header, const RunRecord& record);

/// Options of assembly for which the state of the checkpoint fits.
AssembleOptions options_of(const RunRecord& record);

/// Description of a run for another process of the program, and its assembly there without bodies.
std::string text_of(const CheckpointHeader& header);
std::unique_ptr<Assembly> part_of(const std::string& text);

/// The same as it was at the time of one of its snapshots [s]: the stage of that time, bodies and motions as they were.
/// Contacts remember nothing. Throws SceneError where there is no such snapshot.
std::shared_ptr<MadeRun> open_made_run_at(const std::filesystem::path& folder, double time);

}  // namespace epafi
