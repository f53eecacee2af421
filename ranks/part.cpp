#include "ranks/part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "engine/threads/parallel.h"
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

bool has_rows(const ImageColumn& c) {
  return c.whose != RowsOf::nobody && c.whose != RowsOf::ids && c.whose != RowsOf::share;
}

/// What is nobody's is that of rank 0 everywhere; of shared sums rank 0 has all. Two messages, however many columns.
void take_common(StateImage& image) {
  std::vector<std::uint64_t> sizes;
  for (const ImageColumn& c : image)
    if (!has_rows(c)) sizes.push_back(c.data.size());
  broadcast(sizes.data(), sizes.size() * sizeof sizes[0]);
  std::vector<std::byte> all;
  for (const ImageColumn& c : image)
    if (!has_rows(c) && rank_number() == 0) all.insert(all.end(), c.data.begin(), c.data.end());
  all.resize(std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0}));
  broadcast(all.data(), all.size());
  auto from = all.begin();
  auto size = sizes.begin();
  for (ImageColumn& c : image) {
    if (has_rows(c)) continue;
    const auto end = from + static_cast<std::ptrdiff_t>(*size++);
    c.data.assign(from, end);
    from = end;
    if (c.whose == RowsOf::share && c.row == sizeof(double) && rank_number() != 0)
      std::fill(c.data.begin(), c.data.end(), std::byte{});
  }
}

/// Shared sums, at rank 0 and everywhere else.
void sum_shares(StateImage& image) {
  std::vector<double> sums;
  for (const ImageColumn& c : image) {
    if (c.whose != RowsOf::share) continue;
    sums.push_back(c.data[0] == std::byte{} ? 0.0 : 1.0);
    if (c.row == sizeof(double)) std::memcpy(&sums.back(), c.data.data(), sizeof(double));
  }
  sum_over_ranks(sums);
  auto sum = sums.begin();
  for (ImageColumn& c : image) {
    if (c.whose != RowsOf::share) continue;
    if (c.row == sizeof(double))
      std::memcpy(c.data.data(), &*sum, sizeof(double));
    else
      c.data[0] = std::byte{*sum != 0.0};
    ++sum;
  }
}

