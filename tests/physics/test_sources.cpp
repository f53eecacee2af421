// Bodies that come and go: sizes by distribution, sources that pour, outlets that count, fills by name.
#include <algorithm>
#include <cmath>

#include "engine/state/state_snapshot.h"
#include "engine/units/random.h"
#include "scenes/generators.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Sizes of n bodies of a fill, ascending.
std::vector<double> sizes_of(const FillSpec::Size& size, std::uint64_t n, std::uint64_t seed = 1) {
  FillSpec fill;
  fill.seed = seed;
  fill.method = FillSpec::Method::pour;
  fill.shapes = {0};
  fill.weights = {1.0};
  fill.size = size;
  fill.count = n;
  std::vector<double> sizes;
  for (const FillBody& b : generate(fill, {{1.0, 1.0, true}}).bodies) sizes.push_back(b.size);
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

/// sqrt(n) times the largest distance between the samples' cumulated share and F (Kolmogorov and Smirnov), mean of
/// eight seeds. Of samples that follow F: 0.869, deviation 0.26/sqrt(8) = 0.092 (Kolmogorov's distribution).
template <class F>
double distance(const FillSpec::Size& size, const F& cumulated) {
  const std::uint64_t count = 10000;
  const auto n = static_cast<double>(count);
  double mean = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto sorted = sizes_of(size, count, seed);
    double worst = 0;
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      const double f = cumulated(sorted[k]), i = static_cast<double>(k);
      worst = std::max({worst, std::abs(f - i / n), std::abs(f - (i + 1) / n)});
    }
    mean += std::sqrt(n) * worst / 8;
  }
  return mean;
}

double phi(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

const std::string source_head = R"(title = "s"
run = { duration = 1.0, time_step = 1e-3, output_interval = 0.1 }
material.m = { density = 1000.0, youngs_modulus = "10 kPa", poissons_ratio = 0.25 }
contact = { method = "smooth", restitution = 0.5, friction = 0.3, smooth = { law = "hertz-mindlin" } }
shape.ball = { sphere = { radius = 0.01 } }
)";

}  // namespace

TEST_CASE("sizes of a fill follow their distribution", "[physics][fill]") {
  const std::uint64_t n = 20000;
  const double critical = 0.869 + 4 * 0.092;
  FillSpec::Size uniform{"uniform", 0.5, 2.0, 1, 0, {}, {}};
  CHECK(distance(uniform, [](double x) { return (x - 0.5) / 1.5; }) < critical);
  FillSpec::Size normal{"normal", 0.7, 1.2, 1.0, 0.2, {}, {}};  // cut off unevenly
  const double low = phi(-1.5), high = phi(1.0);
  CHECK(distance(normal, [&](double x) { return (phi((x - 1) / 0.2) - low) / (high - low); }) < critical);
  FillSpec::Size lognormal{"lognormal", 1e-9, 1e9, 2.0, 1.0, {}, {}};
  const double variance = std::log(1 + 0.25), middle = std::log(2.0) - variance / 2;
  CHECK(distance(lognormal, [&](double x) { return phi((std::log(x) - middle) / std::sqrt(variance)); }) < critical);
  double mean = 0;
  for (double s : sizes_of(lognormal, n)) mean += s / static_cast<double>(n);
  CHECK(mean == Approx(2.0).margin(4 * 1.0 / std::sqrt(static_cast<double>(n))));  // 4 deviations of the mean
  FillSpec::Size table{"table", 1, 3, 1, 0, {1, 2, 3}, {0.5, 0.3, 0.2}};
  const auto steps = sizes_of(table, n);
  const auto share = [&](double s) { return static_cast<double>(std::count(steps.begin(), steps.end(), s)) / n; };
  CHECK(share(1) == Approx(0.5).margin(4 * 0.5 / std::sqrt(static_cast<double>(n))));
  CHECK(share(3) == Approx(0.2).margin(4 * 0.4 / std::sqrt(static_cast<double>(n))));
}

TEST_CASE("own velocities of a fill are normal, independent, and leave the places as they are", "[physics][fill]") {
  FillSpec fill;
  fill.method = FillSpec::Method::random;
  fill.shapes = {0};
  fill.weights = {1.0};
  fill.count = 4000;
  fill.region = {Vec3::Zero(), Vec3::Constant(60)};
  const std::vector<FillShape> ball{{1.0, 1.0, true}};
  const auto still = generate(fill, ball).bodies;
  fill.velocity_deviation = 0.25;
  const auto moving = generate(fill, ball).bodies;
  const double n = 4000.0;
  Vec3 mean = Vec3::Zero();
  Mat3 product = Mat3::Zero();
  double fourth = 0.0;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    REQUIRE(moving[k].position == still[k].position);
    REQUIRE(still[k].velocity == Vec3::Zero());
    const Vec3 v = moving[k].velocity / 0.25;
    mean += v / n;
    product += v * v.transpose() / n;
    fourth += v.array().pow(4).sum() / (3 * n);
  }
  CHECK(mean.cwiseAbs().maxCoeff() < 1e-12);  // no momentum
  // four deviations of each mean
  CHECK((product - Mat3::Identity()).cwiseAbs().maxCoeff() < 4 * std::sqrt(2.0 / n));
  CHECK(fourth == Approx(3.0).margin(4 * std::sqrt(96.0 / (3 * n))));
}

