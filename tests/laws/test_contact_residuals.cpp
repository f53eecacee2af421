#include "tests/support/catch.h"
#include "tests/support/rigid_experiment.h"

using namespace epafi;
using namespace epafi::test;

namespace {

double sum_of_squares(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v) * v;
  return sum;
}

}  // namespace

TEST_CASE("the squares of the contacts' residuals add up to that of the step", "[laws][residual]") {
  // a stack that falls on a plane, at rest, and with bounces, solved by two sweeps: every step is left open
  for (const double restitution : {0.0, 0.8}) {
    RigidExperiment x({.friction = 0.5, .restitution = restitution, .solver = "pgs"});
    x.settings.parameters.set("iterations", 2.0);
    x.plane(Vec3::Zero(), Vec3::UnitZ());
    for (int k = 0; k < 4; ++k) x.box(Vec3(0.5, 0.5, 0.5), 1000.0, Vec3(0.02 * k, 0, 0.52 + 1.01 * k), Vec3(0, 0, -1));
    int open = 0;
    for (int step = 0; step < 100; ++step) {
      x.run(1);
      const double residual = x.work.report.solver.residual;
      const std::vector<float> parts = contact_residuals(*x.pipeline.contact_model);
      REQUIRE(parts.size() == x.work.contacts.size());
      if (parts.empty()) continue;
      CHECK(std::sqrt(sum_of_squares(parts)) == Approx(residual).epsilon(1e-5).margin(1e-12));
      open += residual > 1e-6 ? 1 : 0;
    }
    CHECK(open > 10);
  }
}
