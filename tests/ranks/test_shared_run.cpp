// Spheres in a shaken box, by all ranks and by rank 0 alone: the same bits of bodies, contacts and springs.
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "detection/broad/all_broad_phases.h"
#include "detection/narrow/narrow_phase.h"
#include "engine/schemes/velocity_verlet.h"
#include "engine/step/simulation.h"
#include "engine/threads/parallel.h"
#include "engine/units/random.h"
#include "laws/smooth/fused/fused_spheres.h"
#include "ranks/communicator.h"
#include "ranks/part.h"
#include "ranks/state_image.h"
#include "scenes/sphere_split.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

constexpr double radius = 0.01, dt = 1e-4;
constexpr int side = 4, layers = 6;

SmoothSetup law() {
  MaterialPair pair;
  pair.a = pair.b = {"bead", 2500.0, 5e6, 0.3};
  pair.restitution = 0.6;
  pair.friction = 0.5;
  pair.rolling_friction = 0.05;
  SmoothSetup setup{"hertz-mindlin", "", "", {}};
  const auto& laws = all_smooth_laws();
  for (const Entry& e : laws)
    if (e.name == setup.law)
      for (const Field& f : e.fields)
        if (f.default_value) pair.parameters.set(f.name, *f.default_value);
  setup.materials = {1, {pair}};
  return setup;
}

/// Planes, of which the floor is driven where `shaken`, and spheres of two sizes.
struct Box {
  std::shared_ptr<ShapeStore> shapes = std::make_shared<ShapeStore>();
  std::shared_ptr<Simulation> simulation;

  Box(bool fused, bool shaken) {
    Columns columns{.rotation = true, .orientation = false};
    columns.states = fused;
    BroadSetup setup;
    setup.shapes = shapes.get();
    for (const auto& row : pair_table())
      for (const auto& cell : row) setup.filter.has_cell.push_back(cell.batch != nullptr);
    setup.spheres.wanted = fused;
    setup.spheres.fixed = {!shaken, true, true, true, true};
    Pipeline p;
    p.scheme = std::make_unique<VelocityVerlet>();
    auto narrow = std::make_unique<BatchNarrowPhase>(*shapes, 0.0, true);
    if (fused) {
      auto model = make_fused_spheres(law(), 0.0);
      p.narrow_phase = std::make_unique<SphereSplit>(*shapes, std::move(narrow), *model, setup.spheres);
      p.contact_model = std::move(model);
    } else {
      p.narrow_phase = std::move(narrow);
      p.contact_model = make_smooth_contact(law());
    }
    simulation = std::make_shared<Simulation>(World(columns), std::move(p), dt);
    World& world = simulation->world;
    world.gravity = Vec3(0, 0, -9.81);
    add_bodies(world);
    auto list = make_broad_phase("spatial-hash", setup, world);
    if (fused) {
      std::unique_ptr<ListBroadPhase> owned(dynamic_cast<ListBroadPhase*>(list.release()));
      list = std::make_unique<BlockBoundPairs>(std::move(owned), simulation->pipeline);
    }
    simulation->pipeline.broad_phase = std::move(list);
    simulation->sort_interval = 100;
    if (shaken) {
      Motion motion;
      motion.oscillation_direction = Vec3(0.6, 0, 0.8);
      motion.oscillation_amplitude = 0.004;
      motion.oscillation_frequency = 30.0;
      const auto floor = static_cast<BodyId>(0);
      simulation->events.push_back(std::make_unique<DriveBody>(floor, std::vector{motion}, Vec3::Zero()));
    }
    simulation->events.push_back(
        std::make_unique<RemoveBodies>(std::vector{static_cast<BodyId>(9), static_cast<BodyId>(60)}, 0.0122));
  }

  void add_bodies(World& world) {
    const double width = side * 2.3 * radius;
    const Vec3 normals[5] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    for (const Vec3& n : normals) {
      Body wall;
      wall.shape = shapes->add(HalfSpace{n}).packed;
      wall.position = n.x() < 0 || n.y() < 0 ? Vec3(width, width, 0) : Vec3(Vec3::Zero());
      world.add(wall);
    }
    const std::uint32_t shape[2] = {shapes->add(Sphere{radius}).packed, shapes->add(Sphere{0.7 * radius}).packed};
    Random random(5, 0);
    for (int k = 0; k < side * side * layers; ++k) {
      Body b;
      const bool small = k % 3 == 0;
      const double r = small ? 0.7 * radius : radius;
      b.shape = shape[small ? 1 : 0];
      b.mass = 2500.0 * 4.0 / 3.0 * 3.141592653589793 * r * r * r;
      b.inertia = Vec3::Constant(0.4 * b.mass * r * r);
      b.position = 2.3 * radius * Vec3(0.5 + k % side, 0.5 + k / side % side, 0.5 + k / (side * side));
      b.velocity = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-4, 0));
      b.angular_velocity = 20.0 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      world.add(b);
    }
  }
};

/// What a run has come to: bodies to the bit, what contacts remember, contacts, energies.
struct Outcome {
  std::string hash;
  std::map<std::string, RowBytes> memory;
  std::vector<std::tuple<Slot, Slot, Feature, double, double, double, double>> contacts;
  double elastic = 0.0, dissipated = 0.0;
  std::size_t touching = 0;
};

