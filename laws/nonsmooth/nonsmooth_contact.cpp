#include "laws/nonsmooth/nonsmooth_step.h"

#include <algorithm>

#include "engine/threads/order_free_sum.h"
#include "engine/threads/parallel_order.h"
#include "engine/units/error.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {

constexpr double impact_threshold = 2.0;  // of |g| dt, see the header
constexpr double slow_share = 0.5;        // of that: for located impacts, which are exact
constexpr double calm_from = 0.01;        // of the tolerance: pyramids of 20 to 70 rows come to rest without iterations
constexpr double creep = 1e-3;            // of the threshold
constexpr double touching_share = 1e-9;   // a gap that closes within this share of the step counts as closed

}  // namespace

/// Servo walls become bodies of the problem, before its contacts.
void NonsmoothContact::guide(const World& world) {
  for (const auto& wall : walls_) {
    const Slot s = world.slot_of(wall->body);
    if (s == no_slot || wall->mobility <= 0.0) continue;
    const Vec3& direction = wall->servo.direction;
    before_.linear[s] = world.velocity[s] - wall->speed * direction;
    problem_.guide(s, direction, before_.linear[s], wall->free_speed, wall->mobility);
    before_.angular[s] = wall->speed * problem_.guides.back().axis;
  }
}

/// Sets up the problem of this step and u_k, the velocities before it.
void NonsmoothContact::load(const World& world, const ContactSet& contacts, const StepClock& clock) {
  const double dt = clock.dt;
  problem_.load_bodies(world, dt, clock.pushes);
  parallel_copy(world.velocity, before_.linear);
  parallel_copy(world.angular_velocity, before_.angular);
  guide(world);
  problem_.load_contacts(world, contacts);
  renew(u_before_, contacts.size());
  renew(restitution_, contacts.size());
  const double threshold = impact_threshold * world.gravity.norm() * dt;
  if (balances_) balance_.begin(contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    const Slot a = contacts.a[i], b = contacts.b[i];
    const MaterialPair& pair = materials_.of(world.material[a], world.material[b]);
    const double gap = contacts.gap[i];
    problem_.friction[i] = pair.friction;
    problem_.offset[i] = std::max(0.0, gap / dt);
    u_before_[i] = problem_.relative_velocity(i, before_);
    const double approach = -u_before_[i].x();
    if (balances_ && -approach <= threshold)  // see the header: Energy
      problem_.offset[i] = std::max(problem_.offset[i], -approach);
    restitution_[i] = pair.restitution;
    const double slowest = balances_ ? slow_share * threshold : threshold;
    if (impacts_.separate() || pair.restitution <= 0.0 || approach <= slowest) return;
    const double free_approach = -problem_.relative_velocity(i, problem_.free).x();
    if (gap > 0.0 && gap >= dt * free_approach) return;
    const double middle = 0.5 * (approach + free_approach);  // impact speed at the middle of the step
    const double half = 0.5 * (free_approach - approach);
    if (approach > threshold) problem_.offset[i] = -std::max(0.0, pair.restitution * middle - half);
    if (balances_) balance_.note(i, {middle, half, pair.restitution});
  });
}

/// Change of the slip of contact i by driven bodies since the last step, in its frame.
Vec3 NonsmoothContact::driven_change(std::size_t i) const {
  const Slot a = problem_.a[i], b = problem_.b[i];
  Vec3 change = driven_.change(b, problem_.arm_b[i]) - driven_.change(a, problem_.arm_a[i]);
  change = problem_.to_frame(i, change);
  return {0.0, change.y(), change.z()};
}

