#include "engine/step/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// "; of its 3 contacts that with body 7 has ...": the probable cause of a body's failure: the contact with a force or
/// gap that is not finite, else the one with the deepest overlap.
std::string suspect_of(const World& world, const ContactSet& contacts, Slot slot) {
  std::size_t count = 0, worst = 0;
  double badness = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts.a[i] != slot && contacts.b[i] != slot) continue;
    const bool sound = std::isfinite(contacts.gap[i]) && (i >= contacts.force.size() || contacts.force[i].allFinite());
    const double bad = sound ? -contacts.gap[i] : std::numeric_limits<double>::infinity();
    if (count++ == 0 || bad > badness) {
      worst = i;
      badness = bad;
    }
  }
  if (count == 0) return "; no contact";
  const Slot other = contacts.a[worst] == slot ? contacts.b[worst] : contacts.a[worst];
  char text[160];
  std::snprintf(text, sizeof text, "; %zu contacts, the worst with body %u: gap %g m", count,
                static_cast<unsigned>(world.id[other]), contacts.gap[worst]);
  std::string out = text;
  if (worst < contacts.force.size()) {
    const Vec3& f = contacts.force[worst];
    std::snprintf(text, sizeof text, ", force (%g, %g, %g) N", f.x(), f.y(), f.z());
    out += text;
  }
  return out;
}

}  // namespace

void Simulation::start() {
  sort_bodies();
  count_movable();
  if (loads) loads->set(world, world.clock);
  if (pipeline.scheme->needs_initial_forces())
    evaluate_forces(world, pipeline, work);
  else
    pipeline.contact_model->store(world, work.report);
  ledger.start(world, work.report, work.report.losses);
  const bool watched = step_is_watched();
  observe(false, watched);
  if (watched) static_cast<void>(check_step());  // a single check ends no run
}

/// Valid forces are kept bit for bit, so a stage without changes has no effect.
void Simulation::enter(const Entry& entry) {
  count_movable();
  if (loads) loads->set(world, world.clock);
  work.report.elastic = entry.elastic;
  if (!entry.forces_hold) {
    if (pipeline.scheme->needs_initial_forces()) {
      evaluate_forces(world, pipeline, work);
    } else {
      work.report.elastic = 0.0;
      pipeline.contact_model->store(world, work.report);
    }
  }
  const bool watched = (!entry.forces_hold || entry.new_ledger) && step_is_watched();
  if (entry.new_ledger) {
    ledger.start(world, work.report, entry.forces_hold ? Losses{} : work.report.losses);
    observe(false, watched);
  } else {  // this step has been seen
    ledger.take_elastic(work.report);
    ledger.accept_jump(world, entry.stored_before);
  }
  if (watched) static_cast<void>(check_step());
}

std::optional<Failure> Simulation::advance(bool last, bool run_on) {
  StageTimer timer(work.report.seconds);
  if (parts_of_step) gather_state();
  int parts = parts_of_step ? parts_of_step(world) : 1;
  if (step_watch) parts = std::max(parts, step_watch->parts());
  double deepest = 0.0, relative = 0.0;
  const bool sort = sorts_now();
  ++steps_;
  work.report.deepest_relative = 0.0;
  for (int part = 0; part < parts; ++part) {
    auto failure = make_step(time_step / parts, sort && part == 0, run_on && !last && is_unobserved(), timer);
    if (failure) return failure;
    deepest = std::max(deepest, work.report.deepest);
    relative = std::max(relative, work.report.deepest_relative);
  }
  work.report.deepest = deepest;
  work.report.deepest_relative = relative;
  parts_made_ += static_cast<std::uint64_t>(parts);
  timer.lap(Stage::events);
  const bool watched = step_is_watched();
  observe(last, watched);
  timer.lap(Stage::output);
  auto failure = watched ? check_step() : std::nullopt;
  if (!failure) failure = check_energy();
  timer.lap(Stage::events);
  return failure;
}

/// True if step_watch reads contacts now.
bool Simulation::step_is_watched() {
  if (!step_watch) return false;
  step_watch->note(steps_, work.report.deepest);
  if (!step_watch->is_due(steps_)) return false;
  return !away_.stepped || !step_watch->passes(steps_, remote->stiffness(time_step / step_watch->parts()));
}

