#include "detection/broad/all_broad_phases.h"

#include <algorithm>
#include <cstdio>

#include "detection/broad/aabb_tree.h"
#include "detection/broad/all_pairs.h"
#include "detection/broad/spatial_hash.h"
#include "detection/broad/sweep_and_prune.h"

namespace epafi {

namespace {
template <class T>
std::unique_ptr<BroadPhase> make(const BroadSetup& setup) {
  return std::make_unique<T>(setup);
}

constexpr std::size_t few = 48;  // bodies below which testing all pairs is fastest (perf/broad.cpp)
}  // namespace

const std::vector<BroadPhaseEntry>& all_broad_phases() {
  static const std::vector<BroadPhaseEntry> list{
      {{"spatial-hash", "bodies sorted into cells, one grid per size class", {}, {}, "Ericson 2005"},
       make<SpatialHash>},
      {{"aabb-tree", "tree of boxes, refitted and rebuilt when degraded", {}, {}, "van den Bergen 1997"},
       make<AabbTree>},
      {{"sweep-and-prune", "intervals sorted along one axis", {}, {}, "Cohen et al. 1995"}, make<SweepAndPrune>},
      {{"all-pairs", "every pair tested: the reference", {}, {}, ""}, make<AllPairs>},
  };
  return list;
}

BroadChoice choose_broad_phase(const World& world, const BroadSetup& setup) {
  const auto radius = [&](std::size_t s) { return setup.shapes->bounding_radius({world.shape[s]}); };
  const double largest = largest_ordinary(world.size(), median_radius(world, *setup.shapes), radius);
  std::size_t n = 0, apart = 0;
  double least = infinity, most = 0.0;
  for (std::size_t s = 0; s < world.size(); ++s) {
    const double r = radius(s);
    if (r <= largest) {
      ++n;
      least = std::min(least, r);
      most = std::max(most, r);
    } else
      ++apart;
  }
  const std::string count = std::to_string(n);
  if (n < few) return {"all-pairs", count + " bounded bodies: below " + std::to_string(few) + " no structure pays"};
  char ratio[32];
  std::snprintf(ratio, sizeof ratio, "%.3g", least > 0.0 ? most / least : infinity);
  return {"spatial-hash", count + " bodies, sizes 1:" + ratio + ": one grid per factor of two in size; " +
                              std::to_string(apart) + " unbounded or giant bodies tested one by one"};
}

std::unique_ptr<BroadPhase> make_broad_phase(std::string_view name, const BroadSetup& setup, const World& world) {
  const std::string wanted = name == "auto" ? choose_broad_phase(world, setup).name : std::string(name);
  for (const auto& e : all_broad_phases())
    if (e.entry.name == wanted) return e.make(setup);
  return nullptr;
}

}  // namespace epafi
