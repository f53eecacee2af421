#include "ranks/part.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/threads/parallel.h"
#include "ranks/common_columns.h"
#include "ranks/communicator.h"
#include "ranks/rows.h"

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

StateImage image_of(Simulation& sim) { return image_of(walk_of(sim), &sim.world); }
void restore(StateImage& image, Simulation& sim) { restore(image, walk_of(sim), &sim.world); }

}  // namespace

/// The rows that have come are the state; their owners tell each other.
void Part::settle(StateImage& image, const Arrival& arrival, bool begun) {
  forget_slots(sim_);
  restore(image, sim_);
  SharedModel* const model = shared_model();
  by_states_ = model && model->tells_states(only_spheres_);
  if (begun) model->take_states();
  World& world = sim_.world;
  place_ = arrival.place;
  world.owner = owners_of(arrival);
  start_.position.resize(world.size());
  start_.wraps.resize(world.cell ? world.size() : 0);
  for (Slot s = 0; s < world.size(); ++s) {
    start_.position[s] = world.position[s];
    if (world.cell) start_.wraps[s] = world.wraps[s];
  }
  if (world.cell) start_.cell = world.cell->size;
  start_.grown = 1.0;
  own_ = static_cast<double>(std::ranges::count(world.owner, std::uint8_t{World::here}));
  Speeds speeds = speeds_of_own();
  max_over_ranks(speeds);
  motion_ = {};
  motion_.along = territory_.cut_axes();
  take_speeds(speeds);
  figures_.bytes += arrival.bytes;
  const Routes now = territory_.routes(world, world.owner, place_, {});
  std::vector<std::pair<int, Slot>> sends;
  for (Slot s = 0; s < world.size(); ++s)
    for (std::uint32_t k = now.begin[s]; world.owner[s] == World::here && k < now.begin[s + 1]; ++k)
      if (now.to[k] != rank_number()) sends.emplace_back(now.to[k], s);
  halo_.set_up(world, std::move(sends), place_);
  std::array<double, 2> sums{own_, static_cast<double>(halo_.ghosts().size())};
  sum_over_ranks(sums);
  all_ = sums[0];
  all_ghosts_ = sums[1];
  is_uneven_ = false;
  settled_ = true;
}

void Part::receive(Simulation* whole) {
  RankTimer timer(figures_);
  StateImage image = image_of(whole ? *whole : sim_);
  if (!whole) drop_rows(image);
  take_common(image);
  const World& world = whole ? whole->world : sim_.world;
  const Owners owner = whole ? owners_of_whole(world) : Owners();  // the others have none until they are shared out
  place_.resize(owner.size());
  std::iota(place_.begin(), place_.end(), 0u);
  territory_.cut(world, owner, work_.take());
  if (dt_ > 0.0) territory_.suit(motion_.next(dt_), all_, all_ghosts_);
  const Arrival arrival = exchange_rows(image, territory_.routes(world, owner, place_, all_ranks()));
  settle(image, arrival, false);
  asked_ = false;
  prepared_ = true;
  timer.lap(RankStage::sharing);
}

/// Moves bodies to the ranks in whose parts they are now; longest: largest displacement in the next step [m].
void Part::move(double longest) {
  territory_.suit(longest, all_, all_ghosts_);
  if (is_uneven_) territory_.cut_by_owners(sim_.world, sim_.world.owner, work_.take(), worked_, all_);
  const bool begun = has_begun();
  StateImage image = image_of(sim_);
  const Arrival arrival =
      exchange_rows(image, territory_.routes(sim_.world, sim_.world.owner, place_, {rank_number()}));
  settle(image, arrival, begun);
  figures_.moved += 1.0;
}

void Part::give(Simulation* whole, bool goes_on) {
  RankTimer timer(figures_);
  sum_overlaps();
  join_virial();
  if (!goes_on && !told_) told_ = contact_rows();  // springs leave their contacts below
  StateImage image = image_of(sim_);
  sum_shares(image);
  exchange_rows(image, routes_home(sim_.world, place_));
  if (whole) restore(image, *whole);
  timer.lap(RankStage::sharing);
}