std::optional<Failure> Simulation::check_step() {
  std::optional<Failure> failure;
  const auto look = [&](const StepView& now) { failure = step_watch->look(now); };
  if (!away_.stepped) {
    show_contacts(ContactView::pieces, false, look);
  } else {
    remote->fetch_seen(*this, ContactView::pieces);
    look({world, work.contacts, work.pairs, work.report, ledger, steps_, time_step, movable_, false, nullptr});
  }
  return failure;
}

/// True if no observer reads anything between this step and the next one.
bool Simulation::is_unobserved() const {
  if (parts_of_step || pipeline.guard || loads || sorts_now()) return false;
  if (step_watch && (step_watch->parts() > 1 || step_watch->is_due(steps_))) return false;
  return std::none_of(observers.begin(), observers.end(), [this](const auto& o) {
    return o->wants_bodies(steps_) || o->wants_energy(steps_) || o->wants_contacts(steps_, false) != ContactView::none;
  });
}

/// The domain as this step checks it: none between two searches for bodies to remove. Bodies that are outside from the
/// start are found in the first step.
const std::optional<Domain>& Simulation::watched() const {
  static const std::optional<Domain> none;
  const std::uint64_t step = steps_ + before_;
  const bool looks = step <= 1 || step % outlet_interval() == 0;
  return domain && domain->outside == Domain::Outside::remove && !looks ? none : domain;
}

/// Whatever changes the bodies between two steps.
void Simulation::prepare(double dt, bool sort) {
  const std::size_t before = world.size();
  const double power = held_power();
  for (auto& event : events) event->before_step(world, dt, leaving_);
  // contacts book their first half by the velocities of the last step
  ledger.add_work(0.5 * dt * (held_power() - power));
  if (world.size() > before) welcome(before);
  if (!leaving_.empty()) take_out();
  if (sort) sort_bodies();
}

double Simulation::held_power() const {
  if (!world.columns().held_force) return 0.0;
  return block_sum<double>(world.size(), [&](std::size_t s) {
    if (world.is_movable(static_cast<Slot>(s))) return 0.0;
    const double turn = world.rotates() ? world.torque[s].dot(world.angular_velocity[s]) : 0.0;
    return -world.force[s].dot(world.velocity[s]) - turn;
  });
}

std::optional<Failure> Simulation::make_step(double dt, bool sort, bool run_on, StageTimer& timer) {
  if (remote) return make_remote_step(dt, sort, run_on, timer);
  prepare(dt, sort);
  const double relative = work.report.deepest_relative;  // of earlier parts
  const bool rest = run_on && std::ranges::all_of(events, [&](const auto& e) { return e->rests_next(world, dt); });
  const RunOn leave{[this](const Extent& seen) { return seen.is_inside(watched()); }, domain.has_value(), rest};
  if (loads) loads->before_step(world, dt);
  timer.lap(Stage::events);
  // a body that leaves the domain ends the run: then this step is read
  step(world, pipeline, work, dt, timer, rest || (run_on && !watched()) ? &leave : nullptr);
  work.report.deepest = block_max<double>(work.contacts.size(), work.report.deepest,
                                          [&](std::size_t k) { return -work.contacts.gap[k]; });
  work.report.deepest_relative = std::max(work.report.deepest_relative, relative);
  ledger.add(work.report, dt * world.gravity.norm());
  if (loads) ledger.add_work(loads->after_step(world, dt));
  return watch();
}

/// Gathers the state only if something needs it here.
std::optional<Failure> Simulation::make_remote_step(double dt, bool sort, bool run_on, StageTimer& timer) {
  if (sort || !leaving_.empty() || !away_.rest || dt != away_.dt) {
    if (!std::exchange(away_.home, true)) remote->fetch(*this, true);
    away_.sent = false;
    prepare(dt, sort);
  }
  if (!std::exchange(away_.sent, true)) remote->send(*this);
  away_.rest = std::ranges::all_of(events, [&](const auto& e) { return e->is_local() || e->rests_next(world, dt); });
  away_.dt = dt;
  away_.home = false;
  away_.stepped = true;
  if (loads) loads->set(world, world.clock + 0.5 * dt);  // the other processes apply those of the bodies
  work.contacts.clear();
  timer.lap(Stage::events);
  const double booked = work.report.seconds.all();
  const bool sound = remote->step(dt, watched(), run_on && away_.rest, work.report);
  timer.lap(Stage::events, work.report.seconds.all() - booked);
  world.time += dt;
  world.clock += dt;
  world.fallen += dt * world.gravity;
  ledger.add(work.report, dt * world.gravity.norm());
  if (sound) return std::nullopt;
  gather_state();
  remote->fetch_seen(*this, ContactView::all);
  return check_positions();
}

