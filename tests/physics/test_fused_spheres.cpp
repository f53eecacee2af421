// The fast path of spheres against the generic loop, which is its reference: the same forces to rounding, the same
// ledger, the same contacts for observers; and the same bits for every thread count.
#include "detection/narrow/narrow_phase.h"
#include "engine/lanes/targets.h"
#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "scenes/contact_setup.h"
#include "scenes/sphere_split.h"
#include "tests/support/catch.h"
#include "tests/support/fused_against_generic.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Spheres that fall into a box of planes, in contact and rolling after 1600 steps; side chosen so that three blocks
/// hold them.
const std::vector<std::string> small_bed{"params.n=2200"};

/// The floor as a box: its contacts take the generic loop beside the fused one.
const std::vector<std::string> bed_on_a_box{"params.n=2200", "body.floor.shape={ box = { size = [1, 1, 1] } }",
                                            "body.floor.position=[0, 0, -0.5]"};

/// Spheres that fall past the floor and are taken out.
const std::vector<std::string> leaking{"params.n=1500", "body.floor.position=[0, 0, -1]",
                                       "world.domain={ min = [-1, -1, -0.01], max = [1, 1, 1], outside = \"delete\" }"};

/// The floor begins to rise and stops, spheres come in one by one, every tenth step; a gate goes.
const std::vector<std::string> rising{"params.n=2200",
                                      "body.floor.shape={ box = { size = [1, 1, 1] } }",
                                      "body.floor.position=[0, 0, -0.5]",
                                      "body.floor.fixed=false",
                                      "body.floor.motion={ velocity = [0, 0, 0.1], from = 0.01, until = 0.02 }",
                                      "fill.0.method=pour",
                                      "fill.0.rate=2000"};
const std::vector<std::string> opening{"params.n=400", "params.open_at=0.05"};

/// Layers that shear in a cell that repeats along x and y, on a plane and on held spheres.
const std::vector<std::string> flow{"params.lx=12",
                                    "params.ly=12",
                                    "params.layers=10",
                                    "run.time_step=1e-3",
                                    "params.theta_deg=10",
                                    "params.surface=3",
                                    "contact.smooth.stiffness=2e4"};

/// A cell under pressure in the middle of being compressed, with friction and without.
const std::vector<std::string> rough_cell{"params.n=1100", "params.mu=0.3", "params.softness=1e-2",
                                          "world.domain.rate_limit=2.0"};
const std::vector<std::string> smooth_cell{"params.n=1100", "params.softness=1e-2", "world.domain.rate_limit=2.0"};

/// The same with parts that resist rolling and damp shear.
std::vector<std::string> with(std::vector<std::string> overrides, const std::vector<std::string>& more) {
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}
const std::vector<std::string> rolling{"contact.smooth.rolling=spring", "contact.rolling_friction=0.1",
                                       "contact.smooth.tangential=mindlin-dashpot", "run.time_step=1.9e-5"};
const std::vector<std::string> spring{"contact.smooth.rolling=spring", "contact.rolling_friction=0.1"};
const std::vector<std::string> constant{"contact.smooth.rolling=constant", "contact.rolling_friction=0.05"};
const std::vector<std::string> viscous{"contact.smooth.rolling=viscous", "contact.rolling_friction=0.05"};
const std::vector<std::string> dashpot{"contact.smooth.tangential=spring-dashpot"};

/// Other laws than the two of the scenes.
const std::string adhesion = "contact.smooth.work_of_adhesion=0.05";
const std::vector<std::string> sticky_roll = with(with(small_bed, {"contact.smooth.law=jkr", adhesion}), spring);
const std::vector<std::string> plastic{"contact.smooth.law=walton-braun", "contact.smooth.stiffness=1000"};
const std::vector<std::string> plastic_smooth = with(with(small_bed, plastic), {"contact.friction=0"});
const std::vector<std::string> viscoelastic{"contact.smooth.law=kuwabara-kono", "contact.smooth.relaxation_time=2e-5"};
const std::vector<std::string> hunt{"contact.smooth.law=hunt-crossley", "contact.smooth.reference_speed=1"};
const std::vector<std::string> power{"contact.smooth.law=power-law", "contact.smooth.exponent=1.4",
                                     "contact.smooth.stiffness=2e4"};