/// What a step changes of them; the slots of the whole are the places.
void Part::give_bodies(Simulation* whole) {
  World& world = sim_.world;
  std::vector<Slot> told;
  for (Slot s = 0; s < world.size(); ++s)
    if (world.owner[s] == World::here || (whole && world.owner[s] == World::everywhere)) told.push_back(s);
  const std::size_t moving = bytes_of_moving(world), row = sizeof place_[0] + moving;
  RowBytes rows(told.size() * row), arrived;
  parallel_for(told.size(), [&](std::size_t k) {
    std::byte* const to = rows.data() + k * row;
    std::memcpy(to, &place_[told[k]], sizeof place_[0]);
    write_moving(world, false, told[k], to + sizeof place_[0]);
  });
  Plan plan(std::vector<int>(told.size(), 0));
  plan.run(rows, row, arrived);
  figures_.bytes += static_cast<double>(rows.size());
  if (!whole) return;
  whole->world.cell = world.cell;
  parallel_for(plan.received(), [&](std::size_t k) {
    const std::byte* const from = arrived.data() + k * row;
    std::uint32_t place = 0;
    std::memcpy(&place, from, sizeof place);
    read_moving(from + sizeof place, false, place, whole->world);
  });
}

/// Rows of the contacts that this rank reports; those that the contact model keeps follow, marked as its own.
RowBytes Part::contact_rows() const {
  const World& world = sim_.world;
  const ContactModel& model = *sim_.pipeline.contact_model;
  RowBytes rows;
  const auto add = [&](const ContactSet& contacts, bool own) {
    for (std::size_t k = 0; k < contacts.size(); ++k)
      if (tells_of(world, contacts.a[k], contacts.b[k])) append_row(rows, row_of(contacts, k, world, own));
  };
  add(sim_.work.contacts, false);
  ContactSet pieces;
  pieces.with_curvature = true;
  pieces.with_moment = sim_.work.contacts.with_moment;
  for (std::size_t part = 0; part < model.own_parts(); ++part) {
    pieces.clear();
    model.append_contacts(world, part, {}, pieces);
    add(pieces, true);
  }
  return rows;
}

namespace {

/// Sort key of a body in a contact, as a contact model orders the contacts that it keeps: balls of free clumps, held
/// balls, others.
struct PlaceInModel {
  int kind;
  Slot body;
  std::uint32_t part;  ///< of the clump
  auto operator<=>(const PlaceInModel&) const = default;
};

struct ContactKey {
  bool own;
  PlaceInModel first, second;
  Feature feature;
  std::size_t row;
  auto operator<=>(const ContactKey&) const = default;
};

}  // namespace

/// Contacts of the model come in pieces, sorted by the lower of the two keys, at a plane by that of the ball; else all
/// are in canonical order.
void Part::put_contacts(const RowBytes& rows, bool in_pieces, const World& world, ContactSet& all) const {
  const auto is_plane = [&](Slot s) { return std::isinf(territory_.radius(world.shape[s])); };
  const auto place_of = [&](Slot s, Feature& parts) -> PlaceInModel {
    const bool clump = territory_.is_clump(world.shape[s]);
    const auto part = static_cast<std::uint32_t>(clump ? parts >> 48 & 0xffu : 0u);
    if (clump) parts <<= 8;  // that of the other one is next
    const bool is_ball = clump || !(world.is_movable(s) || is_plane(s));
    return {!is_ball ? 2 : world.is_movable(s) ? 0 : 1, s, part};
  };
  std::vector<ContactKey> keys;
  for (std::size_t k = 0; k < rows.size() / sizeof(ContactRow); ++k) {
    const auto row = row_at<ContactRow>(rows, k);
    const Slot a = world.slot_of(static_cast<BodyId>(row.a)), b = world.slot_of(static_cast<BodyId>(row.b));
    ContactKey key{in_pieces && row.own != 0, {0, a, 0}, {0, b, 0}, row.feature, k};
    if (key.own) {
      Feature parts = row.feature;
      key.first = place_of(a, parts);
      key.second = place_of(b, parts);
      if (!is_plane(b) && (is_plane(a) || key.second < key.first)) std::swap(key.first, key.second);
    }
    keys.push_back(key);
  }
  std::ranges::sort(keys);
  all.renew(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k) put_row(all, k, row_at<ContactRow>(rows, keys[k].row), world);
}

void Part::give_seen(Simulation* whole, ContactView contacts) {
  RankTimer timer(figures_);
  give_bodies(whole);
  if (contacts >= ContactView::pieces) give_contacts(whole, contacts != ContactView::all);
  timer.lap(RankStage::sharing);
}