void Simulation::gather_state() {
  if (!std::exchange(away_.home, true)) remote->fetch(*this, false);
}

/// Bodies from slot `before` on have entered: their energy is work done on the scene.
void Simulation::welcome(std::size_t before) {
  double kinetic = 0.0, potential = 0.0;
  for (std::size_t s = before; s < world.size(); ++s) {
    kinetic += kinetic_energy(world, static_cast<Slot>(s));
    potential += potential_energy(world, static_cast<Slot>(s));
  }
  ledger.accept_bodies(kinetic, potential);
  count_movable();
  for (const auto& o : observers) o->bodies_come(world, before);
}

void Simulation::count_movable() {
  movable_ = static_cast<std::size_t>(
      std::count_if(world.inverse_mass.begin(), world.inverse_mass.end(), [](double m) { return m > 0; }));
}

void Simulation::sort_bodies() { reorder(world.reorder(morton_order(world))); }

void Simulation::reorder(const Reordering& change) {
  pipeline.each_stage([&](auto& stage) { stage.reorder(change); });
  work.contacts.clear();  // they have the old slots
}

void Simulation::take_out() {
  std::sort(leaving_.begin(), leaving_.end());
  leaving_.erase(std::unique(leaving_.begin(), leaving_.end()), leaving_.end());
  for (const auto& o : observers) o->bodies_leave(world, leaving_);
  ledger.measure(world);
  const double before = ledger.stored(world);
  reorder(world.remove(leaving_));
  removed_ += leaving_.size();
  leaving_.clear();
  count_movable();
  drop_contacts();
  ledger.accept_jump(world, before);
}

/// Removes the elastic energy of contacts of removed bodies: evaluates the contacts again with dt = 0, which does not
/// change their history or the forces of the step. Impulses store no energy, springs do.
void Simulation::drop_contacts() {
  if (!pipeline.scheme->needs_initial_forces()) {
    work.report.elastic = 0.0;
    pipeline.contact_model->store(world, work.report);
    return ledger.take_elastic(work.report);
  }
  const auto force = world.force, torque = world.torque;
  evaluate_forces(world, pipeline, work);
  world.force = force;
  world.torque = torque;
  ledger.take_elastic(work.report);
}

std::optional<Failure> Simulation::watch() {
  if (work.report.has_solver && !std::isfinite(work.report.solver.residual))
    return Failure{"non-finite state", steps_, std::nullopt,
                   "the solver's residual became non-finite in step " + std::to_string(steps_) +
                       ": masses, impulses or speeds exceed the range of numbers"};
  if (const SolverTrouble& trouble = work.report.trouble; trouble.kind == SolverTrouble::Kind::beyond_measure)
    return Failure{"state without measure", steps_, world.id[trouble.slot], trouble.text};
  const Extent* seen = pipeline.contact_model->extent();
  if (seen && (is_ahead() ? seen->finite : seen->is_inside(watched()))) return std::nullopt;
  return check_positions();
}

std::optional<Failure> Simulation::check_positions() {
  const auto strays = find_strays(world, watched());
  for (Slot s : strays) {
    const Vec3 &x = world.position[s], &v = world.velocity[s];
    char text[256];
    if (!is_finite(world, s)) {
      std::snprintf(text, sizeof text,
                    "body %u became non-finite in step %llu: position (%g, %g, %g) m, velocity (%g, %g, %g) m/s",
                    static_cast<unsigned>(world.id[s]), static_cast<unsigned long long>(steps_), x.x(), x.y(), x.z(),
                    v.x(), v.y(), v.z());
      return Failure{"non-finite state", steps_, world.id[s], text + suspect_of(world, work.contacts, s)};
    }
    if (domain->outside == Domain::Outside::error) {
      std::snprintf(text, sizeof text,
                    "body %u left the domain in step %llu at (%g, %g, %g) m with velocity (%g, %g, %g) m/s",
                    static_cast<unsigned>(world.id[s]), static_cast<unsigned long long>(steps_), x.x(), x.y(), x.z(),
                    v.x(), v.y(), v.z());
      return Failure{"lost body", steps_, world.id[s], text};
    }
    leaving_.push_back(world.id[s]);
  }
  return std::nullopt;
}

