#include "ranks/detection_part.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "ranks/common_columns.h"
#include "ranks/communicator.h"
#include "ranks/rows.h"

namespace epafi {

namespace {

/// Calls f(column) for all columns of a moving body that detection reads.
template <class W, class F>
void each_seen(W& world, const F& f) {
  f(world.position);
  f(world.velocity);
  if (world.columns().periodic) f(world.wraps);
  if (!world.rotates()) return;
  f(world.angular_velocity);
  if (world.columns().orientation) f(world.orientation);
}

std::size_t seen_bytes(World& world) {
  std::size_t bytes = 0;
  each_seen(world, [&](auto& column) { bytes += sizeof(column[0]); });
  return bytes;
}

/// State from which lists predict the motion of bodies.
struct Moment {
  double time, clock;
  double gravity[3], fallen[3];
};

/// A contact; slots are those of the whole simulation.
struct FoundRow {
  Slot a, b;
  Feature feature;
  double gap, radius, area;
  double normal[3], arm[3];
};

FoundRow found_row(const ContactSet& c, std::size_t k, const std::vector<std::uint32_t>& place) {
  FoundRow row{place[c.a[k]],
               place[c.b[k]],
               c.feature[k],
               c.gap[k],
               c.with_curvature ? c.effective_radius[k] : 0.0,
               c.with_area ? c.area[k] : 0.0,
               {},
               {}};
  std::copy_n(c.normal[k].data(), 3, row.normal);
  std::copy_n(c.arm[k].data(), 3, row.arm);
  return row;
}

ContactPoint point_of(const FoundRow& row) {
  return {row.gap,
          Vec3(row.normal[0], row.normal[1], row.normal[2]),
          Vec3(row.arm[0], row.arm[1], row.arm[2]),
          row.radius,
          row.feature,
          row.area};
}

constexpr double searches_apart =
    5.0;  // a margin is for twice as many searches, where one body is fast beside the others
constexpr std::size_t few_bodies =
    1000;                            // may all be ghosts: sending them anew takes longer than finding their contacts
constexpr double most_margin = 4.0;  // of the usual one, or everybody is a ghost

StateWalk walk_of(World& world, NarrowPhase& narrow_phase) {
  return [&](StateVisitor& visitor) {
    narrow_phase.visit(visitor);
    world.visit(visitor);
  };
}

}  // namespace

void DetectionPart::receive(World* whole, NarrowPhase* memory, double longest) {
  RankTimer timer(figures_);
  World& world = sim_.world;
  StateImage image = image_of(walk_of(whole ? *whole : world, whole ? *memory : *sim_.pipeline.narrow_phase));
  if (!whole) drop_rows(image);
  take_common(image);
  const Owners owner = whole ? owners_of_whole(*whole) : Owners();
  place_.resize(owner.size());
  std::iota(place_.begin(), place_.end(), 0u);
  territory_.cut(whole ? *whole : world, owner, work_.take());
  const bool are_few = owner.size() < few_bodies;
  territory_.widen(searches_apart * longest, are_few ? std::numeric_limits<double>::infinity() : most_margin);
  Routes routes = territory_.routes(whole ? *whole : world, owner, place_, all_ranks());
  routes.to_one = true;
  from_.clear();
  for (Slot s = 0; s < owner.size(); ++s) from_.insert(from_.end(), routes.begin[s + 1] - routes.begin[s], s);
  const Arrival arrival = exchange_rows(image, routes);
  bodies_ = Plan(routes.to);
  forget_slots(sim_);
  restore(image, walk_of(world, *sim_.pipeline.narrow_phase));
  place_ = arrival.place;
  world.owner = owners_of(arrival);
  own_ = static_cast<double>(std::ranges::count(world.owner, std::uint8_t{World::here}));
  listed_ = false;
  figures_.bytes += arrival.bytes;
  figures_.moved += 1.0;
  EPAFI_REQUIRE(bodies_.received() == world.size(), "rank 0 knows which bodies each rank has");
  timer.lap(RankStage::sharing);
}

void DetectionPart::give(NarrowPhase* memory) {
  RankTimer timer(figures_);
  NarrowPhase& mine = *sim_.pipeline.narrow_phase;
  StateImage image = image_of([&](StateVisitor& visitor) { mine.visit(visitor); });
  figures_.bytes += exchange_rows(image, routes_home(sim_.world, place_)).bytes;
  if (memory) restore(image, [&](StateVisitor& visitor) { memory->visit(visitor); });
  timer.lap(RankStage::sharing);
}

void DetectionPart::spread(const World* whole) {
  World& world = sim_.world;
  Moment now{};
  if (whole) {
    now = {whole->time, whole->clock, {}, {}};
    std::copy_n(whole->gravity.data(), 3, now.gravity);
    std::copy_n(whole->fallen.data(), 3, now.fallen);
  }
  broadcast(&now, sizeof now);
  world.time = now.time;
  world.clock = now.clock;
  std::copy_n(now.gravity, 3, world.gravity.data());
  std::copy_n(now.fallen, 3, world.fallen.data());
  const std::size_t row = seen_bytes(world);
  out_.resize(from_.size() * row);
  parallel_for(from_.size(), [&](std::size_t k) {
    std::byte* to = out_.data() + k * row;
    each_seen(*whole, [&](const auto& column) {
      std::memcpy(to, static_cast<const void*>(&column[from_[k]]), sizeof(column[0]));
      to += sizeof(column[0]);
    });
  });
  bodies_.run(out_, row, in_);
  figures_.bytes += static_cast<double>(out_.size());
  parallel_for(world.size(), [&](std::size_t s) {
    const std::byte* from = in_.data() + s * row;
    each_seen(world, [&](auto& column) {
      std::memcpy(static_cast<void*>(&column[s]), from, sizeof(column[0]));
      from += sizeof(column[0]);
    });
  });
}

const PairList& DetectionPart::list_pairs() {
  sim_.pipeline.broad_phase->find_pairs(sim_.world, sim_.work.pairs);
  const PairList& all = sim_.work.pairs;
  if (!listed_ || pairs_.generation != all.generation) {
    pairs_.pairs.clear();
    for (const Pair& p : all.pairs)
      if (tells_of(sim_.world, p.a, p.b)) pairs_.pairs.push_back(p);
    pairs_.generation = all.generation;
    listed_ = true;
  }
  pairs_.margin = all.margin;
  pairs_.inverse_half_margin = all.inverse_half_margin;
  return pairs_;
}

void DetectionPart::find(const World* whole, ContactSet* contacts) {
  RankTimer timer(figures_);
  spread(whole);
  timer.lap(RankStage::exchange);
  work_.begin();
  const PairList& pairs = list_pairs();
  timer.lap(RankStage::broad_phase);
  sim_.pipeline.narrow_phase->collide(sim_.world, pairs, sim_.work.contacts);
  timer.lap(RankStage::narrow_phase);
  work_.end();
  gather(contacts);
  timer.lap(RankStage::exchange);
  figures_.steps += 1.0;
  figures_.own += own_;
  figures_.ghosts += static_cast<double>(std::ranges::count(sim_.world.owner, std::uint8_t{World::elsewhere}));
}

void DetectionPart::gather(ContactSet* contacts) {
  const ContactSet& mine = sim_.work.contacts;
  out_.resize(mine.size() * sizeof(FoundRow));
  parallel_for(mine.size(), [&](std::size_t k) {
    const FoundRow row = found_row(mine, k, place_);
    std::memcpy(out_.data() + k * sizeof row, &row, sizeof row);
  });
  gather_rows(out_, sizeof(FoundRow), in_);
  figures_.bytes += static_cast<double>(out_.size());
  if (!contacts) return;
  const std::size_t n = in_.size() / sizeof(FoundRow);
  contacts->with_curvature = mine.with_curvature;
  contacts->with_area = mine.with_area;
  contacts->renew(n);
  const Vec3 none = Vec3::Zero();
  parallel_for(n, [&](std::size_t k) {
    const auto row = row_at<FoundRow>(in_, k);
    contacts->put(k, row.a, row.b, point_of(row), none, none);
  });
  contacts->sort();
  contacts->force.clear();
  contacts->moment.clear();
}

}  // namespace epafi
