#include "laws/smooth/fused/fused_spheres.h"

#include <cmath>
#include <span>
#include <utility>

#include "engine/lanes/targets.h"
#include "engine/ranks/shared_model.h"
#include "engine/state/touched_bodies.h"
#include "engine/threads/parallel_order.h"
#include "engine/threads/parallel_wavefront.h"
#include "laws/smooth/fused/block_task.h"
#include "laws/smooth/fused/body_pass.h"
#include "laws/smooth/fused/sphere_contacts.h"
#include "laws/smooth/smooth_law.h"

namespace epafi {

namespace {

/// Free spheres and all others.
class FusedModel final : public FusedSpheres, public SharedModel {
 public:
  FusedModel(const SmoothSetup& setup, double reach, std::size_t block_size)
      : law_(smooth_law(setup)),
        reach_(law_.holds ? reach : 0.0),
        generic_(make_smooth_contact(setup)),
        blocks_(law_.needs, block_size) {}

  const char* name() const override { return "fused spheres"; }
  std::size_t block_size() const override { return blocks_.block_size(); }
  bool waits_for_pairs() const override { return !blocks_.laid_out(); }
  void forget_margins() override { inverse_half_margin_ = {}; }
  void expect(const CommonMotion& drift) override {
    drift_ = drift;
    since_drift_ = 0.0;
  }
  void set_bodies(UnwrittenColumn<double> radius, std::size_t first) override {
    if (first > 0 && !radius_.empty()) {  // the bodies before them are not known yet
      EPAFI_REQUIRE(first_ + radius_.size() == first, "bodies come behind the others");
      for (const double r : radius) radius_.push_back(r);
      return;
    }
    radius_.swap(radius);
    first_ = first;
  }
  void set_pairs(const World& world, const SphereList& list) override {
    inverse_half_margin_ = list.inverse_half_margin;
    tells_forces_ = list.others || inverse_half_margin_.empty();
    blocks_.rebuild(world, list);
    find_owners(world, blocks_, owner_, counts_all_);
    if (!radius_.empty()) find_materials(world);
  }

