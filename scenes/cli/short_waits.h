/// @file short_waits.h  How long threads that wait for the next loop spin before they sleep.
#pragma once

namespace epafi {

/// Starts the program again with GOMP_SPINCOUNT where nobody has said how threads wait (OMP_WAIT_POLICY,
/// GOMP_SPINCOUNT): libgomp reads it before main, and left alone spins for milliseconds, in the way of the thread that
/// it waits for when others want the processor too. First in main; argv as there. Returns where it need not or cannot.
void wait_briefly(char** argv);

}  // namespace epafi
