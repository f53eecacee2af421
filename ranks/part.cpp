#include "ranks/part.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <numeric>

#include "engine/parallel.h"
#include "ranks/communicator.h"

namespace epafi {

namespace {

/// The part of a simulation's state that every step needs; counters, ledger and observers are with the whole.
StateWalk walk_of(Simulation& sim) {
  return [&sim](StateVisitor& visitor) {
    sim.pipeline.each_stage([&](auto& stage) { stage.visit(visitor); });
    sim.world.visit(visitor);
    for (auto& event : sim.events)
      if (event->is_local()) event->visit(visitor);
  };
}

/// What is nobody's is that of rank 0 everywhere; of shared sums rank 0 has all.
void take_common(StateImage& image) {
  for (ImageColumn& c : image) {
    const bool rows = c.whose != RowsOf::nobody && c.whose != RowsOf::ids && c.whose != RowsOf::share;
    if (rows) continue;
    std::uint64_t bytes = c.data.size();
    broadcast(&bytes, sizeof bytes);
    c.data.resize(bytes);
    broadcast(c.data.data(), c.data.size());
    if (c.whose == RowsOf::share && c.row == sizeof(double) && rank_number() != 0)
      std::fill(c.data.begin(), c.data.end(), std::byte{});
  }
}

/// Shared sums, at rank 0 and everywhere else.
void sum_shares(StateImage& image) {
  for (ImageColumn& c : image) {
    if (c.whose != RowsOf::share) continue;
    double x = c.data[0] == std::byte{} ? 0.0 : 1.0;
    if (c.row == sizeof x) std::memcpy(&x, c.data.data(), sizeof x);
    sum_over_ranks({&x, 1});
    if (c.row == sizeof x)
      std::memcpy(c.data.data(), &x, sizeof x);
    else
      c.data[0] = std::byte{x != 0.0};
  }
}

void drop_rows(StateImage& image) {
  for (ImageColumn& c : image)
    if (c.whose != RowsOf::nobody && c.whose != RowsOf::share && c.whose != RowsOf::ids) c.data.clear();
}

/// What detection keeps by slot is void; what contact models keep comes in with the state.
void forget_slots(Simulation& sim) {
  const Reordering gone{std::vector<Slot>(sim.world.size(), no_slot)};
  sim.pipeline.broad_phase->reorder(gone);
  sim.pipeline.narrow_phase->reorder(gone);
  sim.work.contacts.clear();
}

struct ContactRow {
  std::uint32_t a, b;  ///< ids
  Feature feature;
  double gap, radius, area;
  double normal[3], arm[3], force[3], moment[3];
};

ContactRow row_of(const ContactSet& c, std::size_t k, const World& world) {
  ContactRow row{static_cast<std::uint32_t>(world.id[c.a[k]]),
                 static_cast<std::uint32_t>(world.id[c.b[k]]),
                 c.feature[k],
                 c.gap[k],
                 c.effective_radius.empty() ? 0.0 : c.effective_radius[k],
                 c.area.empty() ? 0.0 : c.area[k],
                 {},
                 {},
                 {},
                 {}};
  const auto copy = [k](const std::vector<Vec3>& from, double* to) {
    if (k < from.size()) std::copy_n(from[k].data(), 3, to);
  };
  copy(c.normal, row.normal);
  copy(c.arm, row.arm);
  copy(c.force, row.force);
  copy(c.moment, row.moment);
  return row;
}

void put_row(ContactSet& set, std::size_t k, const ContactRow& row, const World& world) {
  const auto vector = [](const double* x) { return Vec3(x[0], x[1], x[2]); };
  const ContactPoint point{row.gap, vector(row.normal), vector(row.arm), row.radius, row.feature, row.area};
  set.put(k, world.slot_of(static_cast<BodyId>(row.a)), world.slot_of(static_cast<BodyId>(row.b)), point,
          vector(row.force), vector(row.moment));
}

}  // namespace

/// Sizes of the free bodies decide how far ghosts reach.
void Part::measure_bodies(const World& world, const Owners& owner) {
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
}

/// By the present cuts: who owns the bodies that are here, and who else may touch them. Held ones go to `held`.
Routes Part::routes(const World& world, const Owners& owner, const std::vector<int>& held) const {
  Routes r;
  r.to_all = held;
  std::vector<int> ranks;
  for (Slot s = 0; s < owner.size(); ++s) {
    const bool is_held = owner[s] == World::everywhere;
    r.place.push_back(place_[s]);
    r.begin.push_back(static_cast<std::uint32_t>(r.to.size()));
    r.mine.push_back(owner[s] != World::elsewhere);
    r.owner.push_back(is_held ? Routes::all_ranks : partition_.owner(world.position[s]));
    if (is_held) r.to.insert(r.to.end(), held.begin(), held.end());
    if (owner[s] != World::here) continue;
    const double reach = setup_.radius(world.shape[s]) + largest_ + setup_.reach + 2.0 * margin_;
    partition_.ranks_near(world.position[s], (1.0 + 1e-9) * reach, ranks);
    if (std::ranges::find(ranks, r.owner.back()) == ranks.end()) ranks.push_back(r.owner.back());
    r.to.insert(r.to.end(), ranks.begin(), ranks.end());
  }
  r.begin.push_back(static_cast<std::uint32_t>(r.to.size()));
  return r;
}

/// The rows that have come are the state; their owners tell each other.
void Part::settle(StateImage& image, const Arrival& arrival) {
  forget_slots(sim_);
  restore(image, walk_of(sim_));
  World& world = sim_.world;
  place_ = arrival.place;
  world.owner.resize(world.size());
  for (std::size_t s = 0; s < world.size(); ++s)
    world.owner[s] = arrival.owner[s] == Routes::all_ranks ? World::everywhere
                     : arrival.owner[s] == rank_number()   ? World::here
                                                           : World::elsewhere;
  start_.resize(world.size());
  for (std::size_t s = 0; s < world.size(); ++s) start_[s] = world.position[s];
  figures_.bytes += arrival.bytes;
  const Routes now = routes(world, world.owner, {});
  std::vector<Slot> slots;
  std::vector<int> ranks;
  for (Slot s = 0; s < world.size(); ++s)
    for (std::uint32_t k = now.begin[s]; world.owner[s] == World::here && k < now.begin[s + 1]; ++k)
      if (now.to[k] != rank_number()) {
        slots.push_back(s);
        ranks.push_back(now.to[k]);
      }
  halo_.set_up(world, std::move(slots), std::move(ranks), place_);
}

void Part::receive(Simulation* whole) {
  StateImage image = image_of(walk_of(whole ? *whole : sim_));
  if (!whole) drop_rows(image);
  take_common(image);
  const World& world = whole ? whole->world : sim_.world;
  Owners owner;  // rank 0 has all bodies until they are shared out, the others none
  std::vector<Vec3> free;
  place_.clear();
  for (Slot s = 0; whole && s < world.size(); ++s) {
    place_.push_back(s);
    owner.push_back(world.is_movable(s) ? World::here : World::everywhere);
    if (world.is_movable(s)) free.push_back(world.position[s]);
  }
  measure_bodies(world, owner);
  margin_ = usual_margin_;
  partition_.cut(free);
  std::vector<int> all(static_cast<std::size_t>(rank_count()));
  std::iota(all.begin(), all.end(), 0);
  const Arrival arrival = exchange_rows(image, routes(world, owner, all));
  settle(image, arrival);
}

/// Bodies go to the ranks in whose parts they are now; longest: way of a body in the next step [m].
void Part::move(double longest) {
  margin_ = std::max(usual_margin_, 2.0 * longest);
  StateImage image = image_of(walk_of(sim_));
  const Arrival arrival = exchange_rows(image, routes(sim_.world, sim_.world.owner, {rank_number()}));
  settle(image, arrival);
  figures_.moved += 1.0;
}

void Part::give(Simulation* whole) {
  sim_.pipeline.contact_model->publish(sim_.world, sim_.work.contacts);  // springs leave their contacts below
  StateImage image = image_of(walk_of(sim_));
  sum_shares(image);
  const World& world = sim_.world;
  Routes r;
  r.place = place_;
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
  exchange_rows(image, r);
  if (whole) restore(image, walk_of(*whole));
}

void Part::give_contacts(Simulation* whole) {
  const World& world = sim_.world;
  ContactSet& set = sim_.work.contacts;
  sim_.pipeline.contact_model->publish(world, set);
  std::vector<std::byte> rows, arrived;
  for (std::size_t k = 0; k < set.size(); ++k) {
    const bool held = world.owner[set.a[k]] == World::everywhere && world.owner[set.b[k]] == World::everywhere;
    if (held ? rank_number() != 0 : !world.counts(set.a[k], set.b[k])) continue;
    const ContactRow row = row_of(set, k, world);
    rows.resize(rows.size() + sizeof row);
    std::memcpy(rows.data() + rows.size() - sizeof row, &row, sizeof row);
  }
  const Plan plan(std::vector<int>(rows.size() / sizeof(ContactRow), 0));
  plan.run(rows, sizeof(ContactRow), arrived);
  figures_.bytes += static_cast<double>(rows.size());
  if (!whole) return;
  ContactSet& all = whole->work.contacts;
  all.with_moment = set.with_moment;
  all.renew(plan.received());
  for (std::size_t k = 0; k < plan.received(); ++k) {
    ContactRow row;
    std::memcpy(&row, arrived.data() + k * sizeof row, sizeof row);
    put_row(all, k, row, whole->world);
  }
  all.sort();
}

/// From where bodies were placed to where they may be after the next step, and the step alone [m].
double Part::longest_way(double dt) const {
  const World& world = sim_.world;
  return block_max<double>(world.size(), 0.0, [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    if (world.owner[s] != World::here) return 0.0;
    return dt * (world.velocity[s].norm() + dt * world.acceleration(s).norm());
  });
}

bool Part::step(double dt, const std::optional<Domain>& domain, StepReport& report) {
  World& world = sim_.world;
  const double gone = block_max<double>(world.size(), 0.0, [&](std::size_t s) {
    return world.owner[s] == World::here ? (world.position[s] - start_[s]).squaredNorm() : 0.0;
  });
  double ways[2] = {longest_way(dt), std::sqrt(gone)};
  ways[1] += ways[0];
  max_over_ranks(ways);
  if (!(ways[1] < margin_)) move(ways[0]);
  std::vector<BodyId> none;
  for (auto& event : sim_.events)
    if (event->is_local()) event->before_step(world, dt, none);
  epafi::step(world, sim_.pipeline, sim_.work, dt);
  note_overlaps();
  halo_.refresh(world);
  figures_.steps += 1.0;
  figures_.ghosts += static_cast<double>(halo_.ghosts());
  figures_.own += static_cast<double>(std::ranges::count(world.owner, std::uint8_t{World::here}));
  bool sound = is_sound(domain);
  for (const Stage stage : {Stage::integrate, Stage::broad_phase, Stage::narrow_phase, Stage::contact})
    report.seconds[stage] = sim_.work.report.seconds[stage];
  sum_up(report, sound);
  return sound;
}

/// Those of contacts that the model has not found itself.
void Part::note_overlaps() {
  const ContactSet& c = sim_.work.contacts;
  const World& world = sim_.world;
  StepReport& report = sim_.work.report;
  report.deepest = block_max<double>(c.size(), report.deepest, [&](std::size_t k) { return -c.gap[k]; });
  report.deepest_relative = block_max<double>(c.size(), report.deepest_relative, [&](std::size_t k) {
    if (!(c.gap[k] < 0.0)) return 0.0;
    return -c.gap[k] / std::min(setup_.radius(world.shape[c.a[k]]), setup_.radius(world.shape[c.b[k]]));
  });
}

/// Of the bodies that this rank owns.
bool Part::is_sound(const std::optional<Domain>& domain) const {
  const Extent* seen = sim_.pipeline.contact_model->extent();
  if (seen && seen->is_inside(domain)) return true;
  const auto strays = find_strays(sim_.world, domain);
  return std::ranges::none_of(strays, [&](Slot s) { return sim_.world.owner[s] == World::here; });
}

void Part::sum_up(StepReport& report, bool& sound) {
  const StepReport& mine = sim_.work.report;
  std::array<double, 11> sums{static_cast<double>(mine.pairs),
                              static_cast<double>(mine.contacts),
                              static_cast<double>(mine.touching),
                              mine.elastic,
                              mine.dissipated,
                              mine.work,
                              mine.losses.viscous,
                              mine.losses.frictional,
                              mine.losses.plastic,
                              mine.losses.adhesive,
                              sound ? 0.0 : 1.0};
  std::array<double, 2> largest{mine.deepest, mine.deepest_relative};
  sum_over_ranks(sums);
  max_over_ranks(largest);
  report.pairs = static_cast<std::size_t>(sums[0]);
  report.contacts = static_cast<std::size_t>(sums[1]);
  report.touching = static_cast<std::size_t>(sums[2]);
  report.elastic = sums[3];
  report.dissipated = sums[4];
  report.work = sums[5];
  report.losses = {sums[6], sums[7], sums[8], sums[9]};
  report.deepest = largest[0];
  report.deepest_relative = largest[1];
  sound = sums[10] == 0.0;
}

PartFigures Part::figures() const {
  PartFigures all = figures_;
  all.bytes += halo_.bytes();
  return all;
}

}  // namespace epafi