void Part::give_contacts(Simulation* whole, bool in_pieces) {
  const RowBytes mine = told_ ? RowBytes() : contact_rows(), &rows = told_ ? *told_ : mine;
  RowBytes arrived;
  Plan plan(std::vector<int>(rows.size() / sizeof(ContactRow), 0));
  plan.run(rows, sizeof(ContactRow), arrived);
  figures_.bytes += static_cast<double>(rows.size());
  if (whole) {
    whole->work.contacts.with_moment = sim_.work.contacts.with_moment;
    put_contacts(arrived, in_pieces, whole->world, whole->work.contacts);
  }
}

Part::Speeds Part::speeds_of_own() const {
  const World& world = sim_.world;
  Speeds none;
  none.fill(-std::numeric_limits<double>::infinity());
  const auto take = [](Speeds& most, const Speeds& other) {
    for (std::size_t k = 0; k < most.size(); ++k) most[k] = std::max(most[k], other[k]);
  };
  std::vector<Speeds> parts((world.size() + sum_block - 1) / sum_block, none);
  parallel_blocks(world.size(), sum_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
    Speeds most = none;
    for (std::size_t i = begin; i < end; ++i) {
      const auto s = static_cast<Slot>(i);
      if (world.owner[s] != World::here) continue;
      const Vec3 v = world.velocity[s];
      take(most, {v.x(), v.y(), v.z(), -v.x(), -v.y(), -v.z(), world.acceleration(s).squaredNorm()});
    }
    parts[block] = most;
  });
  Speeds all = none;
  for (const Speeds& part : parts) take(all, part);
  return all;
}

/// Velocities of the bodies in the step that has begun, without an acceleration.
Part::Speeds Part::speeds_of(const Extent& begun) const {
  const Vec3 &low = begun.slowest, &high = begun.fastest;
  const double none = own_ > 0.0 ? 0.0 : -std::numeric_limits<double>::infinity();
  return {high.x(), high.y(), high.z(), -low.x(), -low.y(), -low.z(), none};
}

/// Takes the largest velocities over all ranks. In a deforming cell bodies have no common displacement: the flow would
/// change it.
void Part::take_speeds(std::span<const double> largest) {
  if (!(largest[6] >= 0.0)) return;  // nobody has bodies
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    motion_.high[axis] = deforms_ ? std::max(largest[k], largest[3 + k]) : largest[k];
    motion_.low[axis] = deforms_ ? -motion_.high[axis] : -largest[3 + k];
  }
  motion_.acceleration = largest[6];
}

/// Largest displacement of this rank's bodies relative to their common one and to the flow of the cell [m].
double Part::farthest_of_own() const {
  const World& world = sim_.world;
  const Vec3 low = world.cell ? world.cell->low : Vec3(Vec3::Zero());
  const Vec3 size = world.cell ? world.cell->size : Vec3(Vec3::Ones()), stretch = size.cwiseQuotient(start_.cell);
  return block_max<double>(world.size(), 0.0, [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    if (world.owner[s] != World::here) return 0.0;
    Vec3 way = world.position[s] - low - stretch.cwiseProduct(start_.position[s] - low) - motion_.together;
    if (world.cell) way += (world.wraps[s] - start_.wraps[s]).cast<double>().cwiseProduct(size);
    return motion_.along.cwiseProduct(way).cwiseAbs().maxCoeff();
  });
}

/// Scales distances by the deformation of the cell before this step.
void Part::note_flow(double dt) {
  double most = 1.0;
  for (const double rate : sim_.world.cell->strain_rate)
    most = std::max({most, 1.0 + dt * rate, 1.0 / (1.0 + dt * rate)});
  motion_.way *= most;
  start_.grown *= most;
}

/// No body leaves the margin in the next step, or most of it where a list ends: after a move all lists are new anyhow.
/// Ways are sums of what the fastest body may have gone in each step, and measured only where these are too long.
bool Part::stays(double dt) {
  const double margin = (list_ends_ ? 0.75 : 1.0) * territory_.margin();
  const auto is_near = [&] {
    const double grown = start_.grown;
    return grown * motion_.all(dt) + 0.5 * (grown - 1.0) * territory_.reach() < margin;
  };
  if (is_near()) return true;
  motion_.way = farthest_of_own();
  max_over_ranks({&motion_.way, 1});
  return is_near();
}

