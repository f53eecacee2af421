// Random heaps of balls, boxes and other hulls under impulses: what all ranks find and sweep gives the bits of one
// process, with every kind of solver, while bodies come, leave, are sorted and pass from rank to rank.
#include "detection/broad/all_broad_phases.h"
#include "detection/narrow/narrow_phase.h"
#include "engine/schemes/moreau_jean.h"
#include "engine/state/hash.h"
#include "engine/step/simulation.h"
#include "engine/units/random.h"
#include "laws/nonsmooth/nonsmooth_contact.h"
#include "laws/nonsmooth/shared_sweeps.h"
#include "ranks/communicator.h"
#include "ranks/team.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

constexpr double dt = 2e-3;
constexpr const char* solvers[] = {"adaptive", "pgs", "nsgs", "newton", "soft-step", "adaptive", "pgs"};

struct Heap {
  std::shared_ptr<ShapeStore> shapes = std::make_shared<ShapeStore>();
  std::shared_ptr<Simulation> simulation;
  Random random;
  Body late;   ///< comes in while the others move
  bool rests;  ///< the reach follows motion: pairs at rest are remembered

  explicit Heap(int draw) : random(23, static_cast<std::uint64_t>(draw)), rests(draw % 2 == 0) {
    Pipeline p;
    p.scheme = std::make_unique<MoreauJean>();
    auto narrow = std::make_unique<BatchNarrowPhase>(*shapes, 0.01, false);
    if (rests) narrow->follow_motion(dt, 0.001);
    narrow->join_walls();
    p.narrow_phase = std::move(narrow);
    MaterialPair pair;
    pair.a = pair.b = {"stone", 2000.0, 0.0, 0.0};
    pair.restitution = draw % 3 == 0 ? 0.0 : random.uniform(0, 0.8);
    pair.friction = random.uniform(0, 0.8);
    p.contact_model = make_nonsmooth_contact({solvers[draw % 7], {}, {1, {pair}}});
    simulation = std::make_shared<Simulation>(
        World({.rotation = true, .orientation = true, .anisotropy = true, .force = false}), std::move(p), dt);
    World& world = simulation->world;
    world.gravity = Vec3(0, 0, -9.81);
    world.add(Body{.shape = shapes->add(HalfSpace{Vec3(0, 0, 1)}).packed});
    const Vec3 step(0.5, 0.5, 0.2);
    world.add(Body{.position = Vec3(0.2, 0.2, 0), .shape = shapes->add(Box(step)).packed});
    for (int k = 0; k < 45; ++k) world.add(stone(k));
    late = stone(1);
    late.position.z() = 2.0;
    BroadSetup setup;
    setup.shapes = shapes.get();
    setup.reach = 0.01;
    for (const auto& row : pair_table())
      for (const auto& cell : row) setup.filter.has_cell.push_back(cell.batch != nullptr);
    simulation->pipeline.broad_phase = make_broad_phase("spatial-hash", setup, world);
    simulation->sort_interval = 40;
    simulation->events.push_back(
        std::make_unique<RemoveBodies>(std::vector{static_cast<BodyId>(9), static_cast<BodyId>(20)}, 45.2 * dt));
  }

  Vec3 vec(double s) { return {random.uniform(-s, s), random.uniform(-s, s), random.uniform(-s, s)}; }

  Body stone(int k) {
    const double size = random.uniform(0.03, 0.06);
    Body b;
    b.mass = 2000.0 * size * size * size * 4;
    b.inertia = 0.4 * b.mass * size * size * (Vec3::Constant(1.0) + (k % 3 == 0 ? Vec3::Zero().eval() : vec(0.2)));
    b.shape = k % 3 == 0 ? shapes->add(Sphere{size}).packed
                         : shapes->add(Box(size * (Vec3::Constant(1.0) + vec(0.3)))).packed;
    b.position = 0.17 * Vec3(k % 3, k / 3 % 3, 2.3 + k / 9) + vec(0.01);
    b.orientation = Quat(1, random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    b.velocity = vec(0.5) - Vec3(0, 0, 1);
    b.angular_velocity = vec(3.0);
    return b;
  }
};

std::string run(Heap& heap, int steps) {
  Simulation& sim = *heap.simulation;
  sim.start();
  for (int k = 0; k < steps; ++k) {
    if (k == steps / 3) sim.world.add(heap.late);
    const auto failure = sim.advance();
    REQUIRE_FALSE(failure);
  }
  return state_hash(sim.world);
}

}  // namespace

TEST_CASE("random heaps under impulses by all ranks have the bits of one process") {
  constexpr int steps = 90;
  double moved = 0.0, ghosts = 0.0;
  for (int draw = 0; draw < 7; ++draw) {
    auto part = std::make_shared<Heap>(draw);
    const PartSetup setup{PartSetup::Shares::contacts,
                          0.01,
                          [part](std::uint32_t s) { return part->shapes->bounding_radius(ShapeRef{s}); },
                          {},
                          1,
                          {},
                          help_with_sweeps};
    MpiTeam team;
    if (rank_number() != 0) {
      CHECK(team.follow(*part->simulation, setup).code == 0);
      continue;
    }
    Heap alone(draw), shared(draw);
    const std::string want = run(alone, steps);
    team.lead(*shared.simulation, {part, part->simulation.get()}, setup);
    RankTeam::set_of_program(&team);
    if (team.helpers()) team.helpers()->least_contacts = 0;
    const std::string have = run(shared, steps);
    RankTeam::set_of_program(nullptr);
    const auto figures = team.figures();
    REQUIRE(figures);
    moved += figures->moves;
    ghosts += figures->ghosts;
    team.end(0);
    INFO("draw " << draw << ", " << solvers[draw % 7]);
    CHECK(have == want);
  }
  if (rank_number() == 0) CHECK(moved > 7 * 3.0);
  if (rank_number() == 0 && rank_count() > 1) CHECK(ghosts > 0.0);
}
