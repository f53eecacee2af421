/// @file shared_out.h  Time of the calling thread in loops that are parallel, or would be with several threads. The
/// rest of a stage is its serial part.
#pragma once
#include <chrono>

namespace epafi {

/// Lives as long as a loop; nested ones count once. Costs two clock readings, 50 ns.
class SharedOut {
 public:
  /// pays: the loop is long enough for several threads; others count as serial.
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

  /// Sum for the calling thread [s].
  static double seconds() { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constinit inline thread_local bool counting_ = false;
  static constinit inline thread_local double seconds_ = 0.0;
  bool outermost_;
  Clock::time_point begin_;
};

}  // namespace epafi