TEST_CASE("shares of mass in a table become shares of number", "[physics][fill]") {
  // equal masses of sizes 1 and 2: eight small bodies for each large one
  auto run = start_text(source_head + R"(
[[fill]]
name = "sand"
shape = "ball"
material = "m"
size = { distribution = "table", values = [1, 2], shares = [1, 1], by = "mass" }
count = 3000
region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
)");
  double small = 0, large = 0;
  const World& w = run.simulation().world;
  for (Slot s = 0; s < w.size(); ++s) {
    const double m = 1 / w.inverse_mass[s];
    (m < 2 * 1000 * 4.18879e-6 ? small : large) += m;
  }
  CHECK(small / large == Approx(1.0).margin(0.25));  // 333 +- 17 large ones: 4 deviations are 0.22
}

TEST_CASE("a source pours its bodies at their times, and a restart pours the same", "[physics][fill]") {
  const std::string scene = source_head + R"(world = { gravity = [0, 0, -10] }
[[fill]]
name = "rain"
shape = "ball"
material = "m"
count = 50
method = "pour"
rate = 100.0
from = 0.2
velocity = [0, 0, -1]
region = { box = { min = [-0.1, -0.1, 0.9], max = [0.1, 0.1, 1.0] } }
[[measure]]
kind = "position"
body = "rain[0]"
)";
  auto run = start_text(scene);
  run.advance_to(199);
  CHECK(run.simulation().world.size() == 0);
  run.advance_to(305);  // body k comes at 0.2 s + k / 100
  CHECK(run.simulation().world.size() == 11);
  const World& w = run.simulation().world;
  // the first has flown freely since 0.2 s, one step of 1 ms at most late: z = z0 - t - 5 t^2
  const Slot first = w.slot_of(run.assembly->fill_ids[0][0]);
  CHECK(w.velocity[first].z() == Approx(-1 - 10 * 0.105).margin(0.011));
  StateSnapshot half;
  half.save([&](StateVisitor& v) { run.simulation().visit(v); });
  run.advance_to(900);
  CHECK(run.simulation().world.size() == 50);
  CHECK(run.failure.empty());
  CHECK(std::abs(run.energy_error()) < 1e-9);  // what comes in counts as work
  auto again = start_text(scene);
  half.restore([&](StateVisitor& v) { again.simulation().visit(v); });
  again.advance_to(900);
  CHECK(again.hash() == run.hash());
}

TEST_CASE("mass poured per second is the rate asked for, and nothing overlaps when it comes", "[physics][fill]") {
  // bodies of 4.19 g leave their box all at one speed; the last comes at 0.5 s
  auto run = start_text(source_head + R"([[fill]]
shape = "ball"
material = "m"
size = { distribution = "uniform", min = 0.5, max = 1.5 }
mass = 2.0
method = "pour"
mass_rate = 4.0
velocity = [0, 0, -3]
region = { box = { min = [-0.2, -0.2, 0.8], max = [0.2, 0.2, 1.0] } }
)");
  for (std::uint64_t steps : {200, 400}) {
    run.advance_to(steps);
    double mass = 0;
    const World& w = run.simulation().world;
    for (Slot s = 0; s < w.size(); ++s) mass += 1 / w.inverse_mass[s];
    CHECK(mass == Approx(4e-3 * static_cast<double>(steps)).margin(0.03));  // two of the largest bodies
  }
  run.advance_to(600);
  double mass = 0;
  const World& w = run.simulation().world;
  for (Slot s = 0; s < w.size(); ++s) mass += 1 / w.inverse_mass[s];
  CHECK(mass == Approx(2.0).margin(0.008));                 // to half of the last body
  CHECK(run.simulation().ledger.last().dissipated == 0.0);  // none has touched another
}

