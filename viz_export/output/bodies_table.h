/// @file bodies_table.h  Bodies as the rows of bodies.csv, which [[bodies]] reads.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "viz_export/hdf5/stored_run.h"

namespace epafi {

/// Columns of pose and velocities in a table.
inline constexpr const char* state_columns = "x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz";

/// The values of those columns at the end of `out` [m], [m/s], unit quaternion, [rad/s].
void append_state(std::string& out, const BodyRecord& body);

/// The free bodies as [[bodies]] reads them, header first: what they are in the words of the scene, as far as the run
/// file has them.
std::string bodies_csv(const StoredRun& run, const std::vector<BodyRecord>& bodies);

/// The same of an HDF5 file: of a run.h5 the last snapshot; of another file its datasets of n numbers as the columns of
/// their names, and position, velocity, angular_velocity (n rows of 3) and orientation (n of 4, w first). Throws
/// FileError: no such datasets, of different lengths, damaged.
std::string bodies_csv(const std::filesystem::path& hdf5);

}  // namespace epafi
