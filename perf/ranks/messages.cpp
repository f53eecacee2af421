// What messages cost between the processes that mpirun has begun, as one line of JSON: the inputs of model.py.
// Rows go by the plans that a run uses, from every process to the next one; sums and orders as in a step.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "ranks/communicator.h"
#include "ranks/plan.h"

namespace {

using namespace epafi;

constexpr std::size_t row = 128;  ///< bytes of a ghost: its state

/// Seconds of one call of f: the least of many short trials, so that some meet nobody else on the machine.
template <class F>
double seconds_of(int trials, int calls, F&& f) {
  double least = 1e300;
  for (int trial = 0; trial < trials; ++trial) {
    double one = 1.0;
    sum_over_ranks({&one, 1});  // all begin together
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < calls; ++k) f();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    double longest = took.count() / calls;
    max_over_ranks({&longest, 1});
    least = std::min(least, longest);
  }
  return least;
}

double exchange(std::size_t rows, int trials, int calls) {
  const int next = (rank_number() + 1) % rank_count();
  Plan plan(std::vector<int>(rows, next));
  const RowBytes out(rows * row, std::byte{});
  RowBytes in;
  return seconds_of(trials, calls, [&] { plan.run(out, row, in); });
}

/// All rows come to process 0.
double gather(std::size_t rows) {
  Plan plan(std::vector<int>(rows, 0));
  const RowBytes out(rows * row, std::byte{});
  RowBytes in;
  return seconds_of(15, 1, [&] { plan.run(out, row, in); });
}

}  // namespace

int main(int argc, char** argv) {
  begin_ranks(argc, argv);
  {
    constexpr std::size_t many = 20000;
    const double one = exchange(1, 60, 10), large = exchange(many, 15, 1), all = gather(many);
    Joint joint;
    std::vector<double> sums(17), largest(10);
    const double sum = seconds_of(60, 10, [&] {
      joint.begin(sums, largest);
      joint.finish(sums, largest);
    });
    char order[80] = {};
    const double tell = seconds_of(60, 10, [&] { broadcast(order, sizeof order); });
    if (rank_number() == 0) {
      const double size = static_cast<double>(many * row);
      std::fputs(fmt::format("{{\"processes\": {}, \"message\": {:.3g}, \"rate\": {:.3g}, \"gather_rate\": {:.3g}, "
                             "\"sum\": {:.3g}, \"order\": {:.3g}}}\n",
                             rank_count(), one, size / (large - one), rank_count() * size / all, sum, tell)
                     .c_str(),
                 stdout);
    }
  }
  end_ranks();
}