TEST_CASE("an outlet takes out what comes into it and counts it once", "[physics][outlet]") {
  // twenty balls at rest in a row at heights of 0.1 to 2 m fall through a box at the ground
  auto run = start_text(source_head + R"X(world = { gravity = [0, 0, -10] }
[[body]]
name = "row"
repeat = 20
shape = "ball"
material = "m"
position = ["= 0.1*i", 0, "= 0.1*(i + 1)"]
[[outlet]]
name = "sink"
region = { box = { min = [-1, -1, -0.5], max = [3, 1, 0] } }
[[measure]]
name = "gone"
kind = "outlet"
outlet = "sink"
)X");
  // after t the balls of h < 5 t^2 are below 0: at 0.59 s those of 0.1 to 1.7
  run.advance_to(590);
  CHECK(run.last("gone", "count") == 17);
  CHECK(run.last("gone", "mass") == Approx(17 * 1000 * 4.1887902e-6));
  CHECK(run.simulation().world.size() == 3);
  CHECK(std::abs(run.energy_error()) < 1e-9);
  run.advance_to(0);
  CHECK(run.last("gone", "count") == 20);
  CHECK(run.simulation().bodies_removed() == 20);
}

TEST_CASE("no body passes an outlet unseen, however thin it is, and a cut run counts the same", "[physics][outlet]") {
  Random random(65, 12);
  for (int draw = 0; draw < 12; ++draw) {
    // balls in a row fall past z = 0, where they have up to 7 m/s: 7 mm a step
    const double thick = std::pow(10.0, random.uniform(-1.9, 0.0)), top = random.uniform(-0.3, 0.1);
    const double low = random.uniform(0.15, 0.5), rise = random.uniform(0.02, 0.1);
    std::string scene = source_head + "world = { gravity = [0, 0, -10] }\n";
    scene +=
        "[[body]]\nname = \"row\"\nrepeat = 20\nshape = \"ball\"\nmaterial = \"m\"\nposition = [\"= 0.1*i\", 0, \"= " +
        std::to_string(low) + " + i*" + std::to_string(rise) + "\"]\n";
    scene += "[[outlet]]\nname = \"sink\"\nregion = { box = { min = [-1, -1, " + std::to_string(top - thick) +
             "], max = [3, 1, " + std::to_string(top) + "] } }\n";
    scene += "[[measure]]\nname = \"gone\"\nkind = \"outlet\"\noutlet = \"sink\"\n";
    CAPTURE(draw, thick, top);
    auto whole = start_text(scene), cut = start_text(scene);
    whole.advance_to(400);
    StateSnapshot state;
    state.save([&](StateVisitor& v) { whole.simulation().visit(v); });
    state.restore([&](StateVisitor& v) { cut.simulation().visit(v); });
    whole.advance_to(0);
    cut.advance_to(0);
    CHECK(whole.last("gone", "count") == 20);
    CHECK(cut.last("gone", "count") == 20);
    CHECK(whole.simulation().bodies_removed() == 20);
  }
}

TEST_CASE("the mass through a plane does not depend on how often it is written", "[physics][outlet]") {
  // poured above the plane and taken out below it, most of them between two samples of the slow measure
  std::string scene = source_head + R"(world = { gravity = [0, 0, -10] }
[[fill]]
name = "rain"
shape = "ball"
material = "m"
count = 60
method = "pour"
rate = 200
velocity = [0, 0, -4]
region = { box = { min = [-0.1, -0.1, 0.3], max = [0.1, 0.1, 0.4] } }
[[outlet]]
name = "sink"
region = { box = { min = [-1, -1, -0.5], max = [1, 1, 0] } }
)";
  for (const char* interval : {"0", "0.003", "0.05", "0.4"})
    scene += std::string("[[measure]]\nname = \"every") + interval +
             "\"\nkind = \"mass_flow\"\ninterval = " + interval +
             "\nplane = { point = [0, 0, 0.15], normal = [0, 0, -1] }\n";
  auto run = start_text(scene);
  run.advance_to(0);
  CHECK(run.simulation().bodies_removed() == 60);
  for (const char* interval : {"0", "0.003", "0.05", "0.4"})
    CHECK(run.last(std::string("every") + interval, "mass") == Approx(60 * 1000 * 4.1887902e-6));
}

TEST_CASE("fills are named in measures and bounds like bodies", "[physics][fill]") {
  auto run = start_text(source_head + R"(world = { gravity = [0, 0, -10] }
[[fill]]
name = "cloud"
shape = "ball"
material = "m"
count = 27
region = { box = { min = [0, 0, 0], max = [0.3, 0.3, 0.3] } }
[[measure]]
name = "all"
kind = "velocity"
body = "cloud"
[[measure]]
name = "one"
kind = "velocity"
body = "cloud[26]"
[bounds]
sag = { body = "cloud", below = 100.0 }
)");
  CHECK(run.assembly->ids(run.assembly->scene.bounds[0].bodies).size() == 27);
  run.advance_to(100);
  CHECK(run.last("all", "z") == Approx(-1.0));
  CHECK(run.last("one", "z") == Approx(-1.0));
}
