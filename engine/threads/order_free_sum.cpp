#include "engine/threads/order_free_sum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/lanes/targets.h"

namespace epafi {

namespace {

/// 2^e of a normal number.
double power_of_two(int e) { return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52); }

/// Constant that rounds a term to line `line` of the grid when added to it.
double magic_of(int line) { return 1.5 * power_of_two(52 + OrderFreeSum::bits * line); }

constexpr double largest_double = std::numeric_limits<double>::max();

/// What both tasks go through: n terms at a time; the rest is theirs one by one.
template <int n>
struct InLanes {
  using V = typename LanesOf<n>::Real;
  using Mask = typename LanesOf<n>::Mask;
  typedef unsigned long long Count __attribute__((vector_size(8 * n)));
  EPAFI_LANES static V from(const double* x) {
    V out;
    std::memcpy(&out, x, sizeof out);
    return out;
  }
};

struct LargestTask {
  std::span<const double> terms;
  double& largest;  ///< of the magnitudes that are numbers
  bool& is_odd;     ///< some are not finite

  template <int n>
  EPAFI_LANES void run() const {
    using In = InLanes<n>;
    using V = typename In::V;
    const V most = V{} + largest_double;
    V found{};
    typename In::Mask odd{};
    std::size_t k = 0;
    for (; k + n <= terms.size(); k += n) {
      const V x = In::from(&terms[k]);
      const V size = x < V{} ? -x : x;
      found = found < size ? size : found;
      odd |= ~(size <= most);
    }
    for (int l = 0; l < n; ++l) note(found[l], odd[l] != 0);
    for (; k < terms.size(); ++k) note(std::abs(terms[k]), !(std::abs(terms[k]) <= largest_double));
  }
  EPAFI_LANES void note(double size, bool odd) const {
    largest = largest < size ? size : largest;
    is_odd = is_odd || odd;
  }
};

struct SplitTask {
  std::span<const double> terms;
  double magic[3];
  std::int64_t* word;

  template <int n>
  EPAFI_LANES void run() const {
    using In = InLanes<n>;
    using V = typename In::V;
    using Count = typename In::Count;
    const V m0 = V{} + magic[0], m1 = V{} + magic[1], m2 = V{} + magic[2];
    Count c0{}, c1{}, c2{};
    std::size_t k = 0;
    for (; k + n <= terms.size(); k += n) {
      const V x = In::from(&terms[k]);
      const V t0 = x + m0, rest = x - (t0 - m0);
      const V t1 = rest + m1, last = rest - (t1 - m1);
      const V t2 = last + m2;
      c0 += reinterpret_cast<Count>(t0);
      c1 += reinterpret_cast<Count>(t1);
      c2 += reinterpret_cast<Count>(t2);
    }
    const std::size_t times = k / n;
    add<n>(0, c0, times);
    add<n>(1, c1, times);
    add<n>(2, c2, times);
    for (; k < terms.size(); ++k) split(terms[k]);
  }
  /// Bit patterns of magic + k lines have k as their difference; they add up modulo 2^64.
  template <int n, class Count>
  EPAFI_LANES void add(std::size_t k, const Count& patterns, std::size_t times) const {
    std::uint64_t lane[n];
    std::memcpy(lane, &patterns, sizeof lane);
    for (const std::uint64_t p : lane)
      word[k] += static_cast<std::int64_t>(p - times * std::bit_cast<std::uint64_t>(magic[k]));
  }
  EPAFI_LANES void split(double rest) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const double t = rest + magic[k];
      word[k] += std::bit_cast<std::int64_t>(t) - std::bit_cast<std::int64_t>(magic[k]);
      rest -= t - magic[k];
    }
  }
};

/// By this instruction set if the terms are few: a call by pointer takes longer.
template <class Task>
void run_best(std::size_t terms, const Task& task) {
  if (terms < 16)
    task.template run<2>();
  else
    best_loop<Task>()(task);
}

/// The lowest top with 2^(bits top - 1) above a size in (0, infinity).
int top_for(double size) {
  constexpr int bits = OrderFreeSum::bits, high = 64 * bits;  // keeps the quotient positive
  const int e = static_cast<int>(std::bit_cast<std::uint64_t>(size) >> 52) - 1023;
  return std::max((e + 2 + bits - 1 + high) / bits - high / bits, OrderFreeSum::least_top);
}

}  // namespace

void OrderFreeSum::add(std::span<const double> terms) {
  double largest = 0.0;
  run_best(terms.size(), LargestTask{terms, largest, is_odd_});
  largest_ = std::max(largest_, largest);
  if (largest == 0.0) return;
  is_odd_ = is_odd_ || largest > largest_double || top_for(largest) > most_top;
  if (is_odd_) return;
  raise(top_for(largest));
  run_best(terms.size(), SplitTask{terms, {magic_of(top_ - 1), magic_of(top_ - 2), magic_of(top_ - 3)}, word_.data()});
}

/// Lines below the grid are dropped: they are what the higher grid rounds.
void OrderFreeSum::raise(int top) {
  if (top_ == no_top) top_ = top;
  for (; top_ < top && word_ != std::array<std::int64_t, 3>{}; ++top_) word_ = {0, word_[0], word_[1]};
  top_ = std::max(top_, top);
}

OrderFreeSum& OrderFreeSum::operator+=(const OrderFreeSum& other) {
  largest_ = std::max(largest_, other.largest_);
  is_odd_ = is_odd_ || other.is_odd_;
  if (is_odd_ || other.top_ == no_top) return *this;
  OrderFreeSum o = other;
  raise(o.top_);
  o.raise(top_);
  for (std::size_t k = 0; k < word_.size(); ++k) word_[k] += o.word_[k];
  return *this;
}

double OrderFreeSum::value() const {
  if (is_odd_) return std::numeric_limits<double>::quiet_NaN();
  if (top_ == no_top) return 0.0;
  __extension__ using Whole = __int128;
  const Whole line = Whole{1} << bits;
  const Whole all = (Whole{word_[0]} * line + word_[1]) * line + word_[2];
  return static_cast<double>(all) * power_of_two(bits * (top_ - 3));
}

}  // namespace epafi
