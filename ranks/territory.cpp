#include "ranks/territory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ranks/communicator.h"

namespace epafi {

Territory::Territory(PartSetup setup) : setup_(std::move(setup)) {
  for (const auto& [a, b] : setup_.tied) {
    tied_.emplace_back(a, b);
    tied_.emplace_back(b, a);
  }
  std::ranges::sort(tied_);
}

void Territory::measure(const World& world, const Owners& owner) {
  double sums[2] = {0.0, 0.0}, largest = 0.0;
  for (std::size_t s = 0; s < owner.size(); ++s) {
    if (owner[s] != World::here) continue;
    const double r = setup_.radius(world.shape[s]);
    sums[0] += r;
    sums[1] += 1.0;
    largest = std::max(largest, r);
  }
  sum_over_ranks(sums);
  max_over_ranks({&largest, 1});
  largest_ = largest;
  usual_margin_ = sums[1] > 0.0 ? 0.5 * sums[0] / sums[1] : std::numeric_limits<double>::infinity();
  margin_ = usual_margin_;
}

namespace {
constexpr double enough = 0.05;  // s of a rank: a hundred times the tick of its clock
constexpr double least = 0.2, most = 5.0;

/// Weight of a rank's bodies: time per body over that of all n bodies, which took `time`.
double weight_of(double worked, double bodies, double time, double n) {
  return bodies > 0.0 ? std::clamp(worked / bodies * n / time, least, most) : 1.0;
}
}  // namespace

/// Rank that owns a position; likely: guess, right where the position is deep inside that part.
int Territory::owner(const Vec3& x, double half, int likely) const {
  return partition_.is_deep(x, half, likely) ? likely : partition_.owner(x);
}

/// Weights of free bodies: time per body of its rank (by the old cuts) over the mean one; empty where too little has
/// been measured.
std::vector<float> Territory::weights(const std::vector<Vec3>& places, const std::vector<double>& worked) const {
  const double time = std::accumulate(worked.begin(), worked.end(), 0.0);
  if (places.empty() || !(time > enough * static_cast<double>(worked.size()))) return {};
  std::vector<double> bodies(worked.size(), 0.0);
  std::vector<std::size_t> rank_of;
  int rank = 0;
  for (const Vec3& x : places) {
    rank = owner(x, 0.0, rank);
    rank_of.push_back(static_cast<std::size_t>(rank));
    bodies[rank_of.back()] += 1.0;
  }
  const auto n = static_cast<double>(places.size());
  std::vector<float> out;
  for (const std::size_t r : rank_of) out.push_back(static_cast<float>(weight_of(worked[r], bodies[r], time, n)));
  return out;
}

/// A wider margin m makes more ghosts in every step, in proportion to m, and moves less frequent, once in m/longest
/// steps. The cost a ghosts/R 2 m + b bodies longest/m has its minimum at the root below.
void Territory::suit(double longest, double bodies, double ghosts) {
  constexpr double b_over_2a = 10.0;  // a: 60 ns of a ghost in a step, with its message; b: 1.2 us of a body in a move
  constexpr double widest = 8.0;      // of the usual one
  const double ghosts_reach = reach() + 2.0 * margin_;
  const double best = ghosts > 0.0 ? std::sqrt(b_over_2a * bodies / ghosts * ghosts_reach * longest)
                                   : std::numeric_limits<double>::infinity();
  margin_ = std::max({usual_margin_, 2.0 * longest, std::min(best, widest * usual_margin_)});
}

namespace {
std::vector<Vec3> places_of(const World& world, const Owners& owner) {
  std::vector<Vec3> places;
  for (Slot s = 0; s < owner.size(); ++s)
    if (owner[s] == World::here) places.push_back(world.position[s]);
  return places;
}
}  // namespace

void Territory::cut(const World& world, const Owners& owner, double worked) {
  measure(world, owner);
  const std::vector<double> all = gather_numbers(worked);
  const std::vector<Vec3> places = places_of(world, owner);
  partition_.cut(places, weights(places, all));
}

bool Territory::cut_if_uneven(const World& world, const Owners& owner, double worked) {
  constexpr double uneven = 1.1;  // new cuts take the time of ten steps
  const std::vector<Vec3> places = places_of(world, owner);
  const auto mine = static_cast<double>(places.size());
  double sums[2] = {worked, mine}, longest = worked;
  sum_over_ranks(sums);
  max_over_ranks({&longest, 1});
  const double ranks = rank_count();
  if (!(sums[0] > enough * ranks) || !(longest * ranks > uneven * sums[0])) return false;
  partition_.cut(places,
                 std::vector<float>(places.size(), static_cast<float>(weight_of(worked, mine, sums[0], sums[1]))));
  return true;
}

namespace {

/// Shifts to the images of a body, and 0 for the body itself [m].
std::vector<Vec3> shifts_of(const std::optional<PeriodicCell>& cell) {
  std::vector<Vec3> shifts{Vec3::Zero()};
  for (int k = 0; cell && k < 3; ++k)
    for (std::size_t i = shifts.size(); cell->repeats[static_cast<std::size_t>(k)] && i-- > 0;)
      for (const double side : {-1.0, 1.0}) shifts.push_back(shifts[i] + side * cell->size[k] * Vec3::Unit(k));
  return shifts;
}

}  // namespace

/// Adds the ranks of bodies tied to s. A rank has all bodies that its own are tied to, and so knows their positions.
void Territory::add_ranks_of_tied(const World& world, const Owners& owner, Slot s, std::vector<int>& ranks) const {
  const auto [first, last] = std::ranges::equal_range(tied_, world.id[s], {}, &std::pair<BodyId, BodyId>::first);
  for (auto at = first; at != last; ++at)
    if (const Slot other = world.slot_of(at->second); other != no_slot && owner[other] != World::everywhere)
      ranks.push_back(partition_.owner(world.position[other]));
}

Routes Territory::routes(const World& world, const Owners& owner, const std::vector<std::uint32_t>& place,
                         const std::vector<int>& held) const {
  Routes r;
  r.place = place;
  r.to_all = held;
  std::vector<int> ranks;
  const std::vector<Vec3> shifts = shifts_of(world.cell);
  int likely = rank_number();
  for (Slot s = 0; s < owner.size(); ++s) {
    const bool is_held = owner[s] == World::everywhere;
    r.begin.push_back(static_cast<std::uint32_t>(r.to.size()));
    r.mine.push_back(owner[s] != World::elsewhere);
    const double reach = (1.0 + 1e-9) * (setup_.radius(world.shape[s]) + (2 * setup_.rings - 1) * largest_ +
                                         setup_.rings * setup_.reach + 2.0 * margin_);
    const bool is_deep = !is_held && partition_.is_deep(world.position[s], reach, likely);
    if (!is_held && !is_deep) likely = partition_.owner(world.position[s]);
    r.owner.push_back(is_held ? Routes::all_ranks : likely);
    if (is_held) r.to.insert(r.to.end(), held.begin(), held.end());
    if (owner[s] != World::here) continue;
    ranks = {likely};
    if (!is_deep || shifts.size() > 1)
      for (const Vec3& shift : shifts) partition_.ranks_near(world.position[s] + shift, reach, ranks);
    if (!tied_.empty()) add_ranks_of_tied(world, owner, s, ranks);
    std::ranges::sort(ranks);
    ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
    r.to.insert(r.to.end(), ranks.begin(), ranks.end());
  }
  r.begin.push_back(static_cast<std::uint32_t>(r.to.size()));
  return r;
}

Routes routes_home(const World& world, const std::vector<std::uint32_t>& place) {
  Routes r;
  r.place = place;
  r.gathers = true;
  if (rank_number() == 0) r.to_all = {0};
  for (Slot s = 0; s < world.size(); ++s) {
    const bool held = world.owner[s] == World::everywhere;
    r.owner.push_back(held ? Routes::all_ranks : 0);
    r.mine.push_back(held ? rank_number() == 0 : world.owner[s] == World::here);
    r.begin.push_back(s);
    r.to.push_back(0);
  }
  r.begin.push_back(static_cast<std::uint32_t>(world.size()));
  return r;
}

std::vector<int> all_ranks() {
  std::vector<int> all(static_cast<std::size_t>(rank_count()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Owners owners_of_whole(const World& world) {
  Owners owner;
  for (Slot s = 0; s < world.size(); ++s) owner.push_back(world.is_movable(s) ? World::here : World::everywhere);
  return owner;
}

Owners owners_of(const Arrival& arrival) {
  Owners owner;
  for (const int rank : arrival.owner)
    owner.push_back(rank == Routes::all_ranks ? World::everywhere
                    : rank == rank_number()   ? World::here
                                              : World::elsewhere);
  return owner;
}

}  // namespace epafi