const std::vector<std::string> bristles{"contact.smooth.tangential=mindlin-deresiewicz"};

struct Case {
  std::string scene;
  std::vector<std::string> overrides;
  std::uint64_t steps;  ///< until it has many contacts
  std::size_t touching;
};

SceneRun generic_run(const std::string& scene, const std::vector<std::string>& overrides) {
  return unfused(prepare_scene(library(scene), overrides));
}

}  // namespace

TEST_CASE("the fused loop of spheres gives the forces, the ledger and the contacts of the generic loop",
          "[physics][fused][long]") {
  set_thread_count(1);
  const Case c = GENERATE(
      Case{"bed/bed.toml", small_bed, 1600, 3000}, Case{"bed/bed.toml", bed_on_a_box, 1600, 3000},
      Case{"granular/incline_flow.toml", flow, 4000, 500}, Case{"granular/jammed_spheres.toml", rough_cell, 1500, 2000},
      Case{"granular/jammed_spheres.toml", smooth_cell, 1500, 2000},
      Case{"bed/bed.toml", with(small_bed, rolling), 4200, 3000},
      Case{"bed/bed.toml", with(bed_on_a_box, rolling), 4200, 3000},
      Case{"bed/bed.toml", with(small_bed, constant), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, viscous), 1600, 3000},
      Case{"granular/incline_flow.toml", with(flow, dashpot), 4000, 500},
      Case{"granular/jammed_spheres.toml", with(rough_cell, dashpot), 1500, 2000},
      Case{"granular/jammed_spheres.toml", with(rough_cell, spring), 1500, 2000},
      Case{"bed/bed.toml", with(small_bed, {"contact.smooth.law=dmt", adhesion}), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, {"contact.smooth.law=jkr", adhesion}), 1600, 3000},
      Case{"bed/bed.toml", with(sticky_roll, {"contact.friction=0.3"}), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, plastic), 1600, 3000},
      Case{"bed/bed.toml", with(plastic_smooth, {}), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, viscoelastic), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, hunt), 1600, 3000}, Case{"bed/bed.toml", with(small_bed, power), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, {"contact.smooth.locate_edges=true"}), 1600, 3000},
      Case{"bed/bed.toml", with(small_bed, bristles), 1600, 3000});
  INFO(c.scene << ", " << c.overrides.back());
  SceneRun settled = run_scene(c.scene, c.overrides, c.steps);
  REQUIRE(settled.assembly->plan.fused_spheres);
  SceneRun fused = prepare_scene(library(c.scene), c.overrides), generic = generic_run(c.scene, c.overrides);
  start_both(settled, fused, generic, c.touching);
  CHECK(compare(fused, generic).force < 1e-12);  // sums of some ten terms, each to a few ulp of the largest
  check_twenty_steps(fused, generic, 1e-12);
}

TEST_CASE("thousands of contacts that begin in one step are those of the generic loop", "[physics][fused][long]") {
  set_thread_count(1);
  const bool rolls = GENERATE(false, true);
  const std::vector<std::string> overrides = rolls ? with(small_bed, rolling) : small_bed;
  SceneRun settled = run_scene("bed/bed.toml", overrides, 4200);
  SceneRun fused = prepare_scene(library("bed/bed.toml"), overrides), generic = generic_run("bed/bed.toml", overrides);
  World& world = settled.simulation().world;
  for (Slot s = 0; s < world.size(); ++s)
    if (world.is_movable(s)) {  // apart, and back again within 2e-4 s
      const Vec3 from = world.position[s] - Vec3(0.03, 0.03, 0.03);
      world.position[s] += 0.08 * from;
      world.velocity[s] = -500.0 * from;
    }
  copy_state(settled, fused);
  copy_state(settled, generic);
  fused.simulation().start();
  generic.simulation().start();
  std::size_t most = 0;
  for (int k = 0; k < (rolls ? 14 : 6); ++k) {
    const std::size_t before = fused.simulation().work.report.touching;
    REQUIRE_FALSE(fused.simulation().advance(true));
    REQUIRE_FALSE(generic.simulation().advance(true));
    const std::size_t now = fused.simulation().work.report.touching;
    REQUIRE(now == generic.simulation().work.report.touching);
    if (now > before) most = std::max(most, now - before);
    CHECK(compare(fused, generic).force < 1e-9);
    CHECK(compare(fused, generic).torque < 1e-9);
  }
  CHECK(most > 1000);
}

