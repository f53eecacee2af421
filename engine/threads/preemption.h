/// @file preemption.h  Whether a thread of a team is kept from running by other programs.
#pragma once

namespace epafi {

/// Of the calling thread: how often the system has taken the processor from it since it began; 0 where it does not say.
long involuntary_switches();

/// Decides for one thread when the team goes on without it: when loops wait for it, while other programs have its
/// processor, for more than a fifth of the time over some tenths of a second. Many short preemptions cost little, a few
/// time slices of another program (3 ms and more) cost more than the thread is worth. It then rests, from a tenth of a
/// second up to two where each return ends the same way. Decides speed only, never a result.
class Preemptions {
 public:
  /// A loop that ended at `now` waited for the preempted thread for `lost` [s].
  void count(double now, double lost);
  bool rests(double now) const { return now < end_of_rest_; }

 private:
  static constexpr double shortest_rest = 0.1;  // [s]
  double level_ = 0.0, last_ = 0.0, rest_ = shortest_rest, end_of_rest_ = -1e9;
};

}  // namespace epafi
