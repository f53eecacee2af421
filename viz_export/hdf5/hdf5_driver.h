/// @file hdf5_driver.h  How files of unknown origin are read: through a driver that gives HDF5 bytes of the file or an
/// error. HDF5 1.10's own keeps the last bytes it read (its metadata accumulator) and, asked for an address that a
/// broken file made up, copies from beside them: the program ended in the library.
#pragma once
#include <cstdint>

namespace epafi {

/// Sets the driver in a file access property list (HDF5's number of it), for H5F_ACC_RDONLY. False where HDF5 refuses.
bool set_checked_reading(std::int64_t access);

}  // namespace epafi