  bool move(World& world, const StepClock& clock) override {
    if (!clock.scheme->has_ranges()) {
      displacements_.clear();
      return false;
    }
    if (blocks_.laid_out() && world.size() > blocks_.bodies()) {
      blocks_.welcome(world);
      inverse_half_margin_ = {};
    }
    if (blocks_.bodies() != world.size()) {
      displacements_.clear();
      return false;
    }
    predicted_ = true;
    if (std::exchange(ahead_, false)) return true;
    extents_.assign((world.size() + blocks_.block_size() - 1) / blocks_.block_size(), Extent{});
    largest_inverse_half_margin_.assign(extents_.size(), Vec3::Zero());
    const auto loop = best_loop<FirstHalf>();
    const bool balls = blocks_.laid_out() && !blocks_.balls().empty();
    parallel_blocks(world.size(), blocks_.block_size(), [&](std::size_t begin, std::size_t end, std::size_t i) {
      loop({pass(world, clock, begin, end, 0, extents_[i]), largest_inverse_half_margin_[i]});
      if (balls) blocks_.balls().place(world, lag(clock), blocks_.late_spins(), begin, end);
    });
    if (balls) blocks_.balls().set_placed();
    find_displacements(clock.dt);
    return true;
  }
  bool is_ahead() const override { return ahead_; }
  std::span<const double> largest_displacements() const override { return displacements_; }

  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override {
    published_ = false;
    const bool others = contacts.size() > 0 || others_;
    const bool balls = !blocks_.balls().empty();
    world.set_states_before(blocks_.balls().size());
    if (!radius_.empty()) {
      blocks_.set_constants(world, radius_, first_);
      release(radius_);
    }
    // reads the force of the last step: before the generic loop writes
    const bool predicts = !(predicted_ || std::exchange(has_states_, false)) || (balls && !blocks_.balls().placed());
    if (predicts)
      parallel_blocks(world.size(), blocks_.block_size(), [&](std::size_t begin, std::size_t end, std::size_t) {
        predict_bodies(world, lag(clock), blocks_.late_spins_of_bodies(), begin, end);
      });
    if (blocks_.take_new_balls() || (predicts && balls))
      blocks_.balls().place_all(world, lag(clock), blocks_.late_spins());
    has_extent_ = predicted_ && clock.scheme;
    predicted_ = false;
    is_touched_.assign(others || blocks_.balls().any_free() ? world.size() : 0, 0);
    if (others) {
      StepClock some = clock;
      some.touched = &is_touched_;
      generic_->act(world, contacts, some, report);
    } else {
      report.contacts = report.touching = 0;
      report.elastic = report.work = report.dissipated = 0.0;
      report.losses = {};
      report.has_solver = false;
    }
    others_ = contacts.size() > 0;  // one more call after the last contact has opened releases its spring
    const bool onward = has_extent_ && clock.run_on && clock.run_on->rests && clock.run_on->agrees(seen());
    run_blocks(world, clock, onward);
    count(clock.dt, report);
    drive(world, others, clock.dt, report);
    extent_ = seen();
    if (!onward) return;
    extents_.swap(next_extents_);
    ahead_ = true;
    find_displacements(clock.dt);
  }
  const Extent* extent() const override { return has_extent_ ? &extent_ : nullptr; }
  void publish(const World& world, ContactSet& contacts) const override {
    if (published_ || !blocks_.laid_out()) return;
    publisher_.add(world, blocks_, loads(world), contacts);
    published_ = true;
  }
  std::size_t own_parts() const override { return published_ || !blocks_.laid_out() ? 0 : blocks_.blocks().size(); }
  std::optional<std::size_t> own_count(std::size_t part) const override {
    if (reach_ > 0.0) return std::nullopt;
    return blocks_.blocks()[part].listed();
  }
  void append_gaps(const World& world, std::size_t part, ContactSet& gaps) const override {
    const SphereContacts all(world, blocks_);
    std::size_t at = gaps.size();
    const auto make_room = [&](std::size_t size) {
      gaps.a.resize(size);
      gaps.b.resize(size);
      gaps.gap.resize(size);
    };
    make_room(at + blocks_.blocks()[part].size);
    all.each(static_cast<std::uint32_t>(part), [&](const SphereContact& c) {
      gaps.a[at] = all.first(c);
      gaps.b[at] = all.second(c);
      gaps.gap[at++] = all.gap(c);
    });
    make_room(at);
  }
  void append_contacts(const World& world, std::size_t part, const Wanted& wanted,
                       ContactSet& contacts) const override {
    const SphereContacts all(world, blocks_);
    const SphereContacts::LoadOf load = loads(world);
    for (const SphereContact& c : all.sorted(static_cast<std::uint32_t>(part), wanted)) {
      const NamedContact n = all.named(c, load);
      contacts.append(n.a, n.b, n.point);
      contacts.force.push_back(n.on_a.force);
      if (contacts.with_moment) contacts.moment.push_back(n.on_a.moment);
    }
  }
  void add_virial(const World& world, Virial& virial) const override {
    for (const auto& block : blocks_.blocks())
      for (std::size_t k = 0; k < 3; ++k) virial.spheres[k] += block.virial[k];
    blocks_.balls().add_virial(world, virial.balls);
  }
  Extent begun() const override { return seen(); }
  bool tells_states(bool only_spheres) override { return tells_states_ = only_spheres && !law_.needs.damps_slip(); }
  void take_states() override { has_states_ = true; }
  void take_ghosts(World& world, std::span<const Slot> ghosts) override {
    const Vec3 common = drift_.velocity_at(since_drift_ - 0.5 * dt_);
    for (const Slot s : ghosts) {
      if (!tells_states_) {
        predict_bodies(world, lag_, blocks_.late_spins_of_bodies(), s, s + 1);
        blocks_.balls().place(world, lag_, blocks_.late_spins(), s, s + 1);
      }
      if (!knows_displacements()) continue;
      double& longest = displacements_[s / blocks_.block_size()];
      longest = std::max(longest, dt_ * double{inverse_half_margin_[s]} * (world.velocity[s] - common).norm());
    }
  }
  void reorder(const Reordering& change) override {
    generic_->reorder(change);
    blocks_.reorder(change);
  }
  void visit(StateVisitor& visitor) override {
    ahead_ = false;  // the loaded state may differ
    displacements_.clear();
    generic_->visit(visitor);
    blocks_.visit(visitor);
    visitor.share("spheres/others", others_);
    visitor.share("spheres/viscous_power", viscous_power_);
    visitor.share("spheres/driven_power", driven_power_);
    visitor.value("spheres/step", ratio_.last);
  }

