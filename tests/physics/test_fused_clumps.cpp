// Balls of clumps and of held bodies in the loop over spheres against the generic loop, which is its reference: the
// same forces to rounding, the same ledger, the same contacts for observers; and the same bits for every thread count,
// width and restart.
#include "engine/lanes/targets.h"
#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/fused_against_generic.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// A clump of 2 to 5 balls of different sizes that overlap, somewhere beside its origin.
std::string random_clump(Random& random) {
  const int balls = 2 + static_cast<int>(4.0 * random.uniform());
  std::string text = "clump = { spheres = [";
  Vec3 at(random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3));
  for (int k = 0; k < balls; ++k) {
    const Vec3 step(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    at += 2.2e-3 * step.normalized();
    text += (k > 0 ? ", [" : "[") + std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " +
            std::to_string(at.z()) + ", " + std::to_string(random.uniform(1.5e-3, 2.5e-3)) + "]";
  }
  return text + "] }";
}

std::string steel_plane(const char* normal, const std::string& position) {
  return std::string("[[body]]\nshape = { half_space = { normal = ") + normal + " } }\nposition = " + position +
         "\nmaterial = 'steel'\nfixed = true\n";
}

/// Clumps of two kinds and spheres fall on planes, a box that stands, held spheres and clumps, of which some move.
std::string heap_of_clumps(unsigned seed, const std::string& law) {
  Random random(seed, 0);
  std::string text =
      "[run]\nduration = 1.0\ntime_step = 2e-5\noutput_interval = 100.0\n[world]\ngravity = [0, 0, -9.81]\n"
      "[material.glass]\ndensity = 2500\nyoungs_modulus = 5e6\npoissons_ratio = 0.3\n"
      "[material.steel]\ndensity = 7800\nyoungs_modulus = 2e7\npoissons_ratio = 0.3\n"
      "[contact]\nmethod = 'smooth'\nrestitution = 0.4\nfriction = 0.3\n" +
      law + "[shape.a]\n" + random_clump(random) + "\n[shape.b]\n" + random_clump(random) +
      "\n[shape.ball]\nsphere = { radius = 0.0025 }\n";
  text += steel_plane("[0, 0, 1]", "[0, 0, 0]") + steel_plane("[1, 0, 0]", "[-0.03, 0, 0]") +
          steel_plane("[-1, 0, 0]", "[0.03, 0, 0]") + steel_plane("[0, 1, 0]", "[0, -0.03, 0]") +
          steel_plane("[0, -1, 0]", "[0, 0.03, 0]");
  text +=
      "[[body]]\nshape = { box = { size = [0.01, 0.01, 0.01] } }\nposition = [0.02, 0.02, 0.005]\n"
      "material = 'steel'\nfixed = true\n"
      "[[body]]\nshape = 'ball'\nposition = [-0.01, 0.01, 0.002]\nmaterial = 'steel'\nfixed = true\n"
      "[[body]]\nshape = 'a'\nposition = [0.01, -0.01, 0.002]\nmaterial = 'steel'\nfixed = true\n"
      "[[body]]\nshape = 'ball'\nposition = [0.0, 0.0, 0.004]\nmaterial = 'steel'\n"
      "motion = { velocity = [0.02, 0, 0] }\n"
      "[[body]]\nshape = 'b'\nposition = [-0.012, -0.012, 0.006]\nmaterial = 'glass'\n"
      "motion = { rotation = { axis = [0, 1, 1], rate = 3.0, about = [-0.012, -0.012, 0.006] } }\n";
  const auto fill = [](const char* shape, const char* material, int count) {
    return std::string("[[fill]]\nshape = '") + shape + "'\nmaterial = '" + material +
           "'\ncount = " + std::to_string(count) + "\nmethod = 'random'\nvelocity = [0, 0, -1.5]\n" +
           "region = { box = { min = [-0.022, -0.022, 0.017], max = [0.022, 0.022, 0.16] } }\n";
  };
  return text + fill("a", "glass", 45) + fill("ball", "steel", 80) + fill("b", "steel", 45);
}

