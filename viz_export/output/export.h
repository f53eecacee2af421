/// @file export.h  Frames or tables from run.h5 afterwards: `epafi export DIR`.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "viz_export/files/body_record.h"

namespace epafi {

enum class ExportFormat {
  vtk,  ///< frames/*.vtp and frames.pvd; of contacts, which run.h5 does not hold, the files that the run wrote
  csv   ///< snapshots.csv: time, step and every column of every body; measures.csv;
        ///< bodies.csv: free bodies of the last state as [[bodies]] of another scene reads them: centres of mass,
        ///< orientations of the axes in which the scene wrote the shapes, radius or shape and size, material, group
};

/// Report of what was written.
struct ExportReport {
  std::size_t snapshots = 0, measures = 0;
  std::vector<std::string> notes{};  ///< what a run that starts from the tables does not get
};

/// From folder/run.h5 into folder. later: bodies after the last snapshot, for bodies.csv; none: those of the snapshot.
/// Throws FileError.
ExportReport export_run(const std::filesystem::path& folder, ExportFormat format,
                        const std::vector<BodyRecord>& later = {});

}  // namespace epafi
