// The age of a list decides nothing: scenes whose walls turn, whose cell strains, where bodies are poured in and taken
// out have the same bits with lists that last as with a new one in every step, by another method and for any number of
// threads.
#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string list_age_head = R"(title = "age of lists"
run = { duration = 1.0, time_step = 5e-5, output_interval = 0.5 }
material.m = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.6, friction = 0.5, smooth = { law = "hertz-mindlin" } }
shape.ball = { sphere = { radius = 0.0025 } }
)";

const std::string fill = R"([[fill]]
name = "g"
shape = "ball"
material = "m"
size = { distribution = "uniform", min = 0.9, max = 1.1 }
)";

std::string wall(const std::string& name, const std::string& normal, const std::string& rest) {
  return "[[body]]\nname = \"" + name + "\"\nmaterial = \"m\"\nshape = { half_space = { normal = " + normal + " } }\n" +
         rest + "\n";
}

/// Twelve planes that turn about an axis across gravity, closed by two that stand.
std::string drum() {
  std::string text = list_age_head + "world.gravity = [-9.81, 0, 0]\n";
  for (int k = 0; k < 12; ++k) {
    const double c = std::cos(0.5235987755982988 * k), s = std::sin(0.5235987755982988 * k);
    const auto at = [&](double r) { return "[" + std::to_string(r * c) + ", " + std::to_string(r * s) + ", 0]"; };
    text += wall(
        "p" + std::to_string(k), at(-1.0),
        "position = " + at(0.03) + "\nmotion = { rotation = { axis = [0, 0, 1], rate = 20.0, about = [0, 0, 0] } }");
  }
  text +=
      wall("front", "[0, 0, 1]", "fixed = true") + wall("back", "[0, 0, -1]", "position = [0, 0, 0.03]\nfixed = true");
  return text + fill + "count = 190\nregion = { box = { min = [-0.02, -0.02, 0.001], max = [0.02, 0.02, 0.029] } }\n";
}

std::string cell() {
  return list_age_head +
         "world.domain = { min = [0, 0, 0], max = [0.034, 0.034, 0.034], periodic = [\"x\", \"y\", \"z\"], "
         "strain_rate = [-4.0, -4.0, 2.0] }\n" +
         fill + "count = 200\nvelocity_deviation = 0.5\n" +
         "region = { box = { min = [0, 0, 0], max = [0.034, 0.034, 0.034] } }\n";
}

/// A stream onto a floor beside a hole, below which bodies are taken out.
std::string stream() {
  return list_age_head + "world.gravity = [0, 0, -9.81]\n" + wall("x", "[1, 0, 0]", "fixed = true") +
         wall("y", "[0, 1, 0]", "fixed = true") +
         wall("slope", "[-0.3, -0.3, 0.9]", "position = [0.01, 0.01, 0]\nfixed = true") + fill +
         "count = 600\nmethod = \"pour\"\nrate = 8000\nvelocity = [0, 0, -1]\n" +
         "region = { box = { min = [0.003, 0.003, 0.03], max = [0.04, 0.04, 0.05] } }\n" +
         "[[outlet]]\nname = \"hole\"\nregion = { box = { min = [-1, -1, -1], max = [0.006, 1, 0.004] } }\n";
}

/// Balls of one material, then of another one too, then clumps: what a loop knows of all bodies changes as they come.
std::string mixture() {
  const auto pour = [](const std::string& name, const std::string& shape, const std::string& material, double from) {
    return "[[fill]]\nname = \"" + name + "\"\nshape = \"" + shape + "\"\nmaterial = \"" + material +
           "\"\ncount = 90\nmethod = \"pour\"\nrate = 5000\nfrom = " + std::to_string(from) +
           "\nvelocity = [0, 0, -2]\nregion = { box = { min = [0.003, 0.003, 0.03], max = [0.04, 0.04, 0.05] } }\n";
  };
  return list_age_head + "material.n = { density = 4000.0, youngs_modulus = \"2 MPa\", poissons_ratio = 0.2 }\n" +
         "shape.pair = { clump = { spheres = [[-0.001, 0, 0, 0.002], [0.001, 0, 0, 0.002]] } }\n" +
         "world.gravity = [0, 0, -9.81]\n" + wall("z", "[0, 0, 1]", "fixed = true") +
         wall("x", "[1, 0, 0]", "fixed = true") + wall("y", "[0, 1, 0]", "fixed = true") +
         pour("first", "ball", "m", 0.0) + pour("second", "ball", "n", 0.01) + pour("third", "pair", "m", 0.015) +
         pour("fourth", "pair", "n", 0.02);
}

std::string hash_after(const std::string& scene, int steps, bool fresh) {
  auto run = start_text(scene);
  for (int k = 0; k < steps; ++k) {
    if (fresh) {
      run.simulation().pipeline.broad_phase->reorder({});
      StateSnapshot none;  // after it nobody trusts what it knew of the bodies
      none.save([&](StateVisitor& v) { run.simulation().visit(v); });
    }
    REQUIRE_FALSE(run.simulation().advance().has_value());
  }
  return state_hash(run.simulation().world);
}

}  // namespace

TEST_CASE("the age of a list decides nothing", "[physics][broad][determinism]") {
  const support::KeepThreads keep;
  for (const std::string& scene : {drum(), cell(), stream(), mixture()}) {
    set_thread_count(1);
    constexpr int steps = 900;
    const std::string expected = hash_after(scene, steps, true);
    for (const int threads : {1, 2, 3}) {
      set_thread_count(threads);
      CHECK(hash_after(scene, steps, false) == expected);
    }
    CHECK(hash_after(scene + "[detection]\nbroad_phase = \"aabb-tree\"\n", steps, false) == expected);
  }
}