void drop_rows(StateImage& image) {
  for (ImageColumn& c : image)
    if (has_rows(c)) c.data.clear();
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

struct PlaceRow {
  std::uint32_t id;
  double position[3], turn[4];
};

PlaceRow place_of(const World& world, Slot s) {
  PlaceRow row{static_cast<std::uint32_t>(world.id[s]), {}, {}};
  std::copy_n(world.position[s].data(), 3, row.position);
  if (world.has_orientation()) std::copy_n(world.orientation[s].coeffs().data(), 4, row.turn);
  return row;
}

void put_place(const PlaceRow& row, World& world) {
  const Slot s = world.slot_of(static_cast<BodyId>(row.id));
  std::copy_n(row.position, 3, world.position[s].data());
  if (world.has_orientation()) std::copy_n(row.turn, 4, world.orientation[s].coeffs().data());
}

template <class Row>
void append_row(std::vector<std::byte>& rows, const Row& row) {
  rows.resize(rows.size() + sizeof row);
  std::memcpy(rows.data() + rows.size() - sizeof row, &row, sizeof row);
}

template <class Row>
Row row_at(const std::vector<std::byte>& rows, std::size_t k) {
  Row row;
  std::memcpy(&row, rows.data() + k * sizeof row, sizeof row);
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
  own_ = static_cast<double>(std::ranges::count(world.owner, std::uint8_t{World::here}));
  const Motion own = motion_of_own();
  std::array<double, 3> largest{own.way, own.speed, own.acceleration};
  max_over_ranks(largest);
  motion_ = {largest[0], largest[1], largest[2]};
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

void Part::give_places(Simulation* whole) {
  const World& world = sim_.world;
  std::vector<std::byte> rows, arrived;
  for (Slot s = 0; s < world.size(); ++s)
    if (world.owner[s] == World::here) append_row(rows, place_of(world, s));
  const Plan plan(std::vector<int>(rows.size() / sizeof(PlaceRow), 0));
  plan.run(rows, sizeof(PlaceRow), arrived);
  figures_.bytes += static_cast<double>(rows.size());
  if (!whole) return;
  for (std::size_t k = 0; k < plan.received(); ++k) put_place(row_at<PlaceRow>(arrived, k), whole->world);
  for (Slot s = 0; s < world.size(); ++s)
    if (world.owner[s] == World::everywhere) put_place(place_of(world, s), whole->world);
}

void Part::give_contacts(Simulation* whole) {
  give_places(whole);
  const World& world = sim_.world;
  ContactSet& set = sim_.work.contacts;
  sim_.pipeline.contact_model->publish(world, set);
  std::vector<std::byte> rows, arrived;
  for (std::size_t k = 0; k < set.size(); ++k) {
    const bool held = world.owner[set.a[k]] == World::everywhere && world.owner[set.b[k]] == World::everywhere;
    if (held ? rank_number() != 0 : !world.counts(set.a[k], set.b[k])) continue;
    append_row(rows, row_of(set, k, world));
  }
  const Plan plan(std::vector<int>(rows.size() / sizeof(ContactRow), 0));
  plan.run(rows, sizeof(ContactRow), arrived);
  figures_.bytes += static_cast<double>(rows.size());
  if (!whole) return;
  ContactSet& all = whole->work.contacts;
  all.with_moment = set.with_moment;
  all.renew(plan.received());
  for (std::size_t k = 0; k < plan.received(); ++k) put_row(all, k, row_at<ContactRow>(arrived, k), whole->world);
  all.sort();
}

Part::Motion Part::motion_of_own() const {
  const World& world = sim_.world;
  const auto largest = [&](auto&& of) {
    return block_max<double>(world.size(), 0.0, [&](std::size_t i) {
      const auto s = static_cast<Slot>(i);
      return world.owner[s] == World::here ? of(s) : 0.0;
    });
  };
  return {largest([&](Slot s) { return (world.position[s] - start_[s]).squaredNorm(); }),
          largest([&](Slot s) { return world.velocity[s].squaredNorm(); }),
          largest([&](Slot s) { return world.acceleration(s).squaredNorm(); })};
}

bool Part::step(double dt, const std::optional<Domain>& domain, StepReport& report) {
  World& world = sim_.world;
  if (!(motion_.all(dt) < margin_)) move(motion_.next(dt));
  std::vector<BodyId> none;
  for (auto& event : sim_.events)
    if (event->is_local()) event->before_step(world, dt, none);
  epafi::step(world, sim_.pipeline, sim_.work, dt);
  note_overlaps();
  bool sound = is_sound(domain);
  begin_sums(sound);
  halo_.refresh(world);
  figures_.steps += 1.0;
  figures_.ghosts += static_cast<double>(halo_.ghosts());
  figures_.own += own_;
  for (const Stage stage : {Stage::integrate, Stage::broad_phase, Stage::narrow_phase, Stage::contact})
    report.seconds[stage] = sim_.work.report.seconds[stage];
  finish_sums(report, sound);
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

void Part::begin_sums(bool sound) {
  const StepReport& mine = sim_.work.report;
  const std::array<double, 11> sums{static_cast<double>(mine.pairs),
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
  const Motion motion = motion_of_own();
  const std::array<double, 5> largest{mine.deepest, mine.deepest_relative, motion.way, motion.speed,
                                      motion.acceleration};
  joint_.begin(sums, largest);
}

void Part::finish_sums(StepReport& report, bool& sound) {
  std::array<double, 11> sums{};
  std::array<double, 5> largest{};
  joint_.finish(sums, largest);
  report.pairs = static_cast<std::size_t>(sums[0]);
  report.contacts = static_cast<std::size_t>(sums[1]);
  report.touching = static_cast<std::size_t>(sums[2]);
  report.elastic = sums[3];
  report.dissipated = sums[4];
  report.work = sums[5];
  report.losses = {sums[6], sums[7], sums[8], sums[9]};
  report.deepest = largest[0];
  report.deepest_relative = largest[1];
  motion_ = {largest[2], largest[3], largest[4]};
  sound = sums[10] == 0.0;
}

PartFigures Part::figures() const {
  PartFigures all = figures_;
  all.bytes += halo_.bytes();
  return all;
}

}  // namespace epafi
