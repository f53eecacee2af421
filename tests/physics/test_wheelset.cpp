// A wheelset on rails in the engine's own step: Klingel's wave, hunting against a linear analysis of the same model,
// curving, wheel flats, the ledger.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "detection/profiles/wheel_rail.h"
#include "scenes/railway/profiles.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

using std::numbers::pi;
constexpr double r0 = 0.46;

/// A wheelset of 1.5 t under 50 kN on straight track, in the form of the library's scene, without its springs if free.
struct WheelsetCase {
  std::string wheel = "name = \"cone\"", normal = "hertz", tangential = "fastsim", method = "smooth";
  double speed = 10.0, start = 1e-3, dt = 2e-4, duration = 1.0, kx = 0.0, ky = 0.0, yaw = 0.0;
  std::string more = "";
};

std::string text_of(const WheelsetCase& c) {
  const auto spring = [&](const char* name, double at) {
    return fmt::format(
        "[[spring]]\nname = \"{}\"\nbody = \"wheelset\"\nspeed = {:.17g}\nattachment = [0, {}, 0]\n"
        "stiffness = [{}, {}, 1e5]\ndamping = [0, 0, 1e4]\n",
        name, c.speed, at, c.kx, c.ky);
  };
  return fmt::format(
             "[run]\nduration = {:.17g}\ntime_step = {:.17g}\n[world]\ngravity = [0, 0, 9.81]\n"
             "[material.steel]\ndensity = 7850\nyoungs_modulus = \"210 GPa\"\npoissons_ratio = 0.28\n"
             "[contact]\nmethod = \"{}\"\nfriction = 0.3\nrestitution = 0.0\n"
             "[contact.wheel_rail]\nnormal = \"{}\"\ntangential = \"{}\"\n"
             "[contact.nonsmooth]\nsolver = \"nsgs\"\niterations = 200\ntolerance = 1e-9\n"
             "[shape.wheelset]\nwheel_profile = {{ {}, radius = 0.46, mass = 1500, inertia = [950, 120, 950] }}\n"
             "[shape.track]\nrail_profile = {{ name = \"uic60\", cant = \"= atan(1/40)\" }}\n"
             "[[body]]\nname = \"track\"\nshape = \"track\"\nmaterial = \"steel\"\nfixed = true\n"
             "[[body]]\nname = \"wheelset\"\nshape = \"wheelset\"\nmaterial = \"steel\"\n"
             "position = [0, {:.17g}, {:.17g}]\neuler_deg = [0, 0, {:.17g}]\n",
             c.duration, c.dt, c.method, c.normal, c.tangential, c.wheel, c.start, -r0 + 4.4e-5,
             c.yaw * 180.0 / pi) +
         fmt::format(
             "velocity = [{0:.17g}, 0, 0]\nangular_velocity = [0, {1:.17g}, 0]\nforce = [0, 0, 50e3]\n"
             "[[measure]]\nname = \"run\"\nkind = \"wheelset\"\nbody = \"wheelset\"\ninterval = 0\n",
             c.speed, -c.speed / r0) +
         spring("right", 1.0) + spring("left", -1.0) + c.more;
}

/// Lateral place and yaw in every step.
struct Trace {
  std::vector<double> time, lateral, yaw;
  SceneRun run;
};
Trace trace_of(const WheelsetCase& c) {
  Trace t{{}, {}, {}, start_text(text_of(c))};
  Simulation& sim = t.run.simulation();
  while (sim.steps() < t.run.assembly->steps) {
    REQUIRE_FALSE(sim.advance());
    t.time.push_back(sim.world.time), t.lateral.push_back(t.run.last("run", "lateral")),
        t.yaw.push_back(t.run.last("run", "yaw"));
  }
  return t;
}

/// Times at which the yaw angle passes zero.
std::vector<double> crossings(const Trace& t) {
  std::vector<double> out;
  for (std::size_t k = 1; k < t.yaw.size(); ++k)
    if (t.yaw[k - 1] * t.yaw[k] < 0.0)
      out.push_back(t.time[k - 1] + (t.time[k] - t.time[k - 1]) * t.yaw[k - 1] / (t.yaw[k - 1] - t.yaw[k]));
  return out;
}

}  // namespace

TEST_CASE("probe", "[.probe]") {
  WheelsetCase c;
  c.duration = 4.0;
  const Trace t = trace_of(c);
  for (std::size_t k = 0; k < t.time.size(); k += 200)
    WARN(fmt::format("{:.3f} y {:.6f} mm yaw {:.6f} mrad", t.time[k], 1e3 * t.lateral[k], 1e3 * t.yaw[k]));
  for (double x : crossings(t)) WARN(fmt::format("crossing {:.5f} m", c.speed * x));
}
