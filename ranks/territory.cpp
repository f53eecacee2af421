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
constexpr double enough = 0.05;  // s of a rank, so that chance decides little
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
  constexpr double a = 6e-8;      // s of a ghost in a step, with its message
  constexpr double widest = 8.0;  // of the usual one
  const double ghosts_reach = reach() + 2.0 * margin_;
  const double best = ghosts > 0.0 ? std::sqrt(time_of_move / (2.0 * a) * bodies / ghosts * ghosts_reach * longest)
                                   : std::numeric_limits<double>::infinity();
  margin_ = std::max({usual_margin_, 2.0 * longest, std::min(best, widest * usual_margin_)});
}

namespace {
constexpr std::size_t sample = 8192;  // bodies a rank that decide where cuts are: for all of 100 000 Zoltan takes 20 ms

/// Of this rank's bodies, in the order of space, so many of all; one in so many.
std::vector<Vec3> places_of(const World& world, const Owners& owner, double bodies) {
  const auto each = static_cast<std::size_t>(bodies) / (sample * static_cast<std::size_t>(rank_count())) + 1;
  std::vector<Vec3> places;
  std::size_t k = 0;
  for (Slot s = 0; s < owner.size(); ++s)
    if (owner[s] == World::here && k++ % each == 0) places.push_back(world.position[s]);
  return places;
}
}  // namespace

namespace {
/// What lies is unlike what falls on it: ranks one above the other have lists and contacts at unlike times, and each
/// waits for the others. They stand side by side unless that makes many more ghosts.
Vec3 scale_of(const World& world, const Owners& owner) {
  constexpr double height = 0.2;  // counts as so much of a width
  Vec3 scale = Vec3::Ones(), gravity = Vec3::Zero();
  if (!owner.empty()) gravity = world.gravity.cwiseAbs();  // who has no bodies may know that of an earlier time
  max_over_ranks({gravity.data(), 3});
  int down = 0;
  if (gravity.maxCoeff(&down) > 0.0) scale[down] = height;
  return scale;
}
}  // namespace

void Territory::cut(const World& world, const Owners& owner, double worked) {
  measure(world, owner);
  const std::vector<double> all = gather_numbers(worked);
  const std::vector<Vec3> places = places_of(world, owner, static_cast<double>(owner.size()));
  partition_.cut(places, weights(places, all), scale_of(world, owner));
}

bool Territory::is_uneven(double longest, double time, double bodies) {
  const double ranks = rank_count();
  return time > enough * ranks && longest * ranks - time > time_of_move * bodies;
}

void Territory::cut_by_owners(const World& world, const Owners& owner, double worked, double time, double bodies) {
  const std::vector<Vec3> places = places_of(world, owner, bodies);
  const double weight = weight_of(worked, static_cast<double>(std::ranges::count(owner, World::here)), time, bodies);
  partition_.cut(places, std::vector<float>(places.size(), static_cast<float>(weight)), scale_of(world, owner));
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
