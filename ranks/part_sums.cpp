// Sums and maxima of a step over all parts.
#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "engine/state/held_loads.h"
#include "engine/threads/parallel.h"
#include "ranks/part.h"
#include "ranks/rows.h"

namespace epafi {

/// Largest overlaps of contacts that the model has not found itself.
void Part::note_overlaps() {
  const ContactSet& c = sim_.work.contacts;
  const World& world = sim_.world;
  StepReport& report = sim_.work.report;
  report.deepest = block_max<double>(c.size(), report.deepest, [&](std::size_t k) { return -c.gap[k]; });
  report.deepest_relative = block_max<double>(c.size(), report.deepest_relative, [&](std::size_t k) {
    if (!(c.gap[k] < 0.0)) return 0.0;
    return -c.gap[k] / std::min(territory_.radius(world.shape[c.a[k]]), territory_.radius(world.shape[c.b[k]]));
  });
}

/// Sums the loads on fixed and driven bodies over all ranks, where events read them; bitwise equal to those of one
/// process.
void Part::join_held_loads() {
  World& world = sim_.world;
  if (!world.columns().held_force) return;
  std::vector<Slot> held;
  for (Slot s = 0; s < world.size(); ++s)
    if (!world.is_movable(s)) held.push_back(s);
  const auto counts = [&](Slot a, Slot b) { return tells_of(world, a, b); };
  RowBytes rows, all;
  for (const HeldLoad& load : held_loads(world, sim_.work.contacts, held, counts)) append_row(rows, load);
  gather_rows(rows, sizeof(HeldLoad), all);
  std::vector<double> sums(6 * held.size());
  for (std::size_t h = 0; h < held.size() && rank_number() == 0; ++h) {
    HeldLoad load;
    for (int rank = 0; rank < rank_count(); ++rank)
      load += row_at<HeldLoad>(all, h + static_cast<std::size_t>(rank) * held.size());
    for (std::size_t c = 0; c < 6; ++c) sums[6 * h + c] = load.sums[c].value();
  }
  broadcast(sums.data(), sums.size() * sizeof(double));
  for (std::size_t h = 0; h < held.size(); ++h) {
    const double* const x = &sums[6 * h];
    world.force[held[h]] = Vec3(x[0], x[1], x[2]);
    if (world.rotates()) world.torque[held[h]] = Vec3(x[3], x[4], x[5]);
  }
  if (!tied_.empty()) take_off_held_pulls();
}

/// Subtracts the loads of springs, in the order of one process.
void Part::take_off_held_pulls() {
  World& world = sim_.world;
  std::vector<HeldPull> mine;
  if (const SharedModel* model = shared_model()) model->append_held_pulls(world, mine);
  RowBytes rows, all;
  for (const HeldPull& pull : mine) append_row(rows, pull);
  gather_rows(rows, sizeof(HeldPull), all);
  std::uint64_t size = all.size();
  broadcast(&size, sizeof size);
  all.resize(size);
  broadcast(all.data(), all.size());
  std::vector<HeldPull> pulls(all.size() / sizeof(HeldPull));
  for (std::size_t k = 0; k < pulls.size(); ++k) pulls[k] = row_at<HeldPull>(all, k);
  std::ranges::sort(pulls, {}, &HeldPull::order);
  for (const HeldPull& pull : pulls) {
    const Slot s = world.slot_of(pull.body);
    const auto vector = [](const double* x) { return Vec3(x[0], x[1], x[2]); };
    world.force[s] -= vector(pull.force);
    if (world.rotates()) world.torque[s] -= vector(pull.torque);
  }
}

/// Virial of all contacts, bitwise equal to that of one process. Call before springs leave their contacts.
void Part::join_virial() {
  World& world = sim_.world;
  if (!world.cell || std::exchange(virial_is_joined_, true)) return;
  Virial mine;
  mine.contacts = virial_sums(world, sim_.work.contacts);
  if (const SharedModel* model = shared_model()) model->add_virial(world, mine);
  RowBytes row, all;
  append_row(row, mine);
  gather_rows(row, sizeof mine, all);
  Virial sum;
  for (std::size_t k = 0; k < all.size() / sizeof sum; ++k) sum += row_at<Virial>(all, k);
  Vec3 virial = sum.value();
  broadcast(virial.data(), 3 * sizeof(double));
  world.cell->virial = virial;
}

/// Sums of overlaps. Call before springs leave their contacts.
void Part::sum_overlaps() {
  if (overlaps_) return;
  const World& world = sim_.world;
  const ContactPieces pieces(world, sim_.work.contacts, sim_.pipeline.contact_model.get());
  overlaps_ = overlap_totals(
      world, pieces, [&](std::uint32_t shape) { return territory_.radius(shape); },
      [&](Slot a, Slot b) { return tells_of(world, a, b); });
}

RemoteTotals Part::totals(bool overlaps) {
  RankTimer timer(figures_);
  RemoteTotals mine{body_totals(sim_.world), {}};
  if (overlaps) {
    sum_overlaps();
    mine.overlaps = *overlaps_;
  }
  RowBytes row, all;
  append_row(row, mine);
  gather_rows(row, sizeof mine, all);
  RemoteTotals sum;
  for (std::size_t k = 0; k < all.size() / sizeof sum; ++k) sum += row_at<RemoteTotals>(all, k);
  timer.lap(RankStage::sums);
  return sum;
}

double Part::stiffness(double dt) {
  if (!stiffness_) return std::numeric_limits<double>::infinity();
  const ContactPieces pieces(sim_.world, sim_.work.contacts, sim_.pipeline.contact_model.get());
  RankTimer timer(figures_);
  double largest = stiffness_(sim_.world, pieces, dt);
  max_over_ranks({&largest, 1});
  timer.lap(RankStage::sums);
  return largest;
}

/// True where this rank's bodies are finite and inside the domain; once the next step has begun the domain is not
/// checked.
bool Part::is_sound(const std::optional<Domain>& domain) const {
  static const std::optional<Domain> everywhere;
  const std::optional<Domain>& room = sim_.is_ahead() ? everywhere : domain;
  const Extent* seen = sim_.pipeline.contact_model->extent();
  if (seen && seen->is_inside(room)) return true;
  const auto strays = find_strays(sim_.world, room);
  return std::ranges::none_of(strays, [&](Slot s) { return sim_.world.owner[s] == World::here; });
}

bool Part::asks() const {
  return !deforms_ && std::ranges::any_of(sim_.events, [&](const auto& event) { return event->asks(sim_.world); });
}

void Part::begin_sums(bool sound, const std::optional<Domain>& domain) {
  const StepReport& mine = sim_.work.report;
  const bool ahead = sim_.is_ahead();
  const Extent next = ahead ? shared_model()->begun() : Extent();
  const SharedList* const list = shared_list();
  const SharedList::End end = list ? list->predicted_end() : SharedList::End{};
  const std::array<double, 17> sums{static_cast<double>(mine.pairs),
                                    static_cast<double>(mine.contacts),
                                    static_cast<double>(mine.touching),
                                    mine.elastic,
                                    mine.dissipated,
                                    mine.work,
                                    mine.losses.viscous,
                                    mine.losses.frictional,
                                    mine.losses.plastic,
                                    mine.losses.adhesive,
                                    sound ? 0.0 : 1.0,
                                    asks() ? 1.0 : 0.0,
                                    ahead ? 1.0 : 0.0,
                                    own_ > 0.0 && !next.is_inside(domain) ? 1.0 : 0.0,
                                    end.comes ? 1.0 : 0.0,
                                    end.by_slow ? 1.0 : 0.0,
                                    work_.ticks()};
  std::array<double, 10> largest{mine.deepest, mine.deepest_relative, work_.ticks()};
  std::ranges::copy(ahead ? speeds_of(next) : speeds_of_own(), largest.begin() + 3);  // accelerations have acted
  joint_.begin(sums, largest);
}

void Part::finish_sums(StepReport& report, bool& sound) {
  std::array<double, 17> sums{};
  std::array<double, 10> largest{};
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
  worked_ = WorkMeter::seconds_of(sums[16]);
  is_uneven_ = Territory::is_uneven(WorkMeter::seconds_of(largest[2]), worked_, all_);
  take_speeds(std::span(largest).subspan<3>());
  sound = sums[10] == 0.0;
  asked_ = sums[11] != 0.0;
  if (sums[12] != (sim_.is_ahead() ? rank_count() : 0.0)) throw std::logic_error("ranks are in different steps");
  inside_ = sums[13] == 0.0;
  list_ends_ = sums[14] != 0.0;
  if (SharedList* list = shared_list()) list->end_with_others({list_ends_, sums[15] != 0.0});
}

}  // namespace epafi
