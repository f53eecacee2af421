/// @file shared_out.h  How long the calling thread has been in loops that are shared out over threads, or would be if
/// there were more than one: what is left of a stage is its serial part, which no further thread makes shorter.
#pragma once
#include <chrono>

namespace epafi {

/// Lives as long as a loop; one inside another counts once. Two readings of the clock, 50 ns, where a fork of 2 us
/// pays.
class SharedOut {
 public:
  /// pays: the loop is long enough to be shared out; others count as serial.
  explicit SharedOut(bool pays) : outermost_(pays && !counting_) {
    if (outermost_) {
      counting_ = true;
      begin_ = Clock::now();
    }
  }
  ~SharedOut() {
    if (outermost_) {
      counting_ = false;
      seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count();
    }
  }
  SharedOut(const SharedOut&) = delete;
  SharedOut& operator=(const SharedOut&) = delete;

  /// Of the calling thread since it began [s].
  static double seconds() { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constinit inline thread_local bool counting_ = false;
  static constinit inline thread_local double seconds_ = 0.0;
  bool outermost_;
  Clock::time_point begin_;
};

}  // namespace epafi
