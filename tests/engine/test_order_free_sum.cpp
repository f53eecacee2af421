#include "engine/threads/order_free_sum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "engine/lanes/targets.h"
#include "engine/state/incidence.h"
#include "engine/step/sources.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"

using namespace epafi;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();

std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }

/// n terms 2^e with e in [-spread, spread], of both signs.
std::vector<double> terms_of(std::size_t n, double spread, std::uint64_t seed) {
  Random random(seed, n);
  std::vector<double> x(n);
  for (double& v : x) {
    const double e = std::round(random.uniform(-spread, spread));
    v = std::ldexp(random.uniform(-1.0, 1.0), static_cast<int>(e));
  }
  return x;
}

void shuffle(std::vector<double>& x, std::uint64_t seed) {
  Random random(seed, 77);
  for (std::size_t k = x.size(); k > 1; --k)
    std::swap(x[k - 1], x[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(k)))]);
}

double exact(const std::vector<double>& x) {
  ExactSum sum;
  for (const double v : x) sum.add(v);
  return sum.value();
}

/// In parts of 1 to 40 terms, joined in the order that comes.
template <class Sum>
Sum in_parts(const std::vector<double>& x, std::uint64_t seed) {
  Random random(seed, 5);
  Sum total;
  for (std::size_t k = 0; k < x.size();) {
    const std::size_t end = std::min(x.size(), k + 1 + static_cast<std::size_t>(random.uniform(0.0, 40.0)));
    Sum part;
    for (; k < end; ++k) part.add(x[k]);
    total += part;
  }
  return total;
}

}  // namespace

TEST_CASE("a sum without order has the same bits for every order and every split", "[engine][sums]") {
  for (const double spread : {0.0, 5.0, 40.0, 300.0, 900.0})
    for (const std::size_t n : {std::size_t{2}, std::size_t{37}, std::size_t{5000}}) {
      std::vector<double> x = terms_of(n, spread, 3);
      const double first = order_free_sum(x), rounded_once = exact(x);
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        INFO("spread " << spread << ", " << n << " terms, order " << seed);
        shuffle(x, seed);
        REQUIRE(bits_of(order_free_sum(x)) == bits_of(first));
        REQUIRE(bits_of(exact(x)) == bits_of(rounded_once));
        REQUIRE(bits_of(in_parts<ExactSum>(x, seed).value()) == bits_of(rounded_once));
        const auto parts = in_parts<OrderFreeSum>(x, seed);
        REQUIRE(bits_of(value_of(parts, n, [&](std::size_t i) { return x[i]; })) == bits_of(first));
      }
    }
}

// multiples of half a line of the lower grid: rounding there and on the higher one must agree on every tie
TEST_CASE("a part on a lower grid rounds its ties as the higher grid does", "[engine][sums]") {
  Random random(9, 9);
  for (int k = 0; k < 2000; ++k) {
    const auto half_lines = [&](int e) { return std::ldexp(std::round(random.uniform(-8.0, 8.0)), e); };
    const std::vector<double> low{half_lines(-32) + half_lines(-2), half_lines(-1), half_lines(-33)};
    const double high = std::ldexp(random.uniform(0.5, 1.0), k % 130);  // up to four lines above
    OrderFreeSum together, apart, other;
    together.add(std::vector{low[0], high, low[1], low[2]});
    apart.add(low);
    other.add(high);
    apart += other;
    INFO("case " << k);
    REQUIRE(bits_of(apart.value()) == bits_of(together.value()));
  }
}

