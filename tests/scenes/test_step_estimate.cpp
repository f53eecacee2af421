// Steps that contacts bear, predicted before there are any, against closed forms.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "laws/material.h"
#include "laws/smooth/dashpot.h"
#include "scenes/include/epafi/epafi.h"
#include "scenes/step_estimate.h"
#include "tests/support/catch.h"
#include "tests/support/experiments.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

constexpr double k = 1e6, m = 1e-3;

/// Two equal spheres of mass m by a linear spring; without friction.
ExpectedPair equal_spheres() {
  ExpectedPair pair{0, 0, m, {}};
  pair.at.effective_mass = 0.5 * m;
  pair.at.effective_radius = 1e-3;
  return pair;
}

SmoothSetup linear(double restitution) {
  return experiments::setup_of({"linear", restitution, 0, 0, experiments::parameters_of({{"stiffness", k}})},
                               {Material{"s", 2500, 1e7, 0.2}});
}

}  // namespace

TEST_CASE("an elastic chain and a single contact bear the steps of their closed forms (case B02)",
          "[scenes][step_estimate]") {
  const SmoothSetup setup = linear(1.0);
  const ContactLinks links(setup);
  ExpectedPair pair = equal_spheres();
  CHECK(packing_step(links, pair, 1e-6, 2) == Approx(std::sqrt(m / k)).epsilon(1e-3));
  pair.at.effective_mass = m;  // on a wall: 2/omega
  CHECK(impact_step(links, pair, 1e-6) == Approx(2.0 * std::sqrt(m / k)).epsilon(1e-3));
}

TEST_CASE("a damped chain bears the root -1 of its damper", "[scenes][step_estimate]") {
  for (const double e : {0.6, 0.3, 0.1, 0.02}) {
    const double c = 2.0 * damping_ratio_for(e) * std::sqrt(0.5 * m * k);
    const SmoothSetup setup = linear(e);
    const double dt = packing_step(ContactLinks(setup), equal_spheres(), 1e-6, 2);
    // two contacts of m/2 on each body: 4 (dt^2/4 k + dt c (1 - dt^2 k/(2 m))/(1 + 3 c dt/m)) = m
    const double spring = 0.25 * dt * dt * k;
    const double damper = dt * c * (1.0 - 2.0 * spring / m) / (1.0 + 3.0 * c * dt / m);
    CHECK(4.0 * (spring + damper) == Approx(m).epsilon(2e-3));
    CHECK(dt < std::sqrt(m / k));
  }
}

TEST_CASE("a wheelset's limit counts what its springs press on the rails", "[scenes][step_estimate][wheel_rail]") {
  const auto limit = [](double preload) {
    const std::string press = "[0, 0, " + std::to_string(preload) + "]";
    const experiments::SceneRun run = experiments::prepare_scene(experiments::library("stages/wheelset.toml"),
                                                                 {"spring.0.preload=" + press, "run.time_step=auto"});
    return run.assembly->time_step.limit;
  };
  const double light = limit(0.0), heavy = limit(40e3), heavier = limit(320e3);
  CHECK(heavy < 0.9 * light);
  CHECK(heavier < 0.9 * heavy);
  CHECK(heavy < 2e-4);  // at which the rails give forces of 13 kN to a wheelset that coasts
}

TEST_CASE("capsules of no length and ellipsoids of equal axes bear what the ball does", "[scenes][step_estimate]") {
  // the tenth of a contact's time is that of a quarter of their mass: to the power 2/5 (Hertz)
  const double least = std::pow(0.25, 0.4);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 12; ++k) {
    const double radius = std::pow(10.0, -3.0 + 2.0 * unit(random));
    const double modulus = std::pow(10.0, 5.5 + 3.0 * unit(random));
    const double e = 0.02 + 0.5 * unit(random), friction = unit(random), gravity = 10.0 + 300.0 * unit(random);
    const auto step = [&](const std::string& shape) {
      return load_text(fmt::format(R"scene(run = {{ duration = 1.0 }}
world = {{ gravity = [0, 0, {:.17g}] }}
material.a = {{ density = 2000.0, youngs_modulus = {:.17g}, poissons_ratio = 0.25 }}
contact = {{ method = "smooth", restitution = {:.17g}, friction = {:.17g} }}
[[body]]
name = "floor"
shape = {{ half_space = {{ normal = [0, 0, 1] }} }}
material = "a"
fixed = true
[[body]]
name = "grain"
repeat = [4, 4, 8]
shape = {{ {} }}
material = "a"
position = ["= 2.1*{:.17g}*i", "= 2.1*{:.17g}*j", "= 2.1*{:.17g}*(k + 0.5)"]
)scene",
                                   -gravity, modulus, e, friction, shape, radius, radius, radius))
          ->time_step;
    };
    const TimeStep ball = step(fmt::format("sphere = {{ radius = {:.17g} }}", radius));
    for (const TimeStep& round :
         {step(fmt::format("capsule = {{ radius = {:.17g}, length = {:.17g} }}", radius, 1e-9 * radius)),
          step(fmt::format("ellipsoid = {{ semi_axes = [{0:.17g}, {0:.17g}, {0:.17g}] }}", radius))}) {
      INFO(ball.reason << " | " << round.reason);
      CHECK(round.value >= 0.99 * least * ball.value);
      CHECK(round.value <= ball.value * (1.0 + 1e-9));
      CHECK(round.limit == Approx(ball.limit).epsilon(1e-6));
    }
  }
}
