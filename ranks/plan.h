/// @file plan.h  Rows to ranks, as often as wanted: one of Zoltan's communication plans.
#pragma once
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace epafi {

class Plan {
 public:
  Plan() = default;
  /// to: the rank that each row goes to, this one included.
  explicit Plan(std::vector<int> to);
  Plan(const Plan&) = delete;
  Plan(Plan&& o) noexcept { swap(o); }
  Plan& operator=(const Plan&) = delete;
  Plan& operator=(Plan&& o) noexcept {
    swap(o);
    return *this;
  }
  ~Plan();

  std::size_t sent() const { return sent_; }
  std::size_t received() const { return received_; }
  /// Rows of so many bytes, in the order of `to`. Those that come do so in the same order in every call, those of one
  /// rank as it sent them.
  void run(const std::vector<std::byte>& rows, std::size_t row, std::vector<std::byte>& arrived) const {
    begin(rows, row, arrived);
    finish(rows, row, arrived);
  }
  /// The same in two steps, both with the same rows, which stay as they are in between.
  void begin(const std::vector<std::byte>& rows, std::size_t row, std::vector<std::byte>& arrived) const;
  void finish(const std::vector<std::byte>& rows, std::size_t row, std::vector<std::byte>& arrived) const;

 private:
  void swap(Plan& o) {
    std::swap(plan_, o.plan_);
    std::swap(sent_, o.sent_);
    std::swap(received_, o.received_);
  }
  void* plan_ = nullptr;
  std::size_t sent_ = 0, received_ = 0;
};

}  // namespace epafi