 private:
  static_assert(TouchedBodies::block_size == SphereBlocks::largest_block, "threads share the same bodies out in both");
  static constexpr std::size_t most_accumulators = 64;  ///< of a thread; of two, 15 were in use in a bed of 100 000

  /// Time from the velocities of the world to those of the dampers [s].
  double lag(const StepClock& clock) const { return law_.damped ? clock.velocity_lag * clock.dt : 0.0; }

  BodyPass pass(World& world, const StepClock& clock, std::size_t begin, std::size_t end, std::size_t accumulator,
                Extent& extent) {
    return {world,
            world.states().data(),
            blocks_.late_spins_of_bodies(),
            blocks_.sums(accumulator),
            blocks_.moments(accumulator),
            blocks_.plain(),
            touched(),
            knows_displacements() ? inverse_half_margin_.data() : nullptr,
            tells_forces_ || !(world.owner.empty() || tells_states_),  // as they go to other processes
            drift_.velocity_at(since_drift_ + 0.5 * clock.dt),
            *clock.scheme,
            clock.dt,
            lag(clock),
            begin,
            end,
            clock.run_on == nullptr || clock.run_on->bounded,
            extent};
  }

  bool knows_displacements() const { return !inverse_half_margin_.empty(); }
  const std::uint8_t* touched() const { return is_touched_.empty() ? nullptr : is_touched_.data(); }

  void find_displacements(double dt) {
    since_drift_ += dt;
    displacements_.resize(knows_displacements() ? largest_inverse_half_margin_.size() : 0);
    for (std::size_t i = 0; i < displacements_.size(); ++i)
      displacements_[i] = dt * std::sqrt(largest_inverse_half_margin_[i].sum());
  }

  /// Whether all spheres have one material.
  void find_materials(const World& world) {
    const std::vector<BodyBall>& balls = blocks_.balls().all();
    if (first_ > 0 && own_ < law_.materials) {  // it was that of those before
      bool same = true;
      for (std::size_t k = 0; k < radius_.size(); ++k)
        same = same && !(radius_[k] > 0.0 && world.material[first_ + k] != own_);
      if (same) return;
      own_ = law_.materials;
    }
    if (first_ > 0) {
      material_.clear();
      if (!balls.empty()) blocks_.balls().by_place(world.material, material_);
      return;
    }
    const auto first = std::find_if(radius_.begin(), radius_.end(), [](double r) { return r > 0.0; });
    if (first == radius_.end() && balls.empty()) return;
    own_ = world.material[balls.empty() ? static_cast<std::size_t>(first - radius_.begin()) : balls.front().body];
    const auto differs = [&](std::size_t s) { return world.material[s] != own_; };
    const bool several =
        block_max<char>(radius_.size(), 0,
                        [&](std::size_t s) { return static_cast<char>(radius_[s] > 0.0 && differs(s)); }) != 0 ||
        std::ranges::any_of(balls, [&](const BodyBall& ball) { return differs(ball.body); });
    if (several) own_ = law_.materials;
    material_.clear();
    if (several && !balls.empty()) blocks_.balls().by_place(world.material, material_);
  }

  /// Of all bodies in this step.
  Extent seen() const {
    Extent all;
    for (const Extent& part : extents_) all += part;
    return all;
  }

