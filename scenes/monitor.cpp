#include "scenes/monitor.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>

#include "engine/threads/parallel.h"
#include "scenes/railway/rolling.h"
#include "scenes/time_step.h"

namespace epafi {

namespace {
constexpr double deep_overlap = 0.5;  // of the smaller body's bounding radius: no law of contact holds there

Overlap overlap_of(const OverlapTotals& all) {
  const double mean = all.pairs > 0 ? all.sum.value() / static_cast<double>(all.pairs) : 0.0;
  return {all.max, mean, all.max_relative, all.pairs};
}
}  // namespace

Overlap measure_overlap(const World& world, const ContactPieces& contacts, const ShapeStore& shapes) {
  const auto radius = [&](std::uint32_t shape) { return shapes.bounding_radius({shape}); };
  return overlap_of(overlap_totals(world, contacts, radius, [](Slot, Slot) { return true; }));
}

std::string deep_overlap_text(double relative) {
  if (!(relative > deep_overlap)) return "";
  char text[160];
  std::snprintf(text, sizeof text,
                "bodies overlap by %.2g of the radius of the smaller one: forces and directions of such contacts are "
                "not right",
                relative);
  return text;
}

RunMonitor::RunMonitor(const Scene& scene, const std::vector<BodyIds>& bound_bodies, const ShapeStore& shapes,
                       const Setup& setup, Warnings& warnings)
    : bounds_(scene.bounds),
      stopping_(bounds_.size()),
      bound_bodies_(bound_bodies),
      shapes_(shapes),
      steps_(setup.steps),
      interval_(std::max<std::uint64_t>(1, setup.interval)),
      way_to_balance_(setup.way_to_balance),
      least_radius_(setup.least_radius),
      warnings_(warnings) {
  energy_.allow_swing(setup.swing);
  watches_balance_ = std::ranges::none_of(bounds_, [](const BoundSpec& b) { return b.quantity == "energy_error"; });
  bounds_.insert(bounds_.end(), scene.accuracy.begin(), scene.accuracy.end());
  bound_start_.resize(bounds_.size());
  for (const auto& b : bounds_) {
    const std::string name = b.body.empty() ? b.quantity : b.quantity + "." + b.body;
    left_since_.push_back(-1.0);
    checks_.push_back({name, 0.0, b.limit, true});
    follows_bodies_ = follows_bodies_ || b.quantity == "drift" || b.quantity == "sag";
  }
}

void RunMonitor::observe(const StepView& view) {
  if (view.step > 0) {
    energy_.note(view.report);
    totals_.steps += 1;
    totals_.contacts += static_cast<double>(view.report.touching);
    totals_.body_steps += static_cast<double>(view.movable);
    if (view.report.has_solver) {
      const SolverReport& s = view.report.solver;
      totals_.residual += s.residual;
      totals_.residual_max = std::max(totals_.residual_max, s.residual);
      totals_.iterations += s.iterations;
      totals_.iterations_max = std::max(totals_.iterations_max, double(s.iterations));
      totals_.not_converged += s.converged ? 0 : 1;
      watch_solver(view);
    }
    watch_models(view);
  }
  const bool looks = view.step % interval_ == 0 || view.last;
  if (looks) look(view);
  note_overlap(view);
  check(view, looks);
}

/// Warns of a solver that stopped above its tolerance, and of contacts that no solver can satisfy.
void RunMonitor::watch_solver(const StepView& view) {
  const StepReport& report = view.report;
  if (report.solver.converged) return;
  char text[120];
  std::snprintf(text, sizeof text, "the solver stopped above its tolerance: residual %.3g", report.solver.residual);
  warnings_.add({.kind = "unconverged",
                 .text = text,
                 .first_step = view.step,
                 .first_time = view.world.time,
                 .value = report.solver.residual});
  if (report.trouble.kind != SolverTrouble::Kind::no_solution) return;
  warnings_.add({.kind = "no_solution",
                 .text = report.trouble.text,
                 .first_step = view.step,
                 .first_time = view.world.time,
                 .value = report.trouble.size,
                 .body = view.world.id[report.trouble.slot]});
}

/// Warns of contacts that a model solved outside its range, once per reason, whatever numbers its text holds.
void RunMonitor::watch_models(const StepView& view) {
  for (const ModelDoubt& doubt : view.report.doubts) {
    std::string kind = "model: " + doubt.reason;
    std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) || c == '.' || c == '-'; });
    warnings_.add({.kind = kind,
                   .text = "a model was used where it does not hold: " + doubt.reason + model_remedy(doubt.reason),
                   .first_step = view.step,
                   .first_time = view.world.time,
                   .value = doubt.load,
                   .body = view.world.id[doubt.slot]});
  }
}

