/// @file run_facts.h  Data of a run in the form of its summary.json; for a running or killed one from its other files.
#pragma once
#include <filesystem>

#include "viz_export/files/json_reader.h"
#include "viz_export/view/view_source.h"

namespace epafi {

/// summary.json where it is there; else status "running" or "cut", time, bodies, last energies, measures, warnings.
/// Facts known only at the end of a run (steps, overlap, residual over all steps, time by stage) are absent then.
[[nodiscard]] FlatJson run_facts(const std::filesystem::path& folder);
[[nodiscard]] FlatJson run_facts(const std::filesystem::path& folder, const ViewSource& source);

}  // namespace epafi
