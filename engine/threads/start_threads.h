/// @file start_threads.h  The threads of the loops, started while a refusal can still be said.
#pragma once

namespace epafi {

/// Starts as many threads as parallel loops use. False where the system gives fewer (limits of memory or processes):
/// OpenMP itself would end the program at the first loop.
[[nodiscard]] bool start_threads();

}  // namespace epafi