std::optional<Failure> Simulation::check_energy() {
  if (std::isfinite(ledger.last().stored())) return std::nullopt;
  gather_state();
  Slot fastest = 0;
  for (Slot s = 1; s < world.size(); ++s)
    if (world.velocity[s].stableNorm() > world.velocity[fastest].stableNorm()) fastest = s;
  const Vec3& v = world.velocity[fastest];
  const Energy& e = ledger.last();
  char text[256];
  std::snprintf(
      text, sizeof text,
      "the energy became non-finite in step %llu: kinetic %g, potential %g, elastic %g J; the fastest is body %u "
      "with velocity (%g, %g, %g) m/s",
      static_cast<unsigned long long>(steps_), e.kinetic, e.potential, e.elastic,
      static_cast<unsigned>(world.id[fastest]), v.x(), v.y(), v.z());
  return Failure{"non-finite state", steps_, world.id[fastest], text};
}

BodyTotals Simulation::totals() { return away_.home ? body_totals(world) : remote->totals(false).bodies; }

void Simulation::observe(bool last, bool watched) {
  bool energy = false, any = false, bodies = false;
  ContactView contacts = ContactView::none;
  for (const auto& o : observers) {
    if (!last && !o->is_due(steps_)) continue;
    any = true;
    energy = energy || last || o->wants_energy(steps_);
    bodies = bodies || last || o->wants_bodies(steps_);
    contacts = std::max(contacts, o->wants_contacts(steps_, last));
  }
  if (!any) return;
  const bool sums = contacts >= ContactView::overlaps;
  overlaps_.reset();
  if (!away_.stepped) {
    if (energy) totals_ = body_totals(world);
  } else {
    if (energy || sums) {
      const RemoteTotals all = remote->totals(sums);
      totals_ = all.bodies;
      if (sums) overlaps_ = all.overlaps;
    }
    const ContactView seen = watched ? std::max(contacts, ContactView::pieces) : contacts;
    if (bodies || seen >= ContactView::pieces) remote->fetch_seen(*this, seen);
  }
  if (energy) ledger.measure(totals_);
  show_contacts(contacts, last, [&](StepView now) {
    if (energy) now.bodies = &totals_;
    if (overlaps_) now.overlaps = &*overlaps_;
    for (const auto& o : observers)
      if (last || o->is_due(steps_)) o->observe(now);
  });
}

void Simulation::show_contacts(ContactView needed, bool last, const std::function<void(const StepView&)>& show) {
  const ContactModel* model = pipeline.contact_model.get();
  if (away_.stepped) {
    if (needed >= ContactView::pieces) remote->fetch_seen(*this, needed);
    model = nullptr;  // all are in the set
  } else if (needed == ContactView::all) {
    pipeline.contact_model->publish(world, work.contacts);
  }
  show({world, work.contacts, work.pairs, work.report, ledger, steps_, time_step, movable_, last, model});
}

void Simulation::show(Observer& observer) {
  gather_state();
  show_contacts(observer.wants_contacts(steps_, true), true, [&](const StepView& now) { observer.observe(now); });
}

void Simulation::visit(StateVisitor& visitor) {
  gather_state();
  away_.sent = away_.rest = false;  // the loaded state may differ
  visitor.value("simulation/steps", steps_);
  visitor.value("simulation/removed", removed_);
  if (visitor.has("simulation/steps_before")) visitor.value("simulation/steps_before", before_);
  if (parts_of_step || step_watch) visitor.value("simulation/parts", parts_made_);
  if (step_watch) step_watch->visit(visitor);
  visitor.column("simulation/leaving", leaving_);
  pipeline.each_stage([&](auto& stage) { stage.visit(visitor); });  // first: many springs take less room after it
  world.visit(visitor);
  ledger.visit(visitor);
  visitor.value("simulation/elastic", work.report.elastic);
  visitor.value("simulation/movable", movable_);
  warnings.visit(visitor);
  for (auto& event : events) event->visit(visitor);
  for (auto& observer : observers) observer->visit(visitor);
}

}  // namespace epafi
