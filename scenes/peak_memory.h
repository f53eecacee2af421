/// @file peak_memory.h  Peak memory of this process, and its limit.
#pragma once
#include <cstdint>

namespace epafi {

/// Peak of resident bytes. getrusage would include the parent's memory (54 MB under Python).
std::uint64_t peak_memory();
/// Bytes of the machine, or of the limit on this process where that is less (ulimit -v).
std::uint64_t memory_there();

}  // namespace epafi