/// Updates the largest overlap. The relative one is computed only for contacts that would exceed it on the smallest
/// body.
void RunMonitor::note_overlap(const StepView& view) {
  const ContactSet& c = view.contacts;
  // at the start only a look has seen the contacts
  const Overlap looked = view.step == 0 ? last_overlap_ : Overlap{};
  const double deepest = std::max(view.report.deepest, looked.max);
  totals_.overlap_max = std::max(totals_.overlap_max, deepest);
  const double before = totals_.overlap_relative;
  const double known = std::max({before, view.report.deepest_relative, looked.max_relative});
  totals_.overlap_relative = known;
  const auto relative = [&](std::size_t k) {
    const std::vector<std::uint32_t>& shape = view.world.shape;
    return -c.gap[k] / std::min(shapes_.bounding_radius({shape[c.a[k]]}), shapes_.bounding_radius({shape[c.b[k]]}));
  };
  if (deepest > known * least_radius_)
    totals_.overlap_relative = block_max<double>(
        c.size(), known, [&](std::size_t k) { return -c.gap[k] > known * least_radius_ ? relative(k) : 0.0; });
  if (totals_.overlap_relative > std::max(before, deep_overlap)) warn_of_overlap(view, relative);
}

/// Renews the warning at every new maximum, so that it names the worst overlap and its body.
template <class Relative>
void RunMonitor::warn_of_overlap(const StepView& view, const Relative& relative) {
  Warning w{.kind = "overlap",
            .text = deep_overlap_text(totals_.overlap_relative),
            .first_step = view.step,
            .first_time = view.world.time,
            .value = totals_.overlap_relative};
  if (view.step > 1) w.text += overlap_remedy(totals_.overlap_relative, !view.report.has_solver);
  const ContactSet& c = view.contacts;
  for (std::size_t k = 0; k < c.size() && !w.body; ++k) {
    if (!(-c.gap[k] > 0.0) || relative(k) < totals_.overlap_relative) continue;
    w.body = view.world.id[view.world.is_movable(c.a[k]) ? c.a[k] : c.b[k]];
  }
  warnings_.add(w);
}

void RunMonitor::look(const StepView& view) {
  last_overlap_ = view.overlaps ? overlap_of(*view.overlaps) : measure_overlap(view.world, view.pieces(), shapes_);
  if (view.last || view.step * 10 >= steps_ * 9) {
    totals_.overlap_mean += last_overlap_.mean;
    totals_.overlap_looks += 1;
  }
  look_at_momentum(view);
  watch_energy(view);
}

namespace {
std::string balance_text(const WatchedBalance::Finding& open, const Energy& now) {
  constexpr double net_open = 1e-2;
  char text[240];
  if (std::abs(open.net) > net_open || !std::isfinite(open.net))
    std::snprintf(text, sizeof text, "the energy balance is open by %.2g of the largest energy: %s", open.net,
                  open.net > 0 ? "the bodies gained energy without a source" : "energy was lost without a record");
  else
    std::snprintf(text, sizeof text,
                  "the energy balance was open in between, by %.2g of the energy exchanged: the bodies gained %.3g J "
                  "without a source, %.3g J were lost without a record",
                  open.share, open.gained, open.lost);
  std::string what = text;
  const double contacts = std::max(open.put_in, now.gained);
  if (contacts > 0 && !(open.net < -net_open)) {
    std::snprintf(text, sizeof text, ", the contacts %.3g J", contacts);
    what += text;
  }
  if (now.correction > 0) {
    std::snprintf(text, sizeof text, ", moving overlapping bodies apart %.3g J", now.correction);
    what += text;
  }
  return what;
}
}  // namespace

void RunMonitor::watch_energy(const StepView& view) {
  energy_.look(view);
  const WatchedBalance::Finding& open = energy_.finding();
  if (!open.warns) return;
  const std::string way = way_to_balance_.empty() ? "" : "; " + way_to_balance_;
  warnings_.add({.kind = "energy",
                 .text = balance_text(open, view.ledger.last()) + way,
                 .first_step = view.step,
                 .first_time = view.world.time,
                 .value = open.share});
  if (!watches_balance_ || !open.ends) return;
  balance_ = BoundCheck{"energy_error", open.wide, 0.5, false};
}

void RunMonitor::look_at_momentum(const StepView& view) {
  const World& w = view.world;
  // walls take up momentum: it is conserved in closed systems only
  if (w.columns().external_force || view.movable < w.size()) return;
  const BodyTotals all = view.totals();
  const double magnitude = all.momenta.value();
  const Vec3 p =
      Vec3(all.momentum[0].value(), all.momentum[1].value(), all.momentum[2].value()) - all.mass.value() * w.fallen;
  if (momentum_.started == 0) {
    for (int k = 0; k < 3; ++k) momentum_.start[k] = p[k];
    momentum_.started = 1;
  }
  momentum_.largest = std::max(momentum_.largest, magnitude);
  const Vec3 start(momentum_.start[0], momentum_.start[1], momentum_.start[2]);
  if (momentum_.largest > 0) momentum_.error = std::max(momentum_.error, (p - start).norm() / momentum_.largest);
  momentum_error_ = momentum_.error;
}

