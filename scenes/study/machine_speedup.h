/// @file machine_speedup.h  Speed-up of this machine by threads, independent of the program, as a reference for `epafi
/// bench`. Two hardware threads of one core are not two cores.
#pragma once

namespace epafi {

struct MachineSpeedup {
  double arithmetic = 1.0;  ///< of chains of multiplications and additions in registers
  double triad = 1.0;       ///< of a = b + s c over three arrays of 64 MB: of the way to memory (McCalpin 1995)
  /// From one thread to another and back by a word that both write [s]: what short pieces of shared work wait for.
  /// Processors that share no cache take five times as long. Infinite where no thread can be started.
  double round_trip = 0.0;
};

/// Rates on so many threads over those on one, the best of two each, in turns: half a second. threads >= 1.
MachineSpeedup machine_speedup(int threads);

}  // namespace epafi