/// Clumps and spheres in a cell that is being compressed.
std::string cell_of_clumps(unsigned seed, const std::string& law) {
  Random random(seed, 0);
  return "[run]\nduration = 1.0\ntime_step = 2e-5\noutput_interval = 100.0\n[world]\n"
         "domain = { min = [0, 0, 0], max = [0.07, 0.07, 0.07], periodic = ['x', 'y', 'z'], strain_rate = [-9.0, -8.5, "
         "-8.0] }\n"
         "[material.glass]\ndensity = 2500\nyoungs_modulus = 5e6\npoissons_ratio = 0.3\n"
         "[contact]\nmethod = 'smooth'\nrestitution = 0.4\nfriction = 0.3\n" +
         law + "[shape.a]\n" + random_clump(random) +
         "\n[shape.ball]\nsphere = { radius = 0.0025 }\n"
         "[[fill]]\nshape = 'a'\nmaterial = 'glass'\ncount = 130\nmethod = 'random'\nregion = { box = { min = [0, 0, "
         "0], max = [0.07, 0.07, 0.07] } }\nvelocity_deviation = 0.2\n"
         "[[fill]]\nshape = 'ball'\nmaterial = 'glass'\ncount = 130\nmethod = 'random'\nregion = { box = { min = [0, "
         "0, "
         "0], max = [0.07, 0.07, 0.07] } }\nvelocity_deviation = 0.2\n";
}

const std::string by_mindlin = "smooth = { law = 'hertz-mindlin' }\n";
const std::string by_rolling =
    "rolling_friction = 0.05\nsmooth = { law = 'hertz-mindlin', tangential = 'mindlin-dashpot', rolling = 'spring' "
    "}\n";
const std::string by_adhesion = "smooth = { law = 'jkr', work_of_adhesion = 0.05 }\n";
const std::string by_bristles = "smooth = { law = 'hertz-mindlin', tangential = 'mindlin-deresiewicz' }\n";

SceneRun clump_run(const std::string& text) {
  return prepare(read_scene_text(text, "scene.toml", {}, full_registry()));
}

struct ClumpCase {
  std::string text;
  std::uint64_t steps;  ///< until many touch
  std::uint64_t more;   ///< contacts, steps
};

}  // namespace

TEST_CASE("balls of clumps and held balls get the forces, the ledger and the contacts of the generic loop",
          "[physics][fused][clump]") {
  set_thread_count(1);
  const ClumpCase c = GENERATE(
      ClumpCase{heap_of_clumps(1, by_mindlin), 4000, 150}, ClumpCase{heap_of_clumps(2, by_rolling), 4000, 150},
      ClumpCase{heap_of_clumps(3, by_adhesion), 4000, 150}, ClumpCase{heap_of_clumps(4, by_bristles), 4000, 150},
      ClumpCase{cell_of_clumps(5, by_mindlin), 4000, 150}, ClumpCase{cell_of_clumps(6, by_rolling), 4000, 150});
  INFO(c.text);
  SceneRun settled = clump_run(c.text);
  settled.simulation().start();
  settled.advance_to(c.steps);
  REQUIRE(settled.failure.empty());
  REQUIRE(settled.assembly->plan.fused_spheres);
  SceneRun fused = clump_run(c.text), generic = unfused(clump_run(c.text));
  start_both(settled, fused, generic, c.more);
  CHECK(compare(fused, generic).force < 1e-11);  // sums of some ten terms, each to a few ulp of the largest
  CHECK(compare(fused, generic).torque < 1e-11);
  check_twenty_steps(fused, generic);
  CHECK(std::abs(generic.simulation().ledger.last().work) > 0.0);  // of what is driven, or of the cell
}

