/// @file same_contacts.h  Two contact sets of one state, found by different loops.
#pragma once
#include <tuple>

#include "engine/state/contacts.h"
#include "tests/support/catch.h"

namespace epafi::experiments {

/// Names and geometry of all contacts that act, and what they do, agree to rounding.
inline void check_same_contacts(const ContactSet& found, const ContactSet& expected) {
  // adhesive contacts that have broken may still be listed, without a force
  const auto acts = [](const ContactSet& set, std::size_t i) {
    return set.gap[i] < 0.0 || set.force[i].squaredNorm() > 0.0;
  };
  std::size_t k = 0;
  const auto find_next = [&] {
    while (k < found.size() && !acts(found, k)) ++k;
  };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!acts(expected, i)) continue;
    find_next();
    REQUIRE(k < found.size());
    REQUIRE(std::tuple(found.a[k], found.b[k], found.feature[k]) ==
            std::tuple(expected.a[i], expected.b[i], expected.feature[i]));
    CHECK(found.gap[k] == Approx(expected.gap[i]).epsilon(1e-8));
    CHECK((found.normal[k] - expected.normal[i]).norm() < 1e-12);
    CHECK((found.arm[k] - expected.arm[i]).norm() < 1e-12);
    CHECK((found.force[k] - expected.force[i]).norm() < 1e-8 * (1e-3 + expected.force[i].norm()));
    if (expected.with_moment)
      CHECK((found.moment[k] - expected.moment[i]).norm() < 1e-8 * (1e-6 + expected.moment[i].norm()));
    ++k;
  }
  find_next();
  CHECK(k == found.size());
}

}  // namespace epafi::experiments
