/// @file wheelset_case.h  Scenes of one wheelset on straight track, as text, and what their runs are asked for.
#pragma once
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "detection/profiles/wheel_rail.h"
#include "engine/state/rotation.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "scenes/railway/profiles.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

namespace epafi::experiments {

using std::numbers::pi;
inline constexpr double r0 = 0.46, wheel_load = 0.5 * (1500 * 9.81 + 50e3);

/// A wheelset of 1.5 t under 50 kN on straight track, in the form of the library's scene, without its springs if free.
struct WheelsetCase {
  std::string wheel = "name = \"cone\"", normal = "hertz", tangential = "fastsim", method = "smooth";
  double speed = 10.0, start = 1e-3, dt = 2e-4, duration = 1.0, kx = 0.0, ky = 0.0, yaw = 0.0;
  double scale = 1.0;  ///< of all masses and loads
  std::string more = "";
};

/// The wheel of a case and the rail of all.
inline Profile wheel_of(const WheelsetCase& c) {
  return Profile(c.wheel.find("cone") != std::string::npos ? cone_profile(0.05) : *built_in_profile("s1002"));
}
inline Profile rail_of_all() { return Profile(canted_rail(*built_in_profile("uic60"), std::atan(1.0 / 40))); }

inline std::string text_of(const WheelsetCase& c) {
  // rolled as it stands on both rails, pressed into them by what the load does to a cone on the crown of 300 mm
  const WheelsetPosition stands = stand_on_rails(wheel_of(c), rail_of_all(), {}, {c.start, 0.0, 0.0, 0.0}).position;
  const double height =
      stands.height +
      hertz_of_force(0.5 / r0, 0.5 / 0.3, 210e9 / (2.0 * (1.0 - 0.28 * 0.28)), c.scale * wheel_load).approach;
  const auto spring = [&](const char* name, double at) {
    const double rest = -c.ky * c.start;  // at rest over the middle of the track
    return fmt::format(
               "[[spring]]\nname = \"{}\"\nbody = \"wheelset\"\nspeed = {:.17g}\nattachment = [0, {}, 0]\n"
               "stiffness = [{}, {}, {}]\ndamping = [0, 0, {}]\n",
               name, c.speed, at, c.kx, c.ky, c.scale * 1e5, c.scale * 1e4) +
           (rest != 0.0 ? fmt::format("preload = [0, {:.17g}, 0]\n", rest) : std::string());
  };
  return fmt::format(
             "[run]\nduration = {:.17g}\ntime_step = {:.17g}\n[world]\ngravity = [0, 0, 9.81]\n"
             "[material.steel]\ndensity = 7850\nyoungs_modulus = \"210 GPa\"\npoissons_ratio = 0.28\n"
             "[contact]\nmethod = \"{}\"\nfriction = 0.3\nrestitution = 0.0\n"
             "[contact.wheel_rail]\nnormal = \"{}\"\ntangential = \"{}\"\n"
             "[contact.nonsmooth]\nsolver = \"nsgs\"\niterations = 200\ntolerance = 1e-9\n"
             "[shape.wheelset]\nwheel_profile = {{ {}, radius = 0.46, mass = {:.17g}, inertia = [{:.17g}, {:.17g}, "
             "{:.17g}] }}\n"
             "[shape.track]\nrail_profile = {{ name = \"uic60\", cant = \"= atan(1/40)\" }}\n"
             "[[body]]\nname = \"track\"\nshape = \"track\"\nmaterial = \"steel\"\nfixed = true\n"
             "[[body]]\nname = \"wheelset\"\nshape = \"wheelset\"\nmaterial = \"steel\"\n"
             "position = [0, {:.17g}, {:.17g}]\neuler_deg = [{:.17g}, 0, {:.17g}]\n",
             c.duration, c.dt, c.method, c.normal, c.tangential, c.wheel, 1500 * c.scale, 950 * c.scale, 120 * c.scale,
             950 * c.scale, c.start, -r0 + height, stands.roll * 180.0 / pi, c.yaw * 180.0 / pi) +
         fmt::format(
             "velocity = [{0:.17g}, 0, 0]\nangular_velocity = [0, {1:.17g}, 0]\nforce = [0, 0, {2:.17g}]\n"
             "[[measure]]\nname = \"run\"\nkind = \"wheelset\"\nbody = \"wheelset\"\ninterval = 0\n",
             c.speed, -c.speed / r0, 50e3 * c.scale) +
         spring("right", 1.0) + spring("left", -1.0) + c.more;
}

/// Lateral place and yaw in every step.
struct Trace {
  std::vector<double> time, lateral, yaw;
  SceneRun run;
};
inline Trace trace_of(const WheelsetCase& c) {
  Trace t{{}, {}, {}, start_text(text_of(c))};
  Simulation& sim = t.run.simulation();
  while (sim.steps() < t.run.assembly->steps) {
    REQUIRE_FALSE(sim.advance());
    t.time.push_back(sim.world.time);
    t.lateral.push_back(t.run.last("run", "lateral"));
    t.yaw.push_back(t.run.last("run", "yaw"));
  }
  return t;
}

/// Times at which the yaw angle passes zero on its way from one side to the other (a tenth of its largest).
inline std::vector<double> crossings(const Trace& t) {
  std::vector<double> out;
  double most = 0.0, side = 0.0, passed = 0.0;
  for (const double y : t.yaw) most = std::max(most, std::abs(y));
  for (std::size_t k = 1; k < t.yaw.size(); ++k) {
    if (t.yaw[k - 1] * t.yaw[k] < 0.0)
      passed = t.time[k - 1] + (t.time[k] - t.time[k - 1]) * t.yaw[k - 1] / (t.yaw[k - 1] - t.yaw[k]);
    if (std::abs(t.yaw[k]) < 0.1 * most || side * t.yaw[k] > 0.0) continue;
    if (side != 0.0) out.push_back(passed);
    side = t.yaw[k];
  }
  return out;
}

/// Growth rate of the lateral swing [1/s] from its extremes after `from` [s]: least squares of their logarithm.
inline double growth(const Trace& t, double from) {
  std::vector<double> when, size;
  for (std::size_t k = 1; k + 1 < t.lateral.size(); ++k) {
    const double y = std::abs(t.lateral[k]);
    if (t.time[k] < from || !(y > std::abs(t.lateral[k - 1])) || !(y >= std::abs(t.lateral[k + 1]))) continue;
    if (!when.empty() && t.time[k] - when.back() < 0.05) continue;  // vibrations on top of the swing
    when.push_back(t.time[k]);
    size.push_back(std::log(y));
  }
  REQUIRE(when.size() > 3);
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < when.size(); ++k) {
    n += 1;
    x += when[k];
    y += size[k];
    xx += when[k] * when[k];
    xy += when[k] * size[k];
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// Acceleration of a scene's wheelset and its angular one, of the engine's own forces.
inline Eigen::Matrix<double, 6, 1> accelerations(Simulation& sim, Slot s) {
  World& w = sim.world;
  evaluate_forces(w, sim.pipeline, sim.work);
  const Mat3 R = w.orientation[s].toRotationMatrix(),
             I = R * w.inverse_inertia_of(s).cwiseInverse().asDiagonal() * R.transpose();
  const Vec3 turn = w.angular_velocity[s];
  Eigen::Matrix<double, 6, 1> a;
  a << w.acceleration(s), I.inverse() * (w.torque[s] - turn.cross(I * turn));
  return a;
}

/// The equations of motion of a scene's wheelset linearised about its present state, by central differences of the
/// engine's own forces: the matrix of displacement, turn, velocity and angular velocity.
inline Eigen::Matrix<double, 12, 12> linearised(SceneRun& run) {
  Simulation& sim = run.simulation();
  World& w = sim.world;
  const Slot s = w.slot_of(BodyId{1});
  const Vec3 x0 = w.position[s], v0 = w.velocity[s], w0 = w.angular_velocity[s];
  const Quat q0 = w.orientation[s];
  Eigen::Matrix<double, 12, 12> A = Eigen::Matrix<double, 12, 12>::Zero();
  const double steps[4] = {2e-6, 2e-6, 2e-4, 2e-4};
  for (int k = 0; k < 12; ++k) {
    Eigen::Matrix<double, 6, 1> side[2];
    const double h = steps[k / 3];
    for (int sign = 0; sign < 2; ++sign) {
      const Vec3 d = (sign ? h : -h) * Vec3::Unit(k % 3);
      w.position[s] = x0 + (k / 3 == 0 ? d : Vec3(Vec3::Zero()));
      w.orientation[s] = k / 3 == 1 ? Quat(turned(q0, d)) : q0;
      w.velocity[s] = v0 + (k / 3 == 2 ? d : Vec3(Vec3::Zero()));
      w.angular_velocity[s] = w0 + (k / 3 == 3 ? d : Vec3(Vec3::Zero()));
      side[sign] = accelerations(sim, s);
    }
    A.block<6, 1>(6, k) = (side[1] - side[0]) / (2.0 * h);
  }
  w.position[s] = x0;
  w.velocity[s] = v0;
  w.orientation[s] = q0;
  w.angular_velocity[s] = w0;
  A.block<3, 3>(0, 6).setIdentity();
  A.block<3, 3>(3, 9).setIdentity();
  A.block<3, 3>(3, 3) << 0, -w0.z(), w0.y(), w0.z(), 0, -w0.x(), -w0.y(), w0.x(), 0;
  return A;
}

/// Growth rate of the least damped oscillation slower than 10 Hz: the kinematic mode of hunting.
inline double linear_growth(WheelsetCase c) {
  c.start = 0.0;
  c.yaw = 0.0;
  c.duration = 1.0;
  SceneRun run = start_text(text_of(c));
  run.advance_to(0);  // settled on the rails
  const Eigen::EigenSolver<Eigen::Matrix<double, 12, 12>> modes(linearised(run));
  double most = -1e9;
  for (int k = 0; k < 12; ++k) {
    const auto mode = modes.eigenvectors().col(k);
    const double sideways = std::abs(mode[1]) + std::abs(mode[5]), others = std::abs(mode[0]) + std::abs(mode[2]);
    const double rate = std::abs(modes.eigenvalues()[k].imag());
    if (rate > 1.0 && rate < 60.0 && sideways > others) most = std::max(most, modes.eigenvalues()[k].real());
  }
  return most;
}

/// Speed at which `rate` passes zero, between two speeds [m/s], to `tolerance` [m/s].
template <class F>
inline double critical_speed(double low, double high, double tolerance, const F& rate) {
  REQUIRE(rate(low) < 0.0);
  REQUIRE(rate(high) > 0.0);
  while (high - low > tolerance) {
    const double middle = 0.5 * (low + high);
    (rate(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Springs that let a cone hunt at a speed of railways.
inline WheelsetCase hunting() {
  WheelsetCase c;
  c.kx = 2e5;
  c.ky = 2e5;
  c.duration = 6.0;
  c.start = 2e-4;
  return c;
}

}  // namespace epafi::experiments