/// Runs the events that every rank runs by itself; returns their work, at rank 0 [J]. Common events need an answer from
/// all ranks: they got it after the last step, or get it here where an earlier event (a deforming cell) moves free
/// bodies.
double Part::act_events(double dt) {
  World& world = sim_.world;
  if (std::exchange(prepared_, false)) return 0.0;
  std::vector<BodyId> none;
  const double power = sim_.held_power(), work = sim_.ledger.last().work;
  for (auto& event : sim_.events) {
    if (!event->is_local()) continue;
    if (!event->is_common()) {
      event->before_step(world, dt, none);
    } else {
      double asks = deforms_ ? event->asks(world) : asked_;
      if (deforms_) max_over_ranks({&asks, 1});
      if (asks != 0.0) event->answer(world);
    }
  }
  if (deforms_) note_flow(dt);
  if (rank_number() != 0) return 0.0;
  return sim_.ledger.last().work - work + 0.5 * dt * (sim_.held_power() - power);
}

/// Ensures that this rank has all bodies that contacts need in the step. True where bodies arrived after its first
/// half.
bool Part::hold(double dt) {
  const bool ahead = sim_.is_ahead();
  if (ahead) motion_.go(dt);
  const bool moves = !stays(ahead ? 0.0 : dt) || (list_ends_ && is_uneven_);
  if (moves) move(motion_.next(dt));
  if (!ahead) motion_.go(dt);
  dt_ = dt;
  return ahead && moves;
}

/// As in Simulation::make_step; gives the same answer on all ranks.
bool Part::may_run_on(const std::optional<Domain>& domain) const {
  if (settled_ || (sim_.is_ahead() ? !inside_ || (domain && !had_domain_) : domain.has_value())) return false;
  return std::ranges::all_of(sim_.events,
                             [&](const auto& e) { return !e->is_local() || e->rests_next(sim_.world, dt_); });
}

bool Part::step(double dt, const std::optional<Domain>& domain, bool run_on, StepReport& report) {
  World& world = sim_.world;
  RankTimer timer(figures_);
  const double booked = act_events(dt);
  const bool begun = hold(dt), runs_on = run_on && may_run_on(domain);
  settled_ = false;
  had_domain_ = domain.has_value();
  timer.lap(RankStage::sharing);
  overlaps_.reset();
  told_.reset();
  virial_is_joined_ = false;
  work_.begin();
  if (sim_.loads) sim_.loads->before_step(world, dt);
  // the work of a strain uses the forces before and after it: process 0 books the former, for all contacts
  if (world.cell && rank_number() != 0) world.cell->virial.setZero();
  const RunOn leave{[](const Extent&) { return true; }, had_domain_};
  StageTimer stages(sim_.work.report.seconds);
  epafi::step(world, sim_.pipeline, sim_.work, dt, stages, runs_on ? &leave : nullptr, begun);
  if (sim_.loads) sim_.work.report.work += sim_.loads->after_step(world, dt);
  sim_.work.report.work += booked;
  work_.end();
  timer.skip();
  halo_.begin(world, has_begun());
  timer.lap(RankStage::exchange);
  join_held_loads();
  if (deforms_) join_virial();
  note_overlaps();
  bool sound = is_sound(domain);
  begin_sums(sound, domain);
  timer.lap(RankStage::hidden);
  halo_.finish(world, has_begun());
  if (sim_.is_ahead()) shared_model()->take_ghosts(world, halo_.ghosts());
  timer.lap(RankStage::exchange);
  figures_.steps += 1.0;
  figures_.ghosts += static_cast<double>(halo_.ghosts().size());
  figures_.own += own_;
  for (const Stage stage : {Stage::integrate, Stage::broad_phase, Stage::narrow_phase, Stage::contact})
    report.seconds[stage] = sim_.work.report.seconds[stage];
  finish_sums(report, sound);
  timer.lap(RankStage::sums);
  return sound;
}

PartFigures Part::figures() const {
  PartFigures all = figures_;
  all.bytes += halo_.bytes();
  for (const Stage stage : {Stage::integrate, Stage::broad_phase, Stage::narrow_phase, Stage::contact})
    all.seconds[static_cast<std::size_t>(stage)] = sim_.work.report.seconds[stage];  // they come first in RankStage
  return all;
}

}  // namespace epafi
