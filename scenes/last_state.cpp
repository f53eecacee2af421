#include "scenes/last_state.h"

#include <fmt/format.h>

#include "viz_export/hdf5/stored_run.h"

namespace epafi {

LastState last_state(const std::filesystem::path& folder) {
  LastState out;
  const std::filesystem::path checkpoint = folder / "checkpoint.h5";
  if (!std::filesystem::exists(checkpoint) || !std::filesystem::exists(folder / "run.h5")) return out;
  const StoredRun run(folder / "run.h5");
  if (run.snapshots() == 0) return out;
  const double snapshot = run.time(run.snapshots() - 1);
  try {
    const double time = read_checkpoint_header(checkpoint).time;
    if (!(time > snapshot)) return out;
    out.made = open_made_run(folder);
    const Assembly& assembly = *out.made->assembly;
    out.surfaces = std::make_unique<SurfaceCache>(*assembly.shapes);
    out.bodies = body_records(assembly.simulation->world, *out.surfaces);
    const std::size_t stored = run.bodies().size();
    for (const BodyRecord& b : out.bodies)
      if (b.id >= stored && b.surface != nullptr && !b.is_wall())
        throw FileError("since then bodies have come in whose shapes run.h5 does not name");
    out.note = fmt::format("bodies.csv is of {:.6g} s, where the run stopped; its last snapshot is of {:.6g} s", time,
                           snapshot);
  } catch (const std::exception& trouble) {
    out.bodies.clear();
    out.note = fmt::format("bodies.csv is of the last snapshot, {:.6g} s, not of the state where the run stopped: {}",
                           snapshot, trouble.what());
  }
  return out;
}

}  // namespace epafi