/// Starts from the impulses of the last step, even after an impact. Taking r = 0 if its residual is smaller would
/// choose 0 in five of six steps of a settling pile (the residual is relative to one step of gravity, not to the load),
/// and 200 polyhedra would never come to rest with 50 sweeps.
void NonsmoothContact::start(const World& world, const ContactSet& contacts, double dt) {
  if (!warm_start_) return r_.assign(contacts.size(), Vec3::Zero());
  memory_.recall(world, contacts, problem_, r_);
  if (!memory_.same()) solver_->forget();
  if (problem_.rotates) parallel_fill(problem_.lag, contacts.size(), Vec3(Vec3::Zero()));
  driven_.look(world);
  parallel_for(contacts.size(), [&](std::size_t i) {  // rolling, see the header
    if (const auto slip = memory_.slip(i); slip && problem_.rotates && problem_.friction[i] > 0.0) {
      Vec3 now(0.0, u_before_[i].y(), u_before_[i].z());
      if (driven_.changed()) now -= driven_change(i);
      Vec3 turned =
          now - problem_.to_frame(i, *slip);  // change by geometry alone: both have the velocities of the last step
      turned.x() = 0.0;
      const double size = turned.norm(), most = 2.0 * now.norm();
      problem_.lag[i] = (size > most ? 0.5 * most / size : 0.5) * turned;
    }
    if (contacts.gap[i] >= 0.0 || problem_.offset[i] < 0.0) return;
    const double missed = memory_.predicted_gap(i) - contacts.gap[i], approach = -u_before_[i].x();
    if (balances_ && approach <= 0.0) return;
    problem_.offset[i] = -std::clamp(missed / dt, 0.0, std::max(0.0, approach));
  });
}

/// Excludes open contacts that only an impact elsewhere closes; they close and bounce in the next step. Stopped at u_N
/// = -g/dt they would remove the restitution from every chain of impacts (an elastic heap of 216 balls would lose 2 %
/// of its energy in 2 s). Returns false if there are none.
bool NonsmoothContact::release_induced(const World& world, const ContactSet& contacts, double dt) {
  const double threshold = impact_threshold * world.gravity.norm() * dt;
  const auto released = [&](std::size_t i) -> char {
    if (problem_.offset[i] < 0.0 || r_[i].x() <= 0.0) return 0;
    const double stopped = r_[i].x() * problem_.mobility[i];
    if (stopped <= threshold) return 0;
    // closed: gravity or rounding alone would close it in a step. A support whose gap is rounding may carry many times
    // the load of one body; if it were excluded, a stack at rest would fall for a step, repeatedly
    const bool rests = u_before_[i].x() <= threshold && contacts.gap[i] <= threshold * dt;
    if (rests || contacts.gap[i] <= touching_share * dt * stopped) return 0;
    if (materials_.of(world.material[contacts.a[i]], world.material[contacts.b[i]]).restitution <= 0.0) return 0;
    problem_.leave_out(i);  // out of this step's problem
    r_[i].setZero();
    return 1;
  };
  return block_max<char>(contacts.size(), 0, released) != 0;
}

/// Computes r_ and, by predict(), velocities and gaps.
SolverReport NonsmoothContact::solve(const World& world, const ContactSet& contacts, double dt) {
  SolverReport report{true, 0, infinity};
  const double good = solver_->good_start();
  if (good > 0.0) {
    predict(contacts, dt);
    free_motion_ = measure_free_motion(problem_);
    report.residual = measure_residual(problem_, r_, u_, rho_, free_motion_).value;
    parallel_copy(r_, start_);
    parallel_copy(u_after_, u_start_);
  }
  start_residual_ = report.residual;
  solved_ = start_residual_ > good;
  const auto solve = [&] {
    problem_.load_diagonal();
    report.iterations += solver_->solve(problem_, r_).iterations;
  };
  if (solved_) solve();
  if (solved_ && !problem_.guides.empty()) even_pressure(contacts, dt, solve);
  for (int pass = 0; pass < 3 && release_induced(world, contacts, dt); ++pass) {
    solve();
    solved_ = true;
  }
  if (balances_ && balance_.any()) {
    balance(contacts, dt, solve);
    solved_ = true;
  }
  if (solved_) {
    predict(contacts, dt);
    free_motion_ = measure_free_motion(problem_);  // without the contacts that were released
    report.residual = measure_residual(problem_, r_, u_, rho_, free_motion_).value;
  }
  report.converged = report.residual <= tolerance_;
  // not the solver's residual: the correction of a gain within its tolerance changes the impulses
  if (balances_ && balance_.any() && balance_.clip({problem_, r_, u_struck_, u_after_}, r_)) predict(contacts, dt);
  return report;
}

