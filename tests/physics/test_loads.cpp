// Gravity, forces and torques that follow time: closed forms of one free body, the ledger, driven bodies by tables.
#include <cmath>

#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using experiments::start_text;

namespace {

/// One ball of 1 kg in free space, with what is put in.
std::string ball(const std::string& method, const std::string& run, const std::string& world, const std::string& body) {
  return "[run]\nduration = 1.0\noutput_interval = 0.1\n" + run + "[world]\n" + world +
         "[material.m]\ndensity = 1000.0\nyoungs_modulus = 1e7\npoissons_ratio = 0.3\n[contact]\nmethod = \"" + method +
         "\"\nrestitution = 0.5\nfriction = 0.5\n[[body]]\nname = \"ball\"\nmaterial = \"m\"\n"
         "shape = { sphere = { radius = 0.0620350490899400 } }\n" +
         body;
}

constexpr double mass = 1.0;  // 4/3 pi r^3 rho to 1e-13

}  // namespace

TEST_CASE("a force that follows time moves a free body by its integral, and its work is booked", "[physics][loads]") {
  // m v = F0/w (1 - cos w t), m x = F0/w (t - sin(w t)/w): the step's middle makes both of second order
  const double w = 7.0, force = 3.0;
  for (const std::string method : {"smooth", "nonsmooth"}) {
    double last = 0.0;
    for (const double dt : {2e-3, 1e-3}) {
      INFO(method << " " << dt);
      auto run = start_text(
          ball(method, "time_step = " + std::to_string(dt) + "\n", "", "force = [\"= 3*sin(7*t)\", 0, 0]\n"));
      run.advance_to(0);
      const World& world = run.simulation().world;
      const double t = world.time, v = force / (mass * w) * (1 - std::cos(w * t)),
                   x = force / (mass * w) * (t - std::sin(w * t) / w);
      const double error = std::abs(world.position[0].x() - x);
      CHECK(std::abs(world.velocity[0].x() - v) < force * w * w * dt * dt);
      CHECK(error < force * w * w * dt * dt);
      if (last > 0.0) CHECK(error < 0.3 * last);
      last = error;
      CHECK(std::abs(run.energy_error()) < 1e-3);
      const Energy energy = run.simulation().ledger.measure(world);
      CHECK(energy.potential == 0.0);
      CHECK(energy.work == Approx(energy.kinetic).epsilon(1e-3));
    }
  }
}

TEST_CASE("gravity that follows time along one axis keeps the potential of the others", "[physics][loads]") {
  for (const std::string method : {"smooth", "nonsmooth"}) {
    INFO(method);
    auto run = start_text(ball(method, "time_step = 1e-3\n", "gravity = [\"= 2*sin(3*t)\", 0, -9.81]\n", ""));
    run.advance_to(0);
    const World& world = run.simulation().world;
    const double t = world.time;
    CHECK(world.velocity[0].x() == Approx(2.0 / 3 * (1 - std::cos(3 * t))).epsilon(1e-5));
    CHECK(world.velocity[0].z() == Approx(-9.81 * t).epsilon(1e-12));
    CHECK(run.simulation().ledger.measure(world).potential ==
          Approx(mass * 9.81 * world.position[0].z()).epsilon(1e-9));
    CHECK(std::abs(run.energy_error()) < 1e-6);
  }
}

TEST_CASE("a table of gravity is read along straight lines and held at both ends", "[physics][loads]") {
  auto run = start_text(
      ball("smooth", "time_step = 1e-3\n", "gravity = { table = [[0.2, 0, 0, -1], [0.4, 0, 0, -3]] }\n", ""));
  run.advance_to(0);
  // -1 until 0.2 s, -2 on average until 0.4 s, then -3
  CHECK(run.simulation().world.velocity[0].z() == Approx(-(0.2 * 1 + 0.2 * 2 + 0.6 * 3)).epsilon(1e-9));
}

TEST_CASE("a torque turns a free body by its moment of inertia", "[physics][loads]") {
  const double inertia = 0.4 * mass * 0.0620350490899400 * 0.0620350490899400;
  for (const std::string method : {"smooth", "nonsmooth"}) {
    INFO(method);
    auto run = start_text(ball(method, "time_step = 1e-3\n", "", "torque = [0, 0.001, \"= 0.002*cos(5*t)\"]\n"));
    run.advance_to(0);
    const World& world = run.simulation().world;
    const double t = world.time;
    CHECK(world.angular_velocity[0].y() == Approx(0.001 * t / inertia).epsilon(1e-9));
    CHECK(world.angular_velocity[0].z() == Approx(0.002 / 5 * std::sin(5 * t) / inertia).epsilon(1e-4));
    CHECK(std::abs(run.energy_error()) < 1e-9);
  }
}

TEST_CASE("the path of a driven body is that of its table", "[physics][loads]") {
  // acceleration in a saw of 40 rows: the path is known on every row by exact sums
  std::string rows;
  std::vector<double> value;
  for (int k = 0; k <= 40; ++k) {
    value.push_back(k % 4 == 1 ? 2.0 : k % 4 == 3 ? -2.0 : 0.0);
    rows += (k > 0 ? ", [" : "[") + std::to_string(0.025 * k) + ", " + std::to_string(value.back()) + "]";
  }
  for (const std::string method : {"smooth", "nonsmooth"}) {
    INFO(method);
    auto run =
        start_text(ball(method, "time_step = 2.5e-4\n", "",
                        "motion = { table = [" + rows + "], columns = [\"t\", \"x\"], of = \"acceleration\" }\n"));
    double x = 0.0, v = 0.0;
    for (int k = 0; k < 40; ++k) {
      const double h = 0.025, a = value[static_cast<std::size_t>(k)], b = value[static_cast<std::size_t>(k) + 1];
      x += h * v + h * h * (a / 3.0 + b / 6.0);
      v += 0.5 * h * (a + b);
      run.advance_to(static_cast<std::uint64_t>(100 * (k + 1)));
      CHECK(std::abs(run.simulation().world.position[0].x() - x) < 1e-12);
    }
  }
}

TEST_CASE("several motions act at once: spin and orbit, turn and lift", "[physics][loads]") {
  auto run = start_text(ball("smooth", "time_step = 1e-3\n", "",
                             "position = [1, 0, 0]\nmotion = [{ rotation = { axis = [1, 0, 0], rate = 4.0 } }, "
                             "{ rotation = { axis = [0, 0, 1], rate = 2.0, about = [0, 0, 0] } }, "
                             "{ velocity = [0, 0, 0.3], from = 0.5 }]\n"));
  run.advance_to(0);
  const World& w = run.simulation().world;
  const double t = w.time;
  CHECK((w.position[0] - Vec3(std::cos(2 * t), std::sin(2 * t), 0.3 * (t - 0.5))).norm() < 1e-10);
  // the spin goes along with the orbit: w = 2 e_z + 4 Rz(2t) e_x at the middle of the last step
  const double middle = t - 0.5e-3;
  const Vec3 spin(4 * std::cos(2 * middle), 4 * std::sin(2 * middle), 2.0);
  CHECK((w.angular_velocity[0] - spin).norm() < 1e-4);
}
