// The slip of a surface that leaves its tangent plane: equal to creepage where it is even, to spin's part where it is
// linear, nothing where all slides.
#include <random>

#include "laws/wheel_rail/tangential/beside_plane.h"
#include "laws/wheel_rail/tangential/kalker_linear.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

NormalPatch ellipse_patch(double a, double b, double load) {
  NormalPatch p;
  p.ellipse = {a, b};
  p.normal_force = load;
  return p;
}

TangentialInput input_on(const NormalPatch& p, const Creepage& creepage) {
  return {p, {82e9, 0.28, 0.0}, 0.3, creepage, {}, false, 0.0};
}

}  // namespace

TEST_CASE("even slip beside the plane is longitudinal creepage", "[laws][wheel_rail]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 40; ++k) {
    const double a = 2e-3 + 6e-3 * unit(random), b = 2e-3 + 6e-3 * unit(random), load = 2e4 + 8e4 * unit(random);
    const NormalPatch p = ellipse_patch(a, b, load);
    // small: F_x = -G a b c11 xi, and one of FASTSIM's 32 cells along the patch more
    const double slip = 2e-6 * load / (82e9 * a * b * 1e-3);
    const double little = force_beside_plane(input_on(p, {}), {-b, b, {slip, slip, slip}});
    const KalkerCoefficients c = kalker_coefficients(a / b, 0.28);
    CHECK(little == Approx(82e9 * a * b * c.c11 * slip * (1.0 + 1.0 / 32.0) / (0.3 * load)).epsilon(2e-3));
    // where all slides along the track already, more slip that way is no more force
    CHECK(force_beside_plane(input_on(p, {0.1, 0.0, 0.0}), {-b, b, {0.01, 0.01, 0.01}}) < 1e-9);
    CHECK(force_beside_plane(input_on(p, {1e-3, 0.0, 0.1}), {}) == 0.0);
  }
}

TEST_CASE("slip beside the plane that changes its sign over the patch leaves the force of small creepage",
          "[laws][wheel_rail]") {
  const NormalPatch p = ellipse_patch(5e-3, 7e-3, 6e4);
  const double slip = 1e-7;
  const TangentialInput in = input_on(p, {});
  CHECK(force_beside_plane(in, {-7e-3, 7e-3, {slip, 0.0, -slip}}) <
        1e-9 * force_beside_plane(in, {-7e-3, 7e-3, {slip, slip, slip}}));
}

TEST_CASE("slip beside the plane is linear between its steps and even beyond them", "[laws][wheel_rail]") {
  const SlipBesidePlane s{-1.0, 1.0, {1.0, 3.0, 2.0}};
  CHECK(s.at(-1.0) == 1.0);
  CHECK(s.at(-0.5) == 2.0);
  CHECK(s.at(0.25) == 2.75);
  CHECK(s.at(1.0) == 2.0);
  CHECK(s.at(-7.0) == 1.0);
  CHECK(s.at(7.0) == 2.0);
  CHECK(SlipBesidePlane{}.at(0.0) == 0.0);
}