/// Looks at the contacts of the last step.
class Look final : public Observer {
 public:
  explicit Look(Outcome& to) : to_(to) {}
  bool is_due(std::uint64_t) const override { return false; }
  void observe(const StepView& v) override {
    ContactSet all = v.contacts;
    all.sort();
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all.gap[k] < 0.0)
        to_.contacts.emplace_back(all.a[k], all.b[k], all.feature[k], all.gap[k], all.force[k].x(), all.force[k].y(),
                                  all.force[k].z());
    to_.touching = v.report.touching;
    to_.elastic = v.report.elastic;
  }

 private:
  Outcome& to_;
};

/// Energies, momentum and overlaps of a step, each a sum over all bodies or contacts.
using Sums = std::vector<std::array<double, 9>>;

/// Looks at what is summed while the bodies are with all ranks.
class SumLook final : public Observer {
 public:
  SumLook(Sums& to, const ShapeStore& shapes) : to_(to), shapes_(shapes) {}
  bool is_due(std::uint64_t step) const override { return step % 7 == 0; }
  bool wants_energy(std::uint64_t step) const override { return is_due(step); }
  bool wants_bodies(std::uint64_t) const override { return false; }
  ContactView wants_contacts(std::uint64_t step, bool) const override {
    return is_due(step) ? ContactView::overlaps : ContactView::none;
  }
  void observe(const StepView& v) override {
    const BodyTotals b = v.totals();
    const auto radius = [&](std::uint32_t shape) { return shapes_.bounding_radius(ShapeRef{shape}); };
    const OverlapTotals o =
        v.overlaps ? *v.overlaps : overlap_totals(v.world, v.pieces(), radius, [](Slot, Slot) { return true; });
    const Energy& e = v.ledger.last();
    to_.push_back({e.kinetic, e.potential, b.mass.value(), b.momentum[2].value(), b.momenta.value(), b.farthest, o.max,
                   o.max_relative, o.sum.value()});
  }

 private:
  Sums& to_;
  const ShapeStore& shapes_;
};

/// Bodies of contacts that overlap, and where these are seen from the second one.
using Seen = std::vector<std::tuple<std::uint64_t, std::uint32_t, std::uint32_t, double, double, double>>;

/// Looks at contacts between two steps, as the watch of the time step does.
class Watch final : public StepWatch {
 public:
  explicit Watch(Seen& to) : to_(to) {}
  bool is_due(std::uint64_t step) const override { return step % 25 == 0; }
  void note(std::uint64_t, double) override {}
  int parts() const override { return 1; }
  void visit(StateVisitor&) override {}
  std::optional<Failure> look(const StepView& view) override {
    const ContactPieces pieces = view.pieces();
    for (std::size_t k = 0; k < pieces.size(); ++k)
      pieces.read(k, [&](const ContactSet& c, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) note_contact(view, c, i);
      });
    std::ranges::sort(to_);
    return std::nullopt;
  }

 private:
  void note_contact(const StepView& view, const ContactSet& c, std::size_t i) {
    if (!(c.gap[i] < 0.0)) return;
    const Vec3 arm = c.arm_b(i, view.world);
    const auto id = [&](Slot s) { return static_cast<std::uint32_t>(view.world.id[s]); };
    to_.emplace_back(view.step, id(c.a[i]), id(c.b[i]), arm.x(), arm.y(), arm.z());
  }
  Seen& to_;
};

/// Several processes run on between two looks; ahead: how often.
Outcome run(Simulation& sim, int steps, int& ahead) {
  sim.start();
  for (int k = 0; k < steps; ++k) {
    const auto failure = sim.advance(false, k + 1 < steps && sim.remote);
    REQUIRE_FALSE(failure);
    ahead += sim.is_ahead() ? 1 : 0;
  }
  sim.gather_state();
  Outcome out;
  Look look(out);
  sim.show(look);
  out.hash = state_hash(sim.world);
  sim.ledger.measure(sim.world);
  out.dissipated = sim.ledger.last().dissipated;
  for (ImageColumn& c : image_of([&](StateVisitor& v) { sim.visit(v); }))
    if (c.whose == RowsOf::first_slots || c.whose == RowsOf::second_slots || c.name == "smooth/normal" ||
        c.name == "smooth/friction" || c.name == "smooth/rolling" || c.whose == RowsOf::ids ||
        (c.whose == RowsOf::bodies && c.name != "world/torque" && c.name != "world/force"))
      out.memory[c.name] = c.data;
  return out;
}

/// Counts the steps in which all ranks, or only some of them, make new lists.
struct NewLists {
  std::uint64_t generation = 0;
  int all = 0, some = 0;
  void note(const Simulation& sim) {
    double ranks = std::exchange(generation, sim.work.pairs.generation) != generation ? 1.0 : 0.0;
    sum_over_ranks({&ranks, 1});
    all += ranks == rank_count() ? 1 : 0;
    some += ranks > 0.0 && ranks < rank_count() ? 1 : 0;
  }
};