  /// What every block reads and writes; its own sums and moments come on top.
  SphereArrays arrays_of(const World& world, const StepClock& clock, bool tells_energy) {
    const double late = lag(clock), ratio = late > 0.0 ? ratio_.next(clock.dt) : 1.0;
    SphereArrays arrays{
        blocks_.planes().data(), all_states(world), 0, clock.dt, late, ratio, law_.damped, tells_energy};
    arrays.owner = world.owner.empty() ? nullptr : owner_.data();
    arrays.passes = &passes_;
    if (law_.needs.damps_slip()) arrays.rolling = sphere_rolling();
    arrays.rows = law_.rows.data();
    arrays.reach = reach_;
    arrays.material = own_ < law_.materials ? nullptr : material_.empty() ? world.material.data() : material_.data();
    arrays.materials = law_.materials;
    arrays.own = own_;
    arrays.late_spins = blocks_.late_spins();
    arrays.offsets = blocks_.balls().offsets();
    arrays.balls = blocks_.balls().size();
    if (world.cell) {
      const Vec3 &size = world.cell->size, &rate = world.cell->strain_rate;
      arrays.cell_size = Lanes{size.x(), size.y(), size.z(), 0.0};
      arrays.strain_rate = Lanes{rate.x(), rate.y(), rate.z(), 0.0};
    }
    return arrays;
  }

  /// Computes the contacts of all blocks, then adds records of other blocks and does the second half of the step; with
  /// `onward` also the first half of the next one, since no later block reads the bodies of a finished block.
  void run_blocks(World& world, const StepClock& clock, bool onward) {
    auto& all = blocks_.blocks();
    passes_ = law_.passes();
    dt_ = clock.dt;
    lag_ = lag(clock);
    const auto loop = law_.needs.turns() ? find_loop<true>() : find_loop<false>();
    const bool unread = onward || (clock.run_on && !clock.run_on->rests);
    const SphereArrays arrays = arrays_of(world, clock, !unread);
    const auto threads = static_cast<std::size_t>(thread_count());
    const std::size_t accumulators = threads == 1 ? 1 : std::min(most_accumulators, all.size() / threads + 1);
    blocks_.set_accumulators(threads * accumulators);
    const auto find = [&](std::size_t i, std::size_t accumulator) {
      blocks_.clear_accumulator(accumulator);
      SphereArrays mine = arrays;
      const std::size_t first = blocks_.begin_of(i);
      if (mine.owner != nullptr && counts_all_[i] != 0) mine.owner = nullptr;
      mine.sums = reinterpret_cast<std::uintptr_t>(blocks_.sums(accumulator)) - first * sizeof(SphereSum);
      mine.nowhere = SpherePlace(static_cast<Slot>(first + blocks_.block_size()));
      mine.moments = reinterpret_cast<std::uintptr_t>(blocks_.moments(accumulator)) - first * sizeof(Lanes);
      loop(FindCall{all[i], mine});
    };
    const std::size_t of_balls = blocks_.ball_blocks(), of_bodies = all.size() - of_balls;
    next_extents_.resize(onward ? of_bodies : 1);
    largest_inverse_half_margin_.resize(next_extents_.size());
    const auto second_half = best_loop<SecondHalf<false>>();
    const auto run_on = best_loop<SecondHalf<true>>();
    const auto finish = [&](std::size_t i, std::size_t accumulator, std::size_t next) {
      blocks_.receive(of_balls + i, accumulator);
      const std::size_t begin = i * blocks_.block_size();
      const std::size_t end = std::min(world.size(), begin + blocks_.block_size());
      if (blocks_.balls().any_free()) blocks_.balls().give(world, is_touched_.data(), begin, end);
      if (!clock.scheme)
        unpack_bodies(world, blocks_.sums(accumulator), blocks_.moments(accumulator), touched(), begin, end);
      else if (onward)
        run_on({pass(world, clock, begin, end, accumulator, extents_[i]),
                {next_extents_[i] = {}, largest_inverse_half_margin_[i] = Vec3::Zero()},
                world.states().data() + next * blocks_.block_size()});
      else
        second_half({pass(world, clock, begin, end, accumulator, extents_[i]),
                     {next_extents_[0], largest_inverse_half_margin_[0]},
                     {}});
      if (of_balls > 0 && onward) blocks_.balls().place(world, lag(clock), blocks_.late_spins(), begin, end);
    };
    // blocks of balls come first: bodies need the sums of their balls
    const auto collect = [&](std::size_t i, std::size_t accumulator, std::size_t) {
      blocks_.receive(i, accumulator);
      blocks_.balls().collect(world, blocks_.sums(accumulator), blocks_.moments(accumulator), blocks_.begin_of(i),
                              blocks_.end_of(i));
    };
    if (of_balls > 0)
      parallel_wavefront(
          of_balls, accumulators, {}, [&](std::size_t i) -> const auto& { return all[i].waits; }, find, collect);
    // records go to later blocks only, and no block reads bodies of an earlier one
    parallel_wavefront(
        of_bodies, accumulators, blocks_.order(), [&](std::size_t i) -> const auto& { return all[of_balls + i].waits; },
        [&](std::size_t i, std::size_t accumulator) { find(of_balls + i, accumulator); }, finish);
  }

