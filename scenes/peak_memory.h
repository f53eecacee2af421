/// @file peak_memory.h  The most memory that this process has held, and what it may have.
#pragma once
#include <cstdint>

namespace epafi {

/// Resident bytes at the most. Not getrusage's: a program starts there with what its parent held, 54 MB under Python.
std::uint64_t peak_memory();
/// Bytes of the machine, or of the limit on this process where that is less (ulimit -v).
std::uint64_t memory_there();

}  // namespace epafi
