/// @file last_state.h  The bodies at the end of a run that stopped after its last snapshot.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "scenes/start_run.h"
#include "viz_export/files/body_record.h"

namespace epafi {

struct LastState {
  std::vector<BodyRecord> bodies;  ///< in the order of their ids; empty where the last snapshot is the last state
  std::string note;                ///< for the user: of what time the bodies are, or why they are those of the snapshot

  std::shared_ptr<MadeRun> made;           ///< owns what the bodies point to
  std::unique_ptr<SurfaceCache> surfaces;  ///< the same
};

/// folder: of a run. Reads its checkpoint only where that is later than the last snapshot of run.h5: a run that was
/// stopped by --steps, by a limit of time or by a signal.
LastState last_state(const std::filesystem::path& folder);

}  // namespace epafi