TEST_CASE("the fused loop of spheres gives the same bits for every thread count and after a Morton sort",
          "[physics][fused][long]") {
  const auto overrides =
      GENERATE(with(small_bed, {}), with(small_bed, rolling));  // values: Catch2 keeps a reference to a name
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3, 8, 16}) {
    set_thread_count(threads);
    hashes.push_back(run_scene("bed/bed.toml", overrides, overrides.size() > 1 ? 2900 : 1100).hash());
  }
  set_thread_count(1);
  for (const auto& h : hashes) CHECK(h == hashes.front());
}

TEST_CASE("the fused loop of spheres gives the same bits on lanes of two, four and eight numbers",
          "[physics][fused][long]") {
  set_thread_count(1);
  const Case c = GENERATE(
      Case{"bed/bed.toml", small_bed, 1100, 0}, Case{"bed/bed.toml", bed_on_a_box, 1100, 0},
      Case{"granular/incline_flow.toml", flow, 1500, 0}, Case{"granular/jammed_spheres.toml", rough_cell, 700, 0},
      Case{"granular/jammed_spheres.toml", smooth_cell, 700, 0},
      Case{"bed/bed.toml", with(small_bed, rolling), 2900, 0},
      Case{"bed/bed.toml", with(bed_on_a_box, constant), 1100, 0},
      Case{"granular/incline_flow.toml", with(flow, dashpot), 1500, 0},
      Case{"bed/bed.toml", with(sticky_roll, {}), 1100, 0}, Case{"bed/bed.toml", with(small_bed, plastic), 1100, 0},
      Case{"bed/bed.toml", with(small_bed, power), 1100, 0});
  INFO(c.scene << ", " << c.overrides.back());
  struct Seen {
    std::string hash;
    double elastic, viscous, frictional, virial, lost;
    bool operator==(const Seen&) const = default;
  };
  std::vector<Seen> seen;
  for (const Target widest : {Target::baseline, Target::avx2, Target::avx512}) {
    limit_target(widest);
    SceneRun run = run_scene(c.scene, c.overrides, c.steps);
    REQUIRE(run.assembly->plan.fused_spheres);
    const Losses& lost = run.simulation().ledger.last().losses;
    const auto& cell = run.simulation().world.cell;
    seen.push_back({run.hash(), run.simulation().work.report.elastic, lost.viscous, lost.frictional,
                    cell ? cell->virial.sum() : 0.0, lost.plastic + lost.adhesive});
  }
  limit_target(Target::avx512);
  CHECK(seen[0].elastic > 0.0);
  CHECK((seen[1] == seen[0] && seen[2] == seen[0]));
}

/// The scene with blocks of so many bodies in its fused loop.
SceneRun with_blocks(const Case& c, std::size_t block_size) {
  SceneRun run = prepare_scene(library(c.scene), c.overrides);
  Assembly& a = *run.assembly;
  auto model = make_fused_spheres(smooth_setup(a.scene), a.plan.reach, block_size);
  SphereRoles roles{true};
  roles.held = a.plan.fused_held;
  for (const auto& b : a.scene.bodies) roles.fixed.push_back(b.fixed);
  auto others = std::make_unique<BatchNarrowPhase>(*a.shapes, a.plan.reach, a.plan.needs.curvature);
  Pipeline& stages = a.simulation->pipeline;
  stages.narrow_phase = std::make_unique<SphereSplit>(*a.shapes, std::move(others), *model, roles);
  stages.contact_model = std::move(model);
  return run;
}

