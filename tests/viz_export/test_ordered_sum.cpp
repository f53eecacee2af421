// The sum in order against the plain loop, to the last bit: terms of many magnitudes, whose sum depends on the order.
#include "viz_export/measures/ordered_sum.h"

#include <cmath>
#include <vector>

#include "engine/random.h"
#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("a sum in order has the bits of a plain loop for every length and thread count", "[viz_export][measures]") {
  const int before = thread_count();
  for (const std::size_t n : {0u, 1u, 1023u, 1024u, 16384u, 16385u, 50000u}) {
    Random random(n, 3);
    std::vector<double> term(n);
    for (double& t : term) t = random.uniform(-1, 1) * std::exp(random.uniform(-20, 20));
    double expected = 0.0, backwards = 0.0;
    for (std::size_t i = 0; i < n; ++i) expected += term[i], backwards += term[n - 1 - i];
    for (const int threads : {1, 2, 3, 7}) {
      set_thread_count(threads);
      CHECK(ordered_sum(n, 0.0, [&](std::size_t i) { return term[i]; }) == expected);
    }
    if (n > 1000) CHECK(backwards != expected);
  }
  set_thread_count(before);
}