/// Solves again from evenly distributed loads of servo walls. Friction changes with them and may shift them again, less
/// each time.
void NonsmoothContact::even_pressure(const ContactSet& contacts, double dt, const std::function<void()>& solve) {
  constexpr int rounds = 3;
  constexpr double touching = 1e-3;  // of the largest speed that impulses change
  const double slow = touching * measure_free_motion(problem_).largest;
  for (int round = 0; round < rounds; ++round) {
    predict(contacts, dt);
    if (!even_pressure_.apply(problem_, u_, slow, r_)) return;
    solve();
  }
}

/// Solves again while friction in impacts of some island creates energy.
void NonsmoothContact::balance(const ContactSet& contacts, double dt, const std::function<void()>& solve) {
  const ImpactBalance::Solved solved{problem_, r_, u_struck_, u_after_};
  predict(contacts, dt);
  balance_.find_islands(solved);
  while (balance_.tighten(solved, tolerance_, problem_)) {
    solve();
    predict(contacts, dt);
  }
}

/// Start of the next step. Not the solution, which also corrects velocity errors of earlier steps that do not recur: a
/// resting stack of 100 that starts from it needs an iteration in every other step for ever. Instead, the impulses
/// between this step's start and its solution that change velocities least, corrected by the solver (`calm`). Good
/// starts are corrected too, which stops creep: under constant impulses columns of cubes buckle, 1.5 times faster in
/// each step. The correction is used only if the next step then starts closer, since it ignores contacts about to open
/// (without this test every second pyramid never comes to rest). The solution itself is used if the start was far off
/// (else pyramids never settle), and for sweeps, which continue from step to step.
const Impulses& NonsmoothContact::calmest(double creep) {
  const bool calm = solver_->calms();
  if (start_residual_ > tolerance_ || (!solved_ && !(calm && start_residual_ > calm_from * tolerance_))) return r_;
  double share = 1.0;
  if (solved_) {
    const auto [along, square] = order_free_sums<2>(problem_.size(), [&](std::size_t i) {
      const Vec3 way = u_start_[i] - u_after_[i];
      return std::array{way.dot(u_start_[i] - u_before_[i]), way.squaredNorm()};
    });
    share = square.sum > 0.0 ? std::clamp(along.sum / square.sum, 0.0, 1.0) : 1.0;
  }
  parallel_for(problem_.size(), [&](std::size_t i) {
    const bool open = r_[i].isZero(0.0);
    start_[i] = open ? r_[i] : Vec3(start_[i] + share * (r_[i] - start_[i]));
    u_start_[i] += share * (u_after_[i] - u_start_[i]) - u_before_[i];
    if (!solved_ && !open && u_[i].norm() < creep) u_start_[i] += u_[i];
  });
  if (!calm) return start_;
  parallel_copy(start_, calmed_);
  solver_->calm(u_start_, calmed_);
  if (solved_) problem_.velocities(start_, calmed_velocities_);
  const double before = predicted_residual(start_, solved_ ? &calmed_velocities_ : nullptr);
  problem_.velocities(calmed_, calmed_velocities_);
  return predicted_residual(calmed_, &calmed_velocities_) < before ? calmed_ : start_;
}

/// Residual with which the next step would start from r if bodies did not move: r changes its velocities as it would
/// have changed those of this step, to v; null: to the velocities at the end of this step.
double NonsmoothContact::predicted_residual(const Impulses& r, const BodyVelocities* v) {
  renew(u_next_, r.size());
  parallel_for(r.size(), [&](std::size_t i) {
    const Vec3 change = (v ? problem_.relative_velocity(i, *v) : u_after_[i]) - u_before_[i];
    u_next_[i] = problem_.with_offset(i, u_after_[i] + change);
  });
  return measure_residual(problem_, r, u_next_, rho_, free_motion_).value;
}

