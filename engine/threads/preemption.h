/// @file preemption.h  Whether a thread of a team is kept from running by other programs.
#pragma once

namespace epafi {

/// Number of involuntary context switches of the calling thread; 0 if the system does not tell.
long involuntary_switches();

/// Decides when the team continues without a thread: if loops wait for it, while other programs use its processor, for
/// more than a fifth of the time over some tenths of a second. Many short preemptions cost little; a few time slices of
/// another program (3 ms and more) cost more than the thread gains. It then rests for a tenth of a second, up to two if
/// it is preempted again. Affects speed only, never a result.
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
