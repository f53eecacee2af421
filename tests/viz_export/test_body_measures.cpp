// Measures that sum over all bodies, against their definitions body by body, the same bits for every thread count.
#include "detection/shapes/sphere.h"
#include "engine/threads/parallel.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "viz_export/measures/body_measures.h"
#include "viz_export/measures/bulk_measures.h"
#include "viz_export/measures/flow_measures.h"

using namespace epafi;

namespace {

/// 5000 spheres in a cube of edge 2, every ninth of them fixed; what falls through z = 0 when all go down by 0.3.
struct Cloud {
  World world;
  ShapeStore shapes;
  MeasureSetup setup;
  double mass_through = 0.0;

  Cloud() {
    Random random(7, 1);
    Body body;
    body.shape = shapes.add(Sphere{0.01}).packed;
    for (int i = 0; i < 5000; ++i) {
      body.position = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      body.mass = i % 9 == 4 ? 0.0 : random.uniform(1, 3);
      world.add(body);
      if (body.position.z() > 0.0 && body.position.z() <= 0.3) mass_through += body.mass;
    }
    setup.shapes = &shapes;
    setup.bodies.resize(2);
    setup.bodies[0].add(BodyId{0}, world.size());
    setup.parameters.set("plane.point", Value(Vec3(0, 0, 0)));
    setup.parameters.set("plane.normal", Value(Vec3(0, 0, -2)));
    setup.parameters.set("window", Value(1.0));
    setup.parameters.set("region.box.min", Value(Vec3(-2, -2, -2)));
    setup.parameters.set("region.box.max", Value(Vec3(2, 2, 2)));
  }
  void fall() {
    for (Slot s = 0; s < world.size(); ++s)
      if (world.is_movable(s)) world.position[s].z() -= 0.3 + (s == 17 ? 0.05 : 0.0);
    world.time += 0.5;
  }
  std::vector<double> sample(Measure& measure) const {
    const PairList none;
    const ContactSet contacts;
    const StepReport report;
    const EnergyLedger ledger;
    std::vector<double> values;
    measure.sample({world, contacts, none, report, ledger, 0, 0.1, 0, false}, values);
    return values;
  }
};

}  // namespace

TEST_CASE("mass flow, drift and solid fraction of many bodies, for every thread count", "[viz_export][measures]") {
  const support::KeepThreads keep;
  std::vector<double> first;
  for (const int n : {1, 2, 3, 7}) {
    INFO(n << " threads");
    set_thread_count(n);
    Cloud cloud;
    MassFlow flow(cloud.setup);
    DriftMeasure drift(cloud.setup);
    SolidFractionMeasure solid(cloud.setup);
    cloud.sample(flow);
    cloud.sample(drift);
    cloud.fall();
    std::vector<double> all = cloud.sample(flow);
    REQUIRE(all.size() == 2);
    CHECK(all[0] == Approx(cloud.mass_through / 0.5).epsilon(1e-12));
    CHECK(all[1] == Approx(cloud.mass_through).epsilon(1e-12));
    const auto way = cloud.sample(drift), share = cloud.sample(solid);
    CHECK(way[0] == 0.0);
    CHECK(way[1] == Approx(0.35).epsilon(1e-12));  // without gravity z is up
    const double ball = 4.18879020478639 * 1e-6;
    CHECK(share[0] == Approx(4444 * ball / 64.0).epsilon(1e-12));
    CHECK(share[1] == 4444.0);
    all.insert(all.end(), way.begin(), way.end());
    all.insert(all.end(), share.begin(), share.end());
    if (first.empty()) first = all;
    CHECK(all == first);
  }
}