  /// Of all places.
  static BodyState* all_states(World& world) { return world.states().data() - world.states_before(); }
  static const BodyState* all_states(const World& world) { return world.states().data() - world.states_before(); }

  /// Adds the results of the blocks to the report of the generic loop.
  void count(double dt, StepReport& report) {
    report.contacts += blocks_.pairs();
    Losses lost;
    double viscous_power = 0.0;
    report.deepest = report.deepest_relative = 0.0;
    for (const auto& block : blocks_.blocks()) {
      report.deepest = std::max(report.deepest, block.deepest);
      report.deepest_relative = std::max(report.deepest_relative, block.deepest_relative);
      report.touching += block.touching;
      report.elastic += block.elastic;
      viscous_power += block.viscous;
      lost.viscous += block.late;
      if (dt > 0.0) lost.frictional += block.slipped;
      // with adhesion bodies that touch at the start meet there
      if (law_.holds || dt > 0.0) (law_.holds ? lost.adhesive : lost.plastic) += block.lost;
    }
    lost.viscous += 0.5 * dt * (viscous_power_ + viscous_power);
    viscous_power_ = viscous_power;
    report.losses += lost;
    report.dissipated += lost.viscous + lost.frictional + lost.plastic + lost.adhesive;
  }

  /// Work of driven balls and of the strain of a cell.
  void drive(World& world, bool others, double dt, StepReport& report) {
    if (!world.cell && blocks_.balls().empty()) return;
    const double power = world.owner.empty() ? blocks_.balls().driven_power(world)
                                             : SphereContacts(world, blocks_).driven_power(loads(world));
    report.work += 0.5 * dt * (driven_power_ + power);
    driven_power_ = power;
    if (!world.cell) return;
    Virial found;
    add_virial(world, found);
    // if the generic loop ran, the cell has its present virial, and the previous step is booked
    const Vec3 virial = found.value(), both = world.cell->virial + virial;
    report.work += 0.5 * dt * (others ? virial : both).dot(world.cell->strain_rate);
    world.cell->virial = others ? both : virial;
  }