TEST_CASE("a sum without order has the same bits for every thread count and instruction set",
          "[engine][sums][threads]") {
  const support::KeepThreads keep;
  const Target widest = target();
  const std::vector<double> x = terms_of(20'011, 30.0, 1);
  const double first = order_free_sum(x);
  for (const Target t : {Target::baseline, Target::avx2, Target::avx512}) {
    limit_target(std::min(t, widest));
    for (const int threads : {1, 2, 3, 8}) {
      set_thread_count(threads);
      CHECK(bits_of(order_free_sum(x)) == bits_of(first));
    }
  }
  limit_target(widest);
}

TEST_CASE("the error of a sum without order is below 2^-62 of the largest term for each", "[engine][sums]") {
  for (const double spread : {0.0, 10.0, 200.0})
    for (const std::size_t n : {std::size_t{1}, std::size_t{100}, std::size_t{10'000}}) {
      const std::vector<double> x = terms_of(n, spread, n);
      double largest = 0.0;
      for (const double v : x) largest = std::max(largest, std::abs(v));
      const double right = exact(x), bound = static_cast<double>(n) * 0x1p-62 * largest + 0x1p-53 * std::abs(right);
      INFO("spread " << spread << ", " << n << " terms");
      CHECK(std::abs(order_free_sum(x) - right) <= bound);
      const auto both = order_free_sums<2>(n, [&](std::size_t i) { return std::array{x[i], 1.0}; });
      CHECK(both[0].largest == largest);
      CHECK(both[1].sum == static_cast<double>(n));
    }
}

// long double has 64 bits: sums of multiples of 2^-60 below 8 are exact in it
TEST_CASE("an exact sum is the nearest double, ties to even", "[engine][sums]") {
  Random random(4, 4);
  for (int k = 0; k < 500; ++k) {
    ExactSum sum;
    long double right = 0.0L;
    for (int i = 0; i < 50; ++i) {
      const double x = std::ldexp(std::round(std::ldexp(random.uniform(-1.0, 1.0), 40)), -40 - i % 20);
      sum.add(x);
      right += static_cast<long double>(x);
    }
    REQUIRE(sum.value() == static_cast<double>(right));
  }
  const auto of = [](std::initializer_list<double> x) { return exact(x); };
  CHECK(of({1.0, 0x1p-53}) == 1.0);  // a tie: the even one
  CHECK(of({1.0, 0x1p-52, 0x1p-53}) == 1.0 + 0x1p-51);
  CHECK(of({1.0, 0x1p-53, tiny}) > 1.0);  // just above a tie
  CHECK(of({-1.0, -0x1p-53, -tiny}) < -1.0);
  CHECK(of({0x1p-1022, -tiny}) == 0x1p-1022 - tiny);
}

TEST_CASE("a sum without order takes the largest, the smallest and no terms", "[engine][sums]") {
  const auto sum = [](std::vector<double> x) {
    CHECK(bits_of(exact(x)) == bits_of(order_free_sum(x)));
    return order_free_sum(x);
  };
  CHECK(bits_of(sum({})) == bits_of(0.0));
  CHECK(sum({0.0, -0.0}) == 0.0);
  CHECK(sum({tiny}) == tiny);
  CHECK(sum({tiny, tiny, -tiny}) == tiny);
  CHECK(sum({huge}) == huge);
  CHECK(sum({huge, huge, -huge}) == huge);  // no partial sum overflows
  CHECK(sum({huge, huge}) == infinite);
  CHECK(sum({-huge, -huge}) == -infinite);
  CHECK(sum({1e300, 1.0, -1e300}) == 1.0);
  CHECK(sum({1e-300, 1e-300}) == 2e-300);
}

TEST_CASE("infinities and what is no number come through a sum in every order", "[engine][sums]") {
  std::vector<double> x = terms_of(3000, 20.0, 8);
  const auto with = [&](double odd, std::size_t at) {
    std::vector<double> y = x;
    y[at] = odd;
    return order_free_sum(y);
  };
  for (const std::size_t at : {std::size_t{0}, std::size_t{1029}, std::size_t{2999}}) {
    CHECK(with(infinite, at) == infinite);
    CHECK(with(-infinite, at) == -infinite);
    CHECK(std::isnan(with(std::numeric_limits<double>::quiet_NaN(), at)));
  }
  x[17] = -infinite;
  CHECK(std::isnan(with(infinite, 2000)));
  OrderFreeSum odd;
  odd.add(infinite);
  CHECK_FALSE(odd.in_range());
  CHECK(std::isnan(odd.value()));
}

// 300 bodies of widely different loads on one wall: in which slots they lie must not matter to what moves the wall
TEST_CASE("the force on a wall does not depend on the slots of the bodies that touch it", "[engine][sums]") {
  const std::size_t n = 300;
  const std::vector<double> load = terms_of(3 * n, 12.0, 2);
  const auto force_with = [&](std::size_t turn) {
    World world{Columns{.rotation = true, .force = true, .held_force = true}};
    world.add({.mass = 0.0});
    for (std::size_t i = 0; i < n; ++i) world.add({.mass = 1.0});
    ContactSet contacts;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t body = (i * 7 + turn) % n;
      contacts.append(0, static_cast<Slot>(i + 1), {.gap = -1.0, .arm = Vec3(load[body], 1.0, 0.0)});
      contacts.force.push_back({load[3 * body], load[3 * body + 1], load[3 * body + 2]});
    }
    Incidence incidence;
    incidence.build(contacts, world.size());
    gather_forces(contacts, incidence, world);
    return std::array{world.force[0], world.torque[0]};
  };
  const auto first = force_with(0);
  for (const std::size_t turn : {std::size_t{1}, std::size_t{50}, std::size_t{211}})
    for (std::size_t k = 0; k < 2; ++k) CHECK((force_with(turn)[k].array() == first[k].array()).all());
}

TEST_CASE("an outlet counts the same mass whatever the slots of the bodies are", "[engine][sums]") {
  const std::vector<double> mass = terms_of(200, 12.0, 6);
  const auto counted = [&](std::size_t turn) {
    World world;
    for (std::size_t i = 0; i < mass.size(); ++i)
      world.add({.mass = std::abs(mass[(i * 7 + turn) % mass.size()]), .inertia = Vec3::Ones()});
    Outlet outlet("out", Vec3::Constant(-1.0), Vec3::Constant(1.0));
    std::vector<BodyId> leaving;
    outlet.before_step(world, 0.1, leaving);
    CHECK(leaving.size() == mass.size());
    return outlet.tally().mass;
  };
  for (const std::size_t turn : {std::size_t{1}, std::size_t{50}}) CHECK(counted(turn) == counted(0));
}