// Of a cell under pressure too: its size follows the virial, a sum over all contacts.
TEST_CASE("the bits do not depend on how many bodies a block of the fused loop has", "[physics][fused][long]") {
  set_thread_count(1);
  const std::vector<std::string> hopper{"params.n=1500", "params.open_at=0.05"};
  const std::vector<std::string> column{"params.l0=10", "params.w=8", "params.open_at=0.02", "params.a=1.0"};
  const auto poured = with(bed_on_a_box, {"fill.0.method=pour", "fill.0.rate=60000"});
  const Case c = GENERATE_COPY(
      Case{"bed/bed.toml", small_bed, 1100, 500}, Case{"bed/bed.toml", bed_on_a_box, 1100, 500},
      Case{"bed/bed.toml", with(sticky_roll, {}), 1100, 500}, Case{"bed/bed.toml", with(small_bed, rolling), 2900, 500},
      Case{"bed/bed.toml", poured, 2200, 50}, Case{"granular/incline_flow.toml", flow, 1500, 50},
      Case{"granular/jammed_spheres.toml", with(rough_cell, {"params.n=1200"}), 700, 50},
      Case{"granular/column_collapse.toml", column, 1500, 50}, Case{"hopper/hopper.toml", hopper, 1500, 50});
  INFO(c.scene << ", " << c.overrides.back());
  std::vector<std::string> hashes;
  for (const std::size_t block_size : {1024, 384}) {
    SceneRun run = with_blocks(c, block_size);
    REQUIRE(run.assembly->plan.fused_spheres);
    run.simulation().start();
    run.advance_to(c.steps);
    CHECK(run.simulation().world.size() > 1024);
    CHECK(run.simulation().work.report.touching > c.touching);
    hashes.push_back(run.hash());
  }
  CHECK(hashes[1] == hashes[0]);
}

TEST_CASE("spheres of two materials on planes of a third take the fused loop, with the law of each pair",
          "[physics][fused][long]") {
  set_thread_count(1);
  const std::string law = GENERATE(std::string("hertz"), std::string("jkr"), std::string("linear"));
  std::string text =
      "run = { duration = 1.0, time_step = 2e-5 }\nworld = { gravity = [0, 0, -9.81] }\n"
      "material.glass = { density = 2500, youngs_modulus = 5e6, poissons_ratio = 0.3 }\n"
      "material.wood = { density = 700, youngs_modulus = 2e6, poissons_ratio = 0.1 }\n"
      "material.steel = { density = 7800, youngs_modulus = 4e7, poissons_ratio = 0.3 }\n"
      "shape.bead = { sphere = { radius = 0.0025 } }\n"
      "[contact]\nmethod = 'smooth'\nrestitution = 0.6\nfriction = 0.5\n[contact.smooth]\nlaw = '" +
      law + "'\n";
  if (law == "linear") text += "stiffness = 1000\n";
  if (law == "jkr") text += "work_of_adhesion = 0.05\n";
  text +=
      "[[contact.pair]]\nbetween = ['glass', 'wood']\nrestitution = 0.3\nfriction = 0.1\n"
      "[[contact.pair]]\nbetween = ['wood', 'steel']\nrestitution = 0.9\nfriction = 0.2\n"
      "[[body]]\nname = 'floor'\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = 'steel'\nfixed = true\n"
      "[[body]]\nrepeat = 4\nshape = { half_space = { normal = ['= cos(i*pi/2)', '= sin(i*pi/2)', 0] } }\n"
      "material = 'steel'\nfixed = true\nposition = ['= -0.025*cos(i*pi/2)', '= -0.025*sin(i*pi/2)', 0]\n";
  for (const char* of : {"glass", "wood"})
    text +=
        std::string("[[fill]]\nname = '") + of + "'\nshape = 'bead'\nmaterial = '" + of +
        "'\ncount = 380\nmethod = 'random'\nregion = { box = { min = [-0.0225, -0.0225, " +
        (of == std::string("glass") ? "0.0025], max = [0.0225, 0.0225, 0.05" : "0.055], max = [0.0225, 0.0225, 0.1") +
        "] } }\n";
  SceneRun settled = start_text(text);
  REQUIRE(settled.assembly->plan.fused_spheres);
  settled.advance_to(7500);
  SceneRun fused = prepare(read_scene_text(text, "scene.toml", {}, full_registry()));
  SceneRun generic = unfused(prepare(read_scene_text(text, "scene.toml", {}, full_registry())));
  copy_state(settled, fused);
  copy_state(settled, generic);
  fused.simulation().start();
  generic.simulation().start();
  CHECK(generic.simulation().work.report.touching > 700);
  CHECK(compare(fused, generic).force < 1e-12);
  for (int k = 0; k < 20; ++k) {
    REQUIRE_FALSE(fused.simulation().advance(k == 19));
    REQUIRE_FALSE(generic.simulation().advance(k == 19));
  }
  const Difference after = compare(fused, generic);
  CHECK((after.force < 1e-9 && after.torque < 1e-9 && after.velocity < 1e-10));
  CHECK(fused.simulation().work.report.touching == generic.simulation().work.report.touching);
  CHECK(fused.simulation().ledger.last().dissipated ==
        Approx(generic.simulation().ledger.last().dissipated).epsilon(1e-7));
}

