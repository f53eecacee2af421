/// @file part_figures.h  What sharing out has come to, of this rank and of all.
#pragma once
#include <chrono>
#include <ctime>
#include <utility>

#include "engine/ranks/remote_steps.h"

namespace epafi {

struct PartFigures {
  double own = 0.0, ghosts = 0.0;  ///< bodies, summed over the steps
  double steps = 0.0;
  double moved = 0.0;  ///< number of times that bodies moved to other ranks
  double bytes = 0.0;  ///< sent in all
  RankSeconds seconds{};
  double& operator[](RankStage stage) { return seconds[static_cast<std::size_t>(stage)]; }
};

/// Adds wall time to stages of a rank.
class RankTimer {
 public:
  explicit RankTimer(PartFigures& figures) : figures_(figures) {}
  /// Since the last lap, or since this began.
  void lap(RankStage stage) {
    const auto now = Clock::now();
    figures_[stage] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  /// The time since the last lap is booked elsewhere.
  void skip() { last_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  PartFigures& figures_;
  Clock::time_point last_ = Clock::now();
};

/// Processor time of this process, all threads, for what is to be balanced.
class WorkMeter {
 public:
  void begin() { begun_ = std::clock(); }
  void end() { ticks_ += std::clock() - begun_; }
  /// Since the last call [s].
  double take() { return seconds_of(static_cast<double>(std::exchange(ticks_, 0))); }
  double seconds() const { return seconds_of(ticks()); }
  /// A whole number: sums of them are exact.
  double ticks() const { return static_cast<double>(ticks_); }
  static double seconds_of(double ticks) { return ticks / CLOCKS_PER_SEC; }

 private:
  std::clock_t begun_ = 0, ticks_ = 0;
};

/// By all ranks.
RankFigures gather_figures(const PartFigures& mine);

}  // namespace epafi