/// What bodies bring and take is no error.
void RunMonitor::shift_momentum(const World& w, Slot s, double sign) {
  if (momentum_.started == 0 || !w.is_movable(s)) return;
  const Vec3 p = sign / w.inverse_mass[s] * (w.velocity[s] - w.fallen);
  for (int k = 0; k < 3; ++k) momentum_.start[k] += p[k];
}

void RunMonitor::bodies_come(const World& world, std::size_t first) {
  for (std::size_t s = first; s < world.size(); ++s) shift_momentum(world, static_cast<Slot>(s), 1.0);
}

void RunMonitor::bodies_leave(const World& world, std::span<const BodyId> bodies) {
  for (const BodyId id : bodies)
    if (const Slot s = world.slot_of(id); s != no_slot) shift_momentum(world, s, -1.0);
}

double RunMonitor::value_of(std::size_t i, const StepView& view) {
  const BoundSpec& b = bounds_[i];
  const World& w = view.world;
  if (b.quantity == "energy_error") return std::abs(view.ledger.relative_error());
  if (b.quantity == "overlap_relative") return totals_.overlap_relative;
  if (b.quantity == "momentum_error") return momentum_error_.value_or(0.0);
  if (b.quantity == "residual") return view.report.has_solver ? view.report.solver.residual : 0.0;
  const Vec3 up = w.gravity.squaredNorm() > 0 ? Vec3(-w.gravity.normalized()) : Vec3::UnitZ();
  if (w.time < b.after * (1 - 1e-12)) return 0.0;
  auto& start = bound_start_[i];
  if (start.empty()) start.assign(bound_bodies_[i].size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  double worst = 0;
  for (std::size_t k = 0; k < start.size(); ++k) {
    const Slot s = w.slot_of(bound_bodies_[i][k]);
    if (s == no_slot) continue;
    if (!start[k].allFinite()) start[k] = w.unwrapped(s);  // when it is seen first
    const Vec3 moved = w.unwrapped(s) - start[k];
    const double rise = moved.dot(up);
    worst = std::max(worst, b.quantity == "sag" ? -rise : (moved - rise * up).norm());
  }
  return worst;
}

void RunMonitor::check(const StepView& view, bool all) {
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    if (bounds_[i].quantity == "measure") {
      check_measure(i, view);
      continue;
    }
    // energies and momentum are still those of the last evaluation
    if (!all && (bounds_[i].quantity == "energy_error" || bounds_[i].quantity == "momentum_error")) continue;
    const double value = value_of(i, view);
    checks_[i].value = std::max(checks_[i].value, value);
    checks_[i].ok = checks_[i].ok && value <= checks_[i].bound;
  }
}

std::optional<BoundCheck> RunMonitor::violated() const {
  for (std::size_t i = 0; i < stopping_; ++i)
    if (!checks_[i].ok && !bounds_[i].stops) return checks_[i];
  return balance_;
}

std::optional<BoundCheck> RunMonitor::reached() const {
  for (std::size_t i = 0; i < stopping_; ++i)
    if (!checks_[i].ok && bounds_[i].stops) return checks_[i];
  return std::nullopt;
}

void RunMonitor::check_measure(std::size_t i, const StepView& view) {
  const BoundSpec& b = bounds_[i];
  const double value = measured_ ? measured_(b.broken) : std::numeric_limits<double>::quiet_NaN();
  const double now = view.world.time;
  if (std::isnan(value) || now < b.after * (1 - 1e-12)) return;
  if (checks_[i].ok) checks_[i].value = value;
  double& since = left_since_[i];
  if (!b.broken.holds(value))
    since = -1.0;
  else if (since < 0.0)
    since = now;
  if (since >= 0.0 && now - since >= b.broken.duration - 1e-6 * view.dt) checks_[i].ok = false;
}

std::vector<BoundCheck> RunMonitor::accuracy() const {
  return {checks_.begin() + static_cast<std::ptrdiff_t>(stopping_), checks_.end()};
}

Overlap RunMonitor::overlap() const {
  const double mean = totals_.overlap_looks > 0 ? totals_.overlap_mean / totals_.overlap_looks : last_overlap_.mean;
  return {totals_.overlap_max, mean, totals_.overlap_relative, 0};
}

void RunMonitor::visit(StateVisitor& v) {
  v.value("monitor/totals", totals_);
  v.value("monitor/momentum", momentum_);
  energy_.visit(v);
  if (momentum_.started != 0) momentum_error_ = momentum_.error;
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    std::string name = "monitor/bound" + std::to_string(i);
    const std::string full = name + "/" + checks_[i].name;  // in another stage it may be another bound
    if (v.has(full + "/value")) name = full;
    if (bounds_[i].quantity == "measure") v.value(name + "/since", left_since_[i]);
    v.value(name + "/value", checks_[i].value);
    v.value(name + "/ok", checks_[i].ok);
    v.column(name + "/start", bound_start_[i]);
  }
}

}  // namespace epafi