/// Forces and energy of the step: bodies receive r.(u_k + u_{k+1})/2; the part by motion of driven bodies is their
/// work.
void NonsmoothContact::account(const World& world, ContactSet& contacts, double dt, StepReport& report) const {
  renew(contacts.force, contacts.size());
  if (contacts.with_moment) contacts.moment.assign(contacts.size(), Vec3::Zero());
  const auto driven = [&](Slot s, const Vec3& arm) -> Vec3 {
    if (world.is_movable(s)) return Vec3::Zero();
    Vec3 v = world.rotates() ? Vec3(world.velocity[s] + world.angular_velocity[s].cross(arm)) : world.velocity[s];
    for (const Guide& g : problem_.guides)
      if (g.slot == s) v += 0.5 * (g.speed(after_) - g.speed(before_)) * g.direction;
    return v;
  };
  const auto sums = block_sum<Sum3>(problem_.size(), [&](std::size_t i) {
    const Vec3 mean = 0.5 * (u_before_[i] + u_after_[i]);
    const Vec3 none = Vec3::Zero(), impulse = problem_.to_world(i, r_[i]);
    contacts.force[i] = -impulse / dt;
    const Vec3 wall = driven(problem_.b[i], problem_.rotates ? problem_.arm_b[i] : none) -
                      driven(problem_.a[i], problem_.rotates ? problem_.arm_a[i] : none);
    return Sum3{-r_[i].dot(mean), -impulse.dot(wall), r_[i].x() > 0.0 ? 1.0 : 0.0};
  });
  report.dissipated = sums.a;
  report.work = sums.b;
  report.touching = static_cast<std::size_t>(sums.c);
}

/// Located impacts change arms and velocities.
void NonsmoothContact::see_strikes() {
  parallel_for(u_struck_.size(), [&](std::size_t i) {
    u_before_[i] = problem_.relative_velocity(i, before_);
    u_struck_[i] = u_before_[i] + problem_.relative_velocity(i, impacts_.struck());
  });
}

/// Adds the step's impulses; the velocities contain those of impacts already.
void NonsmoothContact::add_impacts() {
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] += impacts_.impulses()[i];
  parallel_for(moments_.size(), [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    if (problem_.is_free(s)) moments_[k] = problem_.impulse_on(s, r_).angular;
  });
}

void NonsmoothContact::write_back(World& world, const StepClock& clock) const {
  parallel_copy(after_.linear, world.velocity);
  parallel_for(world.rotates() ? world.size() : 0, [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    if (!world.is_movable(s)) return;
    if (clock.pushes) world.apply_angular_impulse(s, clock.pushes->angular[k]);
    if (problem_.incidence.count(s) > 0) world.apply_angular_impulse(s, moments_[k]);
    if (world.columns().external_torque) world.apply_angular_impulse(s, clock.dt * world.external_torque[k]);
  });
}

/// Ends the step of servo walls with the speeds that result from contacts.
void NonsmoothContact::move_walls(World& world, double dt) const {
  for (const Guide& guide : problem_.guides) {
    const auto found = std::ranges::find(walls_, world.id[guide.slot], [](const auto& wall) { return wall->body; });
    NonsmoothServo& wall = **found;
    wall.end(guide.speed(after_), dt);
    world.velocity[guide.slot] = before_.linear[guide.slot] + wall.speed * guide.direction;
  }
}

/// Computes v_{k+1}, u_{k+1} (with w as in the problem), and from it the gaps at the next detection.
void NonsmoothContact::predict(const ContactSet& contacts, double dt) {
  problem_.velocities(r_, after_, &moments_);
  renew(u_, contacts.size());
  renew(u_after_, contacts.size());
  renew(next_gap_, contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    u_after_[i] = problem_.relative_velocity(i, after_);
    u_[i] = problem_.with_offset(i, u_after_[i]);
    next_gap_[i] = contacts.gap[i] + dt * u_after_[i].x();
  });
}

/// The gaps at the next detection, with the displacements by located impacts.
void NonsmoothContact::predict_displacement() {
  parallel_for(next_gap_.size(),
               [&](std::size_t i) { next_gap_[i] += problem_.relative_velocity(i, impacts_.displacement()).x(); });
}

