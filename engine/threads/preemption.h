/// @file preemption.h  Whether a thread of a team is kept from running by other programs.
#pragma once
#include <algorithm>

namespace epafi {

/// Of the calling thread: how often the system has taken the processor from it since it began; 0 where it does not say.
long involuntary_switches();

/// Decides for one thread when the team goes on without it. Each preemption within a loop makes everybody wait for a
/// time slice of another program (3 ms and more), so three within a tenth of a second are too many: the thread then
/// rests, from a tenth of a second up to two where each return ends the same way. Decides speed only, never a result.
class Preemptions {
 public:
  /// The thread was preempted in a loop that ended at `now` [s].
  void count(double now) {
    level_ = std::max(0.0, level_ - (now - last_) / decay) + 1.0;
    last_ = now;
    if (level_ <= allowed) return;
    rest_ = now - end_of_rest_ < 4 * rest_ ? std::min(2 * rest_, longest_rest) : shortest_rest;
    end_of_rest_ = now + rest_;
    level_ = 0.0;
  }
  bool rests(double now) const { return now < end_of_rest_; }

 private:
  static constexpr double decay = 0.05;  ///< seconds that make up for one preemption
  static constexpr double allowed = 2.0;
  static constexpr double shortest_rest = 0.1, longest_rest = 2.0;  // [s]
  double level_ = 0.0, last_ = 0.0, rest_ = shortest_rest, end_of_rest_ = -1e9;
};

}  // namespace epafi