/// One task of rank 0 after the other, as ranks/team.cpp does it.
class Sharing final : public RemoteSteps {
 public:
  Sharing(Simulation& mine, Part& part, int& fetched) : mine_(mine), part_(part), fetched_(fetched) {}
  void send(Simulation& whole) override {
    order(0);
    part_.receive(&whole);
  }
  void fetch(Simulation& whole, bool goes_on) override {
    ++fetched_;
    CHECK_FALSE(is_ahead());
    order(goes_on ? 11 : 1);
    part_.give(&whole, goes_on);
  }
  void fetch_seen(Simulation& whole, ContactView contacts) override {
    order(contacts == ContactView::all ? 5 : contacts == ContactView::pieces ? 2 : 10);
    part_.give_seen(&whole, contacts);
  }
  RemoteTotals totals(bool overlaps) override {
    order(overlaps ? 7 : 6);
    return part_.totals(overlaps);
  }
  double stiffness(double) override {
    order(8);
    return part_.stiffness(dt);
  }
  bool step(double, const std::optional<Domain>& domain, bool run_on, StepReport& report) override {
    order(run_on ? 4 : 3);
    const bool sound = part_.step(dt, domain, run_on, report);
    lists.note(mine_);
    return sound;
  }
  bool is_ahead() const override { return mine_.is_ahead(); }
  RankFigures figures() override { return {}; }
  NewLists lists;
  static void order(int what) { broadcast(&what, sizeof what); }
  static void follow(Simulation& mine, Part& part) {
    StepReport report;
    NewLists lists;
    for (int what = 0; what != 9;) {
      broadcast(&what, sizeof what);
      if (what == 0) part.receive(nullptr);
      if (what == 1 || what == 11) part.give(nullptr, what == 11);
      if (what == 5) part.give_seen(nullptr, ContactView::all);
      if (what == 2) part.give_seen(nullptr, ContactView::pieces);
      if (what == 10) part.give_seen(nullptr, ContactView::none);
      if (what == 3 || what == 4) {
        part.step(dt, std::nullopt, what == 4, report);
        lists.note(mine);
      }
      if (what == 6 || what == 7) part.totals(what == 7);
      if (what == 8) part.stiffness(dt);
    }
  }

 private:
  Simulation& mine_;  ///< of the part
  Part& part_;
  int& fetched_;  ///< how often the whole state came
};

void compare(bool fused, bool shaken, int steps) {
  Box mine(fused, shaken);
  const PartSetup setup{PartSetup::Shares::steps,
                        0.0,
                        [&](std::uint32_t s) { return mine.shapes->bounding_radius(ShapeRef{s}); },
                        [](std::uint32_t) { return false; },
                        1,
                        {},
                        {},
                        {},
                        {},
                        fused && !shaken};
  Part part(*mine.simulation, setup);
  if (rank_number() != 0) return Sharing::follow(*mine.simulation, part);
  Box alone(fused, shaken), shared(fused, shaken);
  Seen want_seen, have_seen;
  alone.simulation->step_watch = std::make_unique<Watch>(want_seen);
  shared.simulation->step_watch = std::make_unique<Watch>(have_seen);
  Sums want_sums, have_sums;
  alone.simulation->observers.push_back(std::make_unique<SumLook>(want_sums, *alone.shapes));
  shared.simulation->observers.push_back(std::make_unique<SumLook>(have_sums, *shared.shapes));
  int fetched = 0, ahead = 0;
  const Outcome want = run(*alone.simulation, steps, ahead);
  shared.simulation->remote = std::make_unique<Sharing>(*mine.simulation, part, fetched);
  const Outcome have = run(*shared.simulation, steps, ahead);
  Sharing::order(9);
  CHECK(have.hash == want.hash);
  CHECK(have.contacts == want.contacts);
  CHECK(have.touching == want.touching);
  CHECK(have.memory == want.memory);
  CHECK(have.elastic == Approx(want.elastic).epsilon(1e-10));
  CHECK(have.dissipated == Approx(want.dissipated).epsilon(1e-10));
  CHECK(have_seen == want_seen);
  CHECK(want_seen.size() > 100);
  CHECK(have_sums == want_sums);
  CHECK(want_sums.size() > 20);
  const NewLists& lists = dynamic_cast<const Sharing&>(*shared.simulation->remote).lists;
  CHECK(lists.all > 0);
  CHECK((!fused || lists.some <= lists.all / 4));
  CHECK((fused && !shaken ? ahead > steps / 2 : ahead == 0));
  CHECK(fetched <= 2 + steps / 100);  // two sorts, a removal, the end: not the looks at contacts and sums
  CHECK(want.touching > 20);
  CHECK(want.dissipated > 0.0);
  CHECK((rank_count() == 1 || part.figures().moved > 0.0));
}

}  // namespace

TEST_CASE("spheres in a box by the loop over spheres: the bits of one process") { compare(true, false, 300); }
TEST_CASE("spheres in a shaken box by the loop over spheres: the bits of one process") { compare(true, true, 300); }
TEST_CASE("spheres in a shaken box by the loop over contacts: the bits of one process") { compare(false, true, 300); }
