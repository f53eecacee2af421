/// @file peak_memory.h  The most memory that this process has held.
#pragma once
#include <cstdint>

namespace epafi {

/// Resident bytes at the most. Not getrusage's: a program starts there with what its parent held, 54 MB under Python.
std::uint64_t peak_memory();

}  // namespace epafi
