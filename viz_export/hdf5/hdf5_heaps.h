/// @file hdf5_heaps.h  HDF5 1.10 reads the names of an old group from wherever the file says they are; a broken address
/// ends the program in the library. Asked before such a file is opened.
#pragma once
#include <filesystem>

namespace epafi {

/// Throws FileError where a local heap of a file with superblock 0 or 1 lies outside the file (HDF5 File Format
/// Specification 3.0, II.A and III.D). Files of later superblocks, all of this program's own, have none and are not
/// read; neither is what is no HDF5 file.
void refuse_broken_heaps(const std::filesystem::path& path);

}  // namespace epafi
