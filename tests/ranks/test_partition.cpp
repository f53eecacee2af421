// Cuts, plans and the numbers of all ranks.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/units/random.h"
#include "ranks/communicator.h"
#include "ranks/partition.h"
#include "ranks/plan.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

std::vector<Vec3> random_points(std::size_t n, std::uint64_t seed) {
  std::vector<Vec3> out;
  Random random(seed, 0);
  for (std::size_t k = 0; k < n; ++k)
    out.push_back(Vec3(random.uniform(-1, 3), random.uniform(0, 1), random.uniform(0, 2)));
  return out;
}

}  // namespace

TEST_CASE("points on one rank are shared out evenly, and every rank knows the owner of every point") {
  const auto all = random_points(1000, 7);
  Partition partition;
  partition.cut(rank_number() == 0 ? std::span<const Vec3>(all) : std::span<const Vec3>());
  std::vector<double> count(static_cast<std::size_t>(rank_count()), 0.0);
  double key = 0.0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const int owner = partition.owner(all[k]);
    REQUIRE(owner >= 0);
    REQUIRE(owner < rank_count());
    count[static_cast<std::size_t>(owner)] += 1.0;
    key += static_cast<double>(k) * owner;
  }
  double sum = key;
  sum_over_ranks({&sum, 1});
  CHECK(sum == key * rank_count());  // the same owners on all ranks
  CHECK(*std::ranges::max_element(count) <= 1.03 * 1000.0 / rank_count() + 1.0);
}

TEST_CASE("points that weigh more are shared out over more ranks, so that all have as much weight") {
  const auto all = random_points(2000, 13);
  std::vector<float> weights;
  double sum = 0.0;
  for (const Vec3& x : all) {
    weights.push_back(x.x() < 0.0 ? 4.0f : 0.5f);
    sum += static_cast<double>(weights.back());
  }
  Partition partition;
  if (rank_number() == 0)
    partition.cut(all, weights);
  else
    partition.cut({});
  std::vector<double> weight(static_cast<std::size_t>(rank_count()), 0.0);
  for (std::size_t k = 0; k < all.size(); ++k)
    weight[static_cast<std::size_t>(partition.owner(all[k]))] += static_cast<double>(weights[k]);
  CHECK(*std::ranges::max_element(weight) <= 1.05 * sum / rank_count() + 4.0);
}

TEST_CASE("a cube deep in a part meets that part alone") {
  const auto all = random_points(3000, 17);
  Partition partition;
  partition.cut(rank_number() == 0 ? std::span<const Vec3>(all) : std::span<const Vec3>());
  Random random(5, 2);
  int deep = 0;
  for (const Vec3& x : all) {
    const double half = random.uniform(0.0, 0.3);
    const int owner = partition.owner(x);
    std::vector<int> near;
    partition.ranks_near(x, half, near);
    for (int rank = 0; rank < rank_count(); ++rank) {
      if (!partition.is_deep(x, half, rank)) continue;
      ++deep;
      CHECK(owner == rank);
      CHECK(near == std::vector{rank});
    }
  }
  CHECK(deep > 500);  // it is no use where it says so too rarely
}

TEST_CASE("lengths that count for less are cut less; parts and cubes are where they are") {
  Random random(19, 4);
  for (int draw = 0; draw < 6; ++draw) {
    const auto all = random_points(800, static_cast<std::uint64_t>(30 + draw));
    Vec3 scale = Vec3::Ones();
    const int flat = draw % 3;
    scale[flat] = random.uniform(1e-4, 1e-3);  // of at most three cuts none is along it
    Partition partition;
    partition.cut(rank_number() == 0 ? std::span<const Vec3>(all) : std::span<const Vec3>(), {}, scale);
    CHECK(partition.cut_axes()[flat] == 0.0);
    CHECK((partition.cut_axes().sum() > 0.0) == (rank_count() > 1));
    std::vector<int> near;
    for (const Vec3& x : all) {
      const double half = random.uniform(0.0, 0.3);
      const int owner = partition.owner(x);
      near.clear();
      partition.ranks_near(x, half, near);
      CHECK(std::ranges::find(near, owner) != near.end());
      if (partition.is_deep(x, half, owner)) CHECK(near == std::vector{owner});
      const Vec3 aside = x + random.uniform(-50, 50) * Vec3(Vec3::Unit(flat));  // no way along it leads elsewhere
      CHECK(partition.owner(aside) == owner);
    }
  }
}

TEST_CASE("a box meets the parts of all points in it, far outside too") {
  const auto all = random_points(500, 11);
  Partition partition;
  std::vector<Vec3> mine;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (static_cast<int>(k) % rank_count() == rank_number()) mine.push_back(all[k]);
  partition.cut(mine);
  Random random(3, 1);
  std::vector<int> ranks;
  for (int trial = 0; trial < 300; ++trial) {
    const double half = random.uniform(0.01, 0.5), far = trial % 10 == 0 ? 100.0 : 1.0;
    const Vec3 centre = far * all[static_cast<std::size_t>(trial)];
    ranks.clear();
    partition.ranks_near(centre, half, ranks);
    for (int k = 0; k < 20; ++k) {
      const Vec3 inside = centre + half * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      CHECK(std::ranges::find(ranks, partition.owner(inside)) != ranks.end());
    }
  }
}

TEST_CASE("a partition without points, and with fewer points than ranks, still owns all space") {
  for (const std::size_t n : {0u, 1u, 2u}) {
    const auto few = random_points(n, 5);
    Partition partition;
    partition.cut(rank_number() == 0 ? std::span<const Vec3>(few) : std::span<const Vec3>());
    std::vector<int> ranks;
    for (const Vec3& x : random_points(20, 9)) {
      const int owner = partition.owner(x);
      CHECK(owner >= 0);
      CHECK(owner < rank_count());
      ranks.clear();
      partition.ranks_near(x, 0.1, ranks);
      CHECK(std::ranges::find(ranks, owner) != ranks.end());
    }
  }
}

TEST_CASE("a plan brings rows of any size to their ranks, the same way each time") {
  const int size = rank_count(), me = rank_number();
  std::vector<int> to;
  for (int k = 0; k < 3 * size + me; ++k) to.push_back((k * 7 + me) % size);  // in no order
  Plan plan(to);
  for (const std::size_t words : {1u, 3u, 40u}) {
    RowBytes rows(to.size() * words * 4), arrived;
    for (std::size_t k = 0; k < to.size(); ++k)
      for (std::size_t w = 0; w < words; ++w) {
        const auto x = static_cast<std::uint32_t>(1000 * static_cast<std::size_t>(me) + 10 * k + w);
        std::memcpy(rows.data() + (k * words + w) * 4, &x, 4);
      }
    plan.run(rows, words * 4, arrived);
    REQUIRE(arrived.size() == plan.received() * words * 4);
    double sum = static_cast<double>(plan.received());
    sum_over_ranks({&sum, 1});
    double all = static_cast<double>(to.size());
    sum_over_ranks({&all, 1});
    CHECK(sum == all);
    for (std::size_t k = 0; k < plan.received(); ++k) {
      std::uint32_t first = 0;
      std::memcpy(&first, arrived.data() + k * words * 4, 4);
      const int from = static_cast<int>(first / 1000), row = static_cast<int>(first % 1000) / 10;
      CHECK((row * 7 + from) % size == me);
    }
  }
}