  SphereContacts::LoadOf loads(const World& world) const {
    return [this, &world](const SphereContact& c, const ContactPoint& point) { return load_of(world, c, point); };
  }
  /// At the last call, by the formulas of the loop.
  SphereLoad load_of(const World& world, const SphereContact& c, const ContactPoint& point) const {
    SphereLoad load{-normal_force(world, c, point) * point.normal, Vec3::Zero()};
    const SphereSprings& springs = blocks_.blocks()[c.block].springs;
    if (law_.needs.damps_slip()) {
      load.force += xyz(springs.loads(c.rank).friction);
      load.moment = xyz(springs.loads(c.rank).moment);
    } else if (law_.needs.friction)
      load.force += xyz(springs.friction(c.rank).load);
    return load;
  }
  /// Velocity in the middle of the last step: without the change by its second half [m/s].
  Vec3 middle_velocity(const World& world, Slot place) const {
    const auto balls = static_cast<Slot>(blocks_.balls().size());
    if (place < balls) return xyz(all_states(world)[place].velocity);
    const Slot slot = place - balls;
    return lag_ == 0.0 ? Vec3(world.velocity[slot]) : Vec3(world.velocity[slot] - lag_ * world.acceleration(slot));
  }
  static Vec3 xyz(const Lanes& x) { return {x[0], x[1], x[2]}; }
  /// [N]
  double normal_force(const World& world, const SphereContact& c, const ContactPoint& point) const {
    const bool wall = c.plane >= 0;
    const SphereBlocks::Block& block = blocks_.blocks()[c.block];
    const SpherePlaces& places = block.pairs[c.pair];
    const Slot slot_a = places.a.slot(), slot_b = places.b.slot();
    const BodyState &a = all_states(world)[slot_a], &b = all_states(world)[slot_b];
    Vec3 later = -xyz(a.predicted), middle = -middle_velocity(world, slot_a);
    double inverse_mass = a.velocity[3];
    if (!wall) {
      later += xyz(b.predicted);
      middle += middle_velocity(world, slot_b);
      inverse_mass += b.velocity[3];
    }
    if (!wall && world.cell) {
      const Vec3 branch = (a.position[3] + b.position[3] + point.gap) * point.normal;
      later += world.cell->strain_rate.cwiseProduct(branch);
      middle += world.cell->strain_rate.cwiseProduct(branch);
    }
    KinematicsOf<double> at;
    at.overlap = reach_ == 0.0 ? std::max(0.0, -point.gap) : -point.gap;
    at.approach_velocity = -later.dot(point.normal);
    at.middle_velocity = -middle.dot(point.normal);
    at.effective_mass = 1.0 / inverse_mass;
    at.effective_radius = point.effective_radius;
    at.step = {dt_, lag_ / at.effective_mass};
    const Slot first = blocks_.balls().body_of(slot_a), other = blocks_.balls().body_of(slot_b);
    const std::size_t pair = law_.materials * world.material[first] + world.material[other];
    const double before = law_.needs.normal ? block.springs.normal(c.rank) : 0.0;
    double now = 0.0;
    const double* numbers = law_.numbers.data() + pair * law_.per_pair;
    return law_.normal().one(numbers, at, &before, &now, law_.locates ? &dt_ : nullptr).force;
  }

  SmoothLaw law_;
  Passes passes_;  ///< of the last call
  double reach_, dt_ = 0.0, lag_ = 0.0;
  std::uint32_t own_ = 0;                ///< material of all spheres; as many as there are: several
  std::vector<std::uint16_t> material_;  ///< by place, where there are balls of several; else that of the world
  std::vector<std::uint8_t> owner_, counts_all_;  ///< by place, by block; where several processes share the bodies
  std::unique_ptr<ContactModel> generic_;
  bool others_ = false;
  bool predicted_ = false;                          ///< the states say how fast the bodies are at the detection
  UnwrittenColumn<double> radius_;                  ///< of bodies in new slots [m]; empty: they are known
  std::size_t first_ = 0;                           ///< slot of the first of radius_
  CommonMotion drift_;                              ///< beside which displacements are counted
  double since_drift_ = 0.0;                        ///< it began so long ago [s]
  std::span<const float> inverse_half_margin_;      ///< as SphereList::inverse_half_margin
  bool tells_forces_ = true;                        ///< in every step; else in observed ones only
  bool tells_states_ = false, has_states_ = false;  ///< to other processes in place of forces; from them, in a step
  std::vector<Vec3> largest_inverse_half_margin_;   ///< by block: largest squares of velocity times that [1/s^2]
  std::vector<double> displacements_;               ///< by block, of the step that has begun, over half the margin
  bool ahead_ = false;                              ///< the first half of the next step is done
  std::vector<std::uint8_t> is_touched_;            ///< by slot: with forces of the generic loop; empty: none is
  std::vector<Extent> extents_, next_extents_;      ///< of this step and of the next one, by block
  Extent extent_;
  bool has_extent_ = false;
  double viscous_power_ = 0.0;  ///< of the dampers at the last call [W]
  double driven_power_ = 0.0;   ///< of driven balls at the last call [W]
  StepRatio ratio_;
  mutable bool published_ = false;  ///< the contacts of this step are in the set already
  mutable SpherePublisher publisher_;
  SphereBlocks blocks_;
};

}  // namespace

std::unique_ptr<FusedSpheres> make_fused_spheres(const SmoothSetup& setup, double reach, std::size_t block_size) {
  return std::make_unique<FusedModel>(setup, reach, block_size);
}

SphereNeeds sphere_needs(const SmoothSetup& setup) { return smooth_law(setup).needs; }

}  // namespace epafi