void NonsmoothContact::act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  EPAFI_REQUIRE(clock.dt > 0.0, "non-smooth contact acts over a time step");
  load(world, contacts, clock);
  rho_ = problem_.mean_effective_mass();
  start(world, contacts, clock.dt);
  report.contacts = contacts.size();
  report.has_solver = true;
  report.elastic = 0.0;
  report.servo_energy = 0.0;
  for (const auto& wall : walls_) report.servo_energy += wall->free_energy(clock.dt);
  report.losses = {};
  const double threshold = impact_threshold * world.gravity.norm() * clock.dt;
  if (impacts_.separate()) problem_.load_diagonal();
  const Impacts::Step step{contacts.gap, restitution_, before_,
                           threshold,    clock.dt,     solver_->displacement() == nullptr};
  const bool located = impacts_.separate() && impacts_.apply(problem_, step, *solver_);
  const bool bounces = balances_ && balance_.any();
  const bool single = bounces && impacts_.strike_single(problem_, step, balance_);
  if (bounces) parallel_copy(u_before_, u_struck_);
  if (single) see_strikes();
  solver_->see(world, before_, contacts, clock.dt);
  report.solver = solve(world, contacts, clock.dt);
  if (single) predict_displacement();
  report.trouble = look_for_trouble(report.solver);
  // impacts do not recur: r_ without them
  if (warm_start_) memory_.remember(world, contacts, problem_, calmest(creep * threshold), next_gap_, u_after_);
  with_impacts_ = located || single;
  if (with_impacts_) add_impacts();
  account(world, contacts, clock.dt, report);
  write_back(world, clock);
  move_walls(world, clock.dt);
  if (warm_start_) driven_.remember(world);
  // r.(u_k + u_{k+1})/2 assumes an impact in the middle of the step
  if (with_impacts_) report.dissipated -= displace(world, problem_, impacts_.displacement());
  const BodyVelocities* own = solver_->displacement();
  report.correction = own ? displace(world, problem_, *own) : correction_.apply(problem_, contacts, next_gap_, world);
}

void add_nonsmooth_servo(ContactModel& model, std::shared_ptr<NonsmoothServo> wall) {
  auto* contact = dynamic_cast<NonsmoothContact*>(&model);
  EPAFI_REQUIRE(contact != nullptr, "walls give way in non-smooth contact");
  contact->add(std::move(wall));
}

const ContactProblem* last_problem(const ContactModel& model) {
  const auto* contact = dynamic_cast<const NonsmoothContact*>(&model);
  return contact != nullptr ? &contact->problem() : nullptr;
}

std::string solver_advice(const ContactModel& model) {
  const auto* contact = dynamic_cast<const NonsmoothContact*>(&model);
  return contact != nullptr ? contact->advice() : std::string();
}

std::vector<float> contact_residuals(const ContactModel& model) {
  const auto* contact = dynamic_cast<const NonsmoothContact*>(&model);
  return contact != nullptr ? contact->residuals() : std::vector<float>();
}

std::uint64_t impact_count(const ContactModel& model) {
  const auto* contact = dynamic_cast<const NonsmoothContact*>(&model);
  return contact != nullptr ? contact->impacts().events() : 0;
}

Needs nonsmooth_needs(const NonsmoothSetup& setup) {
  const bool friction = std::any_of(setup.materials.pairs.begin(), setup.materials.pairs.end(),
                                    [](const MaterialPair& pair) { return pair.friction > 0.0; });
  return {.rotation = friction, .slip_velocity = friction, .memory = true, .manifold = true};
}

std::unique_ptr<ContactModel> make_nonsmooth_contact(const NonsmoothSetup& setup, const SolverEntry& solver) {
  return std::make_unique<NonsmoothContact>(setup, solver);
}

std::unique_ptr<ContactModel> make_nonsmooth_contact(const NonsmoothSetup& setup) {
  std::string names;
  for (const SolverEntry& solver : all_solvers()) {
    if (solver.entry.name == setup.solver) return make_nonsmooth_contact(setup, solver);
    names += (names.empty() ? "" : ", ") + solver.entry.name;
  }
  throw SceneError("unknown non-smooth solver '" + setup.solver + "'; there are: " + names);
}

}  // namespace epafi
