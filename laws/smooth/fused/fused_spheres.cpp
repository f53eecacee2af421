#include "laws/smooth/fused/fused_spheres.h"

#include "engine/parallel.h"
#include "engine/targets.h"
#include "laws/smooth/choose_law.h"
#include "laws/smooth/fused/sphere_kernel.h"

namespace epafi {
namespace {

/// Everything a block needs, so that the loop is compiled once per target with all below it inlined.
template <class Normal, class Tangential>
struct BlockTask {
  SphereBlocks::Block& block;
  const SphereLaw<Normal, Tangential>& law;
  const std::vector<SphereLaw<Normal, Tangential>>& wall_laws;  ///< by plane
  SphereArrays arrays;

  EPAFI_LANES void run() const {
    if (block.images.empty())
      run_groups<false>();
    else
      run_groups<true>();
  }

  template <bool periodic>
  EPAFI_LANES void run_groups() const {
    SphereGroup* g = block.groups.data();
    const SphereImages* image = block.images.data();
    const auto at = [&](std::size_t k) { return periodic ? image + k : nullptr; };
    const auto of_wall = [&](const SphereGroup& group) -> const auto& {
      return wall_laws[static_cast<std::size_t>(group.plane)];
    };
    const auto of_pair = [&](const SphereGroup&) -> const auto& { return law; };
    const std::size_t inside = block.inside, across = block.across;
    block.touching =
        evaluate<Normal, Tangential, true, false, periodic>(g, g + inside, at(0), of_wall, arrays) +
        evaluate<Normal, Tangential, false, false, periodic>(g + inside, g + across, at(inside), of_pair, arrays) +
        evaluate<Normal, Tangential, false, true, periodic>(g + across, g + block.groups.size(), at(across), of_pair,
                                                            arrays);
  }
};

template <class Normal, class Tangential>
class FusedModel final : public FusedSpheres {
  using Law = SphereLaw<Normal, Tangential>;
  using Task = BlockTask<Normal, Tangential>;

 public:
  FusedModel(const SmoothSetup& setup, std::size_t material)
      : table_(setup.materials), material_(material), generic_(make_smooth_contact(setup)) {
    law_ = law_of(material);
    for (const MaterialPair& pair : table_.pairs)
      damped_ = damped_ || (pair.occurs && Normal::is_damped(Normal::parameters(pair)));
  }

  const char* name() const override { return "fused spheres"; }
  bool waits_for_pairs() const override { return !blocks_.laid_out(); }

  void set_pairs(const World& world, std::span<const SpherePair> pairs, std::vector<SpherePlane> planes,
                 std::span<const double> radius) override {
    wall_laws_.clear();
    for (const SpherePlane& p : planes) wall_laws_.push_back(law_of(world.material[p.slot]));
    blocks_.rebuild(world, pairs, std::move(planes), radius);
  }

  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override {
    published_ = false;
    const bool others = contacts.size() > 0 || others_;
    blocks_.pack(world, damped_ ? clock.velocity_lag * clock.dt
                                : 0.0);  // reads the force of the last step: before the generic loop writes
    if (others)
      generic_->act(world, contacts, clock, report);
    else
      report.contacts = report.touching = 0, report.elastic = report.work = report.dissipated = 0.0,
      report.losses = {}, report.has_solver = false;
    others_ = contacts.size() > 0;  // one more call after the last contact has opened lets its spring go
    auto& all = blocks_.blocks();
    const auto loop = best_loop<Task>();
    SphereArrays arrays{blocks_.planes().data(),  blocks_.states().data(),  blocks_.sums().data(),
                        blocks_.records().data(), blocks_.viscous().data(), clock.dt,
                        damped_,                  Vec3::Zero(),             Vec3::Zero(),
                        blocks_.virials().data()};
    if (world.cell) arrays.cell_size = world.cell->size, arrays.strain_rate = world.cell->strain_rate;
    parallel_blocks(all.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
      loop({all[i], law_, wall_laws_, arrays});
    });
    blocks_.unpack(world, others);
    count(clock.dt, report);
    if (world.cell) deform(*world.cell, others, clock.dt, report);
  }

  void publish(const World& world, ContactSet& contacts) const override {
    if (published_ || !blocks_.laid_out()) return;
    blocks_.publish(world, contacts);
    contacts.sort();
    published_ = true;
  }

  void reorder(const Reordering& change) override { generic_->reorder(change), blocks_.reorder(change); }
  void visit(StateVisitor& visitor) override {
    generic_->visit(visitor), blocks_.visit(visitor);
    visitor.value("spheres/others", others_);
    visitor.value("spheres/driven_power", driven_power_);
  }

 private:
  /// Adds what the blocks found to the report of the generic loop.
  void count(double dt, StepReport& report) {
    report.contacts += blocks_.pairs();
    Losses lost;
    for (const auto& block : blocks_.blocks()) {
      report.touching += block.touching, report.elastic += block.stored;
      if (dt > 0.0) lost.viscous += block.viscous, lost.frictional += block.frictional;
    }
    report.losses += lost;
    report.dissipated += lost.viscous + lost.frictional;
  }

  /// Adds the virial to that of the generic loop (which is of an earlier step where it did not run), and the work of
  /// the strain on it.
  void deform(PeriodicCell& cell, bool others, double dt, StepReport& report) {
    Vec3 virial = Vec3::Zero();
    for (const auto& block : blocks_.blocks()) virial += block.virial;
    const double power = virial.dot(cell.strain_rate);
    report.work += 0.5 * dt * (driven_power_ + power);
    driven_power_ = power;
    cell.virial = others ? Vec3(cell.virial + virial) : virial;
  }

  Law law_of(std::size_t other) const {
    const MaterialPair& pair = table_.pairs[material_ * table_.materials + other];
    return {Normal::parameters(pair), Tangential::parameters(pair)};
  }

  MaterialTable table_;
  std::size_t material_;
  std::unique_ptr<ContactModel> generic_;
  Law law_;
  std::vector<Law> wall_laws_;
  bool damped_ = false, others_ = true;
  double driven_power_ = 0.0;  ///< of the cell's strain on the fused contacts at the last call [W]
  mutable bool published_ = false;  ///< the contacts of this step are in the set already
  SphereBlocks blocks_;
};

/// f(type of normal part, of tangential part) where both have lanes (or there is no friction) and nothing rolls;
/// otherwise nothing.
template <class F>
void with_lanes(const SmoothSetup& setup, const F& f) {
  const SmoothParts parts = smooth_parts(setup);
  if (parts.rolling != NoRolling::name || parts.locate) return;
  with_law(NormalLaws{}, parts.normal, [&](auto n) {
    using N = typename decltype(n)::type;
    if constexpr (LaneLaw<N>)
      with_law(TangentialLaws{}, parts.tangential, [&](auto t) {
        using T = typename decltype(t)::type;
        if constexpr ((LaneFriction<T> || !T::is_present) && parts_fit<N, T, NoRolling>) f(n, t);
      });
  });
}

}  // namespace

bool has_fused_spheres(const SmoothSetup& setup) {
  bool found = false;
  with_lanes(setup, [&](auto, auto) { found = true; });
  return found;
}

std::unique_ptr<FusedSpheres> make_fused_spheres(const SmoothSetup& setup, std::size_t material) {
  std::unique_ptr<FusedSpheres> model;
  with_lanes(setup, [&](auto n, auto t) {
    model = std::make_unique<FusedModel<typename decltype(n)::type, typename decltype(t)::type>>(setup, material);
  });
  return model;
}

}  // namespace epafi