TEST_CASE("a sphere that leaves the domain is noticed at once where the fused loop watches", "[physics][fused]") {
  set_thread_count(1);
  constexpr double below = -0.01;  // the floor is far down
  SceneRun run = prepare_scene(library("bed/bed.toml"), {"params.n=300", "body.floor.position=[0, 0, -1]",
                                                         "world.domain={ min = [-1, -1, -0.01], max = [1, 1, 1] }"});
  REQUIRE(run.assembly->plan.fused_spheres);
  run.simulation().start();
  std::optional<Failure> failure;
  const World& world = run.simulation().world;
  double lowest = 1.0;
  while (!failure) {
    REQUIRE(run.simulation().steps() < 3000);
    lowest = 1.0;
    for (Slot s = 0; s < world.size(); ++s)
      if (world.is_movable(s)) lowest = std::min(lowest, world.position[s].z());
    failure = run.simulation().advance(false);
  }
  CHECK(lowest >= below);
  CHECK(failure->kind == "lost body");
  CHECK(world.position[world.slot_of(*failure->body)].z() < below);
}

TEST_CASE("steps that begin the next one at once give the same bits as steps that end first",
          "[physics][fused][long]") {
  set_thread_count(GENERATE(1, 2));
  const Case c =
      GENERATE(Case{"bed/bed.toml", small_bed, 1300, 0}, Case{"bed/bed.toml", bed_on_a_box, 1300, 0},
               Case{"bed/bed.toml", leaking, 1700, 0}, Case{"bed/bed.toml", with(bed_on_a_box, rolling), 3400, 0},
               Case{"bed/bed.toml", rising, 1300, 0}, Case{"hopper/hopper.toml", opening, 1800, 0});
  INFO(c.scene << ", " << c.overrides.back());
  const auto run = [&c](bool run_on) {
    SceneRun r = prepare_scene(library(c.scene), c.overrides);
    REQUIRE(r.assembly->plan.fused_spheres);
    r.simulation().start();
    std::uint64_t ahead = 0;
    for (std::uint64_t k = 0; k < c.steps; ++k) {
      REQUIRE_FALSE(r.simulation().advance(false, run_on && k % 17 != 16 && k + 1 < c.steps));
      ahead += r.simulation().is_ahead();
    }
    CHECK((ahead > c.steps / 2) == run_on);
    return r;
  };
  SceneRun one = run(false), other = run(true);
  CHECK(one.hash() == other.hash());
  const auto& last = one.simulation().ledger.last();
  CHECK(last.losses.frictional == other.simulation().ledger.last().losses.frictional);
  CHECK(last.losses.viscous == other.simulation().ledger.last().losses.viscous);
  CHECK(last.elastic == other.simulation().ledger.last().elastic);
  CHECK(last.work == other.simulation().ledger.last().work);  // with what bodies that left took along
  CHECK(one.simulation().bodies_removed() == other.simulation().bodies_removed());
  if (c.overrides == leaking) CHECK(one.simulation().bodies_removed() > 20);
  set_thread_count(1);
}