TEST_CASE("balls of clumps give the same bits for every thread count and width, and from a state in the middle",
          "[physics][fused][clump]") {
  const auto [text, half, all] = GENERATE(
      ClumpCase{heap_of_clumps(7, by_mindlin), 1700, 2300}, ClumpCase{heap_of_clumps(8, by_rolling), 1700, 2300},
      ClumpCase{cell_of_clumps(9, by_mindlin), 3600, 4100});  // lists, and a Morton sort in each half
  const auto run = [&, text = text, half = half](int threads) {
    set_thread_count(threads);
    SceneRun out = clump_run(text);
    out.simulation().start();
    out.advance_to(half);
    return out;
  };
  SceneRun one = run(1);
  StateSnapshot middle;
  middle.save([&](StateVisitor& v) { one.simulation().visit(v); });
  one.advance_to(all);
  REQUIRE(one.simulation().work.report.touching > 60);
  const std::string hash = one.hash();
  for (const int threads : {2, 3, 8}) {
    SceneRun other = run(threads);
    other.advance_to(all);
    CHECK(other.hash() == hash);
    CHECK(other.simulation().ledger.last().work == one.simulation().ledger.last().work);
  }
  set_thread_count(1);
  for (const Target widest : {Target::baseline, Target::avx2}) {
    limit_target(widest);
    SceneRun other = run(1);
    other.advance_to(all);
    CHECK(other.hash() == hash);
  }
  limit_target(Target::avx512);
  SceneRun resumed = clump_run(text);
  middle.restore([&](StateVisitor& v) { resumed.simulation().visit(v); });
  resumed.advance_to(all);
  CHECK(resumed.hash() == hash);
  CHECK(resumed.energy_error() == one.energy_error());
}

TEST_CASE("lists of balls that last give the bits of lists made anew in every step, and so do steps that end first",
          "[physics][fused][clump]") {
  set_thread_count(2);
  const std::string text = heap_of_clumps(10, by_mindlin);
  const auto run = [&](bool anew, bool run_on) {
    SceneRun r = clump_run(text);
    Simulation& sim = r.simulation();
    sim.start();
    std::uint64_t lists = 0;
    for (std::uint64_t k = 0; k < 1100; ++k) {
      const std::uint64_t before = sim.work.pairs.generation;
      if (anew) sim.pipeline.broad_phase->reorder({});
      REQUIRE_FALSE(sim.advance(false, run_on && k % 17 != 16 && k + 1 < 1100));
      lists += sim.work.pairs.generation - before;
    }
    CHECK(anew == (lists >= 1100));
    return r.hash();
  };
  const std::string fresh = run(true, false);
  CHECK(run(false, false) == fresh);
  CHECK(run(false, true) == fresh);
  set_thread_count(1);
}

TEST_CASE("friction of clumps goes on while clumps and spheres are poured in among them", "[physics][fused][clump]") {
  set_thread_count(1);
  const auto poured = [](const std::string& shape, double rate) {
    return heap_of_clumps(11, by_mindlin) + "[[fill]]\nshape = '" + shape +
           "'\nmaterial = 'glass'\ncount = 40\nmethod = 'pour'\nrate = " + std::to_string(rate) +
           "\nregion = { box = { min = [-0.02, -0.02, 0.07], max = [0.02, 0.02, 0.09] } }\n";
  };
  const std::string text = GENERATE_COPY(poured("ball", 2000.0), poured("a", 2000.0));
  SceneRun fused = clump_run(text), generic = unfused(clump_run(text));
  fused.simulation().start();
  generic.simulation().start();
  for (int k = 0; k < 600; ++k) {
    REQUIRE_FALSE(fused.simulation().advance(k == 599));
    REQUIRE_FALSE(generic.simulation().advance(k == 599));
  }
  CHECK(fused.simulation().world.size() > 195);
  CHECK(fused.simulation().work.report.touching == generic.simulation().work.report.touching);
  // from the same beginning: differences of rounding have grown by a few collisions
  CHECK(compare(fused, generic).velocity < 1e-6);
  CHECK(fused.simulation().ledger.last().losses.frictional ==
        Approx(generic.simulation().ledger.last().losses.frictional).epsilon(1e-6));
}