TEST_CASE("lists of spheres that last give the bits of lists made anew in every step", "[physics][fused][long]") {
  set_thread_count(1);
  const Case c = GENERATE(Case{"bed/bed.toml", small_bed, 1300, 0}, Case{"bed/bed.toml", leaking, 1700, 0});
  INFO(c.overrides.back());
  const auto run = [&c](bool anew, bool run_on) {
    SceneRun r = prepare_scene(library(c.scene), c.overrides);
    Simulation& sim = r.simulation();
    sim.start();
    std::uint64_t lists = 0;
    for (std::uint64_t k = 0; k < c.steps; ++k) {
      const std::uint64_t before = sim.work.pairs.generation;
      if (anew) sim.pipeline.broad_phase->reorder({});
      REQUIRE_FALSE(sim.advance(false, run_on && k % 17 != 16 && k + 1 < c.steps));
      lists += sim.work.pairs.generation - before;
    }
    CHECK(anew == (lists >= c.steps));
    return r.hash();
  };
  const std::string fresh = run(true, false);
  CHECK(run(false, false) == fresh);
  CHECK(run(false, true) == fresh);
}

TEST_CASE("a state put back amid a fall, with the list of a later one, goes on with the same bits",
          "[physics][fused][long]") {
  set_thread_count(1);
  SceneRun run = prepare_scene(library("bed/bed.toml"), small_bed);
  Simulation& sim = run.simulation();
  sim.start();
  StateSnapshot middle;
  const auto put_back = [&] { middle.restore([&](StateVisitor& v) { sim.visit(v); }); };
  const auto advance = [&](std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t k = from; k < to; ++k) REQUIRE_FALSE(sim.advance(false, k % 17 != 16 && k + 1 < to));
    return run.hash();
  };
  advance(0, 500);
  middle.save([&](StateVisitor& v) { sim.visit(v); });
  const std::string straight = advance(500, 1300);
  std::size_t kept = 0;
  for (const std::uint64_t later : {503, 510, 540, 1300}) {  // the first of these lists last, that of the end does not
    put_back();
    advance(500, later);
    put_back();
    const std::uint64_t before = sim.work.pairs.generation;
    advance(500, 501);
    kept += sim.work.pairs.generation == before;
    CHECK(advance(501, 1300) == straight);
  }
  CHECK(kept > 0);
  CHECK(kept < 4);
}

TEST_CASE("spheres whose centres coincide push each other along z, in the fused loop as in the generic one",
          "[physics][fused]") {
  set_thread_count(1);
  const std::vector<std::string> few{"params.n=40"};
  const auto push = [](SceneRun& run) {
    World& world = run.simulation().world;
    const Slot a = world.slot_of(static_cast<BodyId>(world.ids_given() - 1)),
               b = world.slot_of(static_cast<BodyId>(world.ids_given() - 2));
    world.position[a] = world.position[b] = Vec3(0, 0, 1);
    world.velocity[a] = world.velocity[b] = Vec3::Zero();
    run.simulation().start();
    return world.force[a];
  };
  SceneRun generic = generic_run("bed/bed.toml", few);
  const Vec3 expected = push(generic);
  REQUIRE(std::abs(expected.z()) > 1.0);
  for (const Target widest : {Target::baseline, Target::avx2, Target::avx512}) {
    limit_target(widest);
    SceneRun fused = prepare_scene(library("bed/bed.toml"), few);
    REQUIRE(fused.assembly->plan.fused_spheres);
    CHECK((push(fused) - expected).norm() < 1e-9 * expected.norm());
  }
  limit_target(Target::avx512);
}
