// Walls that press with a given force, and time steps that follow the motion.
#include <fmt/format.h>

#include <cmath>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/support/scene_text.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string servo_head = R"(title = "s"
material.m = { density = 2000.0, youngs_modulus = "10 MPa", poissons_ratio = 0.25 }
)";

/// A ball between a floor and a lid at `height` that a servo presses on it.
std::string pressed_ball(const std::string& run, const std::string& floor, double height, const std::string& servo) {
  return servo_head + "run = { " + run + ", output_interval = 0.1 }" + R"(
contact = { method = "smooth", restitution = 0.5, friction = 0.3, smooth = { law = "hertz-mindlin" } }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
)" + floor +
         R"(
[[body]]
name = "lid"
shape = { half_space = { normal = [0, 0, -1] } }
material = "m"
position = [0, 0, )" +
         std::to_string(height) + "]\nmotion = { servo = { force = 20.0, max_speed = 0.1, " + servo + R"( } }
[[body]]
name = "ball"
shape = { sphere = { radius = 0.05 } }
material = "m"
position = [0, 0, 0.0499]
)" + contact_measure("top", "lid", "ball") +
         contact_measure("bottom", "floor", "ball") + velocity_measure("lid");
}

}  // namespace

TEST_CASE("a servo wall closes in as a damped body does and then carries its force", "[physics][servo]") {
  // v = v_max (1 - exp(-t/tau)), tau = m v_max / F = 0.05 s, until it meets the ball between it and the floor
  auto run = start_text(
      pressed_ball("duration = 3.2, time_step = 2e-5", "fixed = true", 0.2, "direction = [0, 0, -3], mass = 10.0"));
  run.advance_to(5000);  // 0.1 s
  CHECK(run.last("lid", "z") == Approx(-0.1 * (1 - std::exp(-2.0))).epsilon(1e-3));
  run.advance_to(0);
  CHECK(run.last("top", "normal_force") == Approx(20.0).epsilon(1e-6));
  CHECK(run.last("bottom", "normal_force") == Approx(20.0).epsilon(1e-6));
  CHECK(std::abs(run.last("lid", "z")) < 1e-9);
  CHECK(std::abs(run.energy_error()) < 1e-2);
}

TEST_CASE("a loop of two gains carries its force on a rising floor, with one it is off by u/p", "[physics][servo]") {
  // v = p e + i (integral of e), e = F - F_contact. While the floor rises at u the lid goes back at u: without integral
  // e = -u/p stays, with it e goes to zero. At rest nothing is left in either.
  const double force = 20.0, rise = 2e-3, gain = 1e-3;
  for (const double integral : {0.0, 5e-2}) {
    INFO(integral);
    const std::string gains = fmt::format("direction = [0, 0, -1], gains = [{}, {}]", gain, integral);
    auto run = start_text(pressed_ball("duration = 1.0, time_step = 5e-5",
                                       fmt::format("motion = {{ velocity = [0, 0, {}] }}", rise), 0.0998, gains));
    run.advance_to(0);
    CHECK(run.last("top", "normal_force") == Approx(integral > 0.0 ? force : force + rise / gain).epsilon(1e-4));
    CHECK(run.last("lid", "z") == Approx(rise).epsilon(1e-4));
  }
}

TEST_CASE("a servo beside a table closes in as alone, and the table is followed beside it", "[physics][servo]") {
  // v = v_max (1 - exp(-t/tau)), tau = m v_max / F = 5 ms; no contact
  const double most = 0.1, tau = 5e-3, time = 0.1;
  for (const char* method : {"smooth", "nonsmooth"}) {
    INFO(method);
    auto run = start_text(servo_head + "contact = { method = \"" + method + R"(", restitution = 0, friction = 0 }
run = { duration = 0.1, time_step = 1e-4, output_interval = 0.1 }
[[body]]
name = "lid"
shape = { half_space = { normal = [0, 0, -1] } }
material = "m"
[body.motion]
table = [[0, 0, 0, 0], [0.05, 0.01, 0, 0.002], [0.1, 0, 0, 0.001]]
of = "displacement"
servo = { force = 20.0, direction = [0, 0, -1], mass = 1.0, max_speed = 0.1 }
[[body]]
name = "ball"
shape = { sphere = { radius = 0.05 } }
material = "m"
position = [0, 0, -1]
)");
    run.advance_to(0);
    const World& world = run.simulation().world;
    const Vec3 lid = world.position[world.slot_of(Assembly::body_id(0))];
    CHECK(lid.x() == Approx(0.0).margin(1e-9));
    CHECK(lid.z() == Approx(0.001 - most * (time - tau * (1 - std::exp(-time / tau)))).epsilon(1e-2));
  }
}

TEST_CASE("a servo wall presses a bed of many spheres with its stress", "[physics][servo][long]") {
  // 128 spheres on a fixed plane: those contacts go through the fused loop, the lid's do not
  auto run = start_text(servo_head + R"(
run = { duration = 0.25, time_step = 1e-5, output_interval = 0.1 }
contact = { method = "smooth", restitution = 0.2, friction = 0.3, smooth = { law = "hertz-mindlin" } }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
[[body]]
name = "lid"
shape = { half_space = { normal = [0, 0, -1] } }
material = "m"
position = [0, 0, 0.0401]
motion = { servo = { stress = 1000.0, area = 0.0256, direction = [0, 0, -1], mass = 1.0, max_speed = 0.05 } }
[[body]]
name = "bed"
repeat = [8, 8, 2]
shape = { sphere = { radius = 0.01 } }
material = "m"
position = ["= 0.02001*i", "= 0.02001*j", "= 0.01 + 0.02*k"]
[[measure]]
name = "lid"
kind = "contact"
between = ["lid", "bed"]
[[measure]]
name = "floor"
kind = "contact"
between = ["floor", "bed"]
)");
  CHECK(run.assembly->plan.fused_spheres);
  run.advance_to(0);
  CHECK(run.last("lid", "normal_force") == Approx(25.6).epsilon(1e-3));
  CHECK(run.last("floor", "normal_force") == Approx(25.6).epsilon(1e-3));
}

TEST_CASE("an adaptive time step resolves slow impacts as well as fast ones at less cost", "[physics][adaptive]") {
  const auto run_at = [](double speed, const std::string& step) {
    char text[800];
    std::snprintf(
        text, sizeof text,
        "run = { duration = 1.0, time_step = \"%s\", output_interval = 0.1 }\n"
        "contact = { method = \"smooth\", restitution = 0.8, friction = 0.0, smooth = { law = \"hertz\" } }\n"
        "[[body]]\nname = \"fast\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\n"
        "position = [0, 5, 0]\nvelocity = [0, 10, 0]\nremove_at = 1e-3\n"
        "[[body]]\nname = \"a\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\nvelocity = [%g, 0, 0]\n"
        "[[body]]\nname = \"b\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\nposition = [0.021, 0, 0]\n",
        step.c_str(), speed);
    return start_text(servo_head + text);
  };
  const double speed = 0.1;
  auto fixed = run_at(speed, "auto"), adaptive = run_at(speed, "adaptive");
  // the present speed counts twice (head-on): 0.2 of 20 m/s, contact times go like v^(-1/5)
  CHECK(adaptive.assembly->time_step.value ==
        Approx(fixed.assembly->time_step.value * std::pow(1e3, 0.2)).epsilon(0.02));
  adaptive.advance_to(0);
  fixed.advance_to(0);
  const auto out = [](SceneRun& r) {
    const World& w = r.simulation().world;
    return w.velocity[w.slot_of(Assembly::body_id(2))].x() - w.velocity[w.slot_of(Assembly::body_id(1))].x();
  };
  CHECK(out(fixed) == Approx(0.8 * speed).epsilon(0.01));
  CHECK(out(adaptive) == Approx(0.8 * speed).epsilon(0.02));
  const double saved =
      static_cast<double>(fixed.simulation().parts_made()) / static_cast<double>(adaptive.simulation().parts_made());
  CHECK(saved == Approx(std::pow(1e3, 0.2) / 2).epsilon(0.02));  // 1.6 of the shortest steps would do, two are made
  CHECK(adaptive.simulation().world.time == Approx(1.0).epsilon(1e-3));
}

namespace {

/// A plate of its own mass is pressed on a column of two cubes of 100 mm on a floor; all of it rigid.
std::string pressed_column(const std::string& contact, const std::string& floor, const std::string& motion) {
  return R"(
title = "p"
run = { duration = 0.8, time_step = 1e-3, output_interval = 0.1 }
material.m = { density = 1000.0 }
world.gravity = [0, 0, -9.81]
contact = { method = "nonsmooth", restitution = 0.0, friction = 0.4, nonsmooth = { )" +
         contact + R"( } }
[[body]]
name = "floor"
shape = { box = { size = [1, 1, 0.1] } }
material = "m"
position = [0, 0, -0.05]
)" + floor +
         R"(
[[body]]
name = "plate"
shape = { box = { size = [0.5, 0.5, 0.02] } }
material = "m"
position = [0, 0, 0.213]
motion = )" +
         motion + R"(
[[body]]
name = "cube"
repeat = 2
shape = { box = { size = [0.1, 0.1, 0.1] } }
material = "m"
position = [0, 0, "= 0.05 + 0.1*i"]
)" + contact_measure("top", "plate", "cube") +
         contact_measure("bottom", "floor", "cube") + velocity_measure("plate");
}

const char* const floor_at_rest = "fixed = true";

}  // namespace

TEST_CASE("a plate carries its load on rigid bodies, by every kind of solver", "[physics][servo]") {
  // force and weight are carried; default tolerance 1e-6 of a step of gravity
  const double force = 30.0, weight = 2 * 9.81;
  for (const char* solver : {"pgs", "nsgs", "newton", "apgd", "admm", "adaptive"})
    for (const char* kind : {"mass = 0.5", "gains = [1e-3, 5e-2]"}) {
      INFO(solver << ", " << kind);
      const std::string servo =
          fmt::format("{{ servo = {{ force = {}, direction = [0, 0, -1], max_speed = 0.1, {} }} }}", force, kind);
      auto run = start_text(pressed_column(fmt::format("solver = \"{}\"", solver), floor_at_rest, servo));
      run.advance_to(50);  // 50 ms: 3 mm are left open, less than v_max allows for
      CHECK(run.last("plate", "z") > -0.1 - 1e-9);
      run.advance_to(0);
      CHECK(run.last("top", "normal_force") == Approx(force).epsilon(1e-4));
      CHECK(run.last("bottom", "normal_force") == Approx(force + weight).epsilon(1e-4));
      CHECK(std::abs(run.last("plate", "z")) < 1e-6);
    }
}

TEST_CASE("a rigid column that rises lifts its plate, which carries its load meanwhile", "[physics][servo]") {
  // F + F u/v_max with the damping of a mass, F with two gains, F + u/p with one
  const double force = 30.0, rise = 2e-3, most = 0.1, gain = 1e-3;
  const std::vector<std::pair<std::string, double>> kinds{{"mass = 0.5", force * (1.0 + rise / most)},
                                                          {"gains = [1e-3, 5e-2]", force},
                                                          {"gains = [1e-3, 0]", force + rise / gain}};
  for (const auto& [kind, expected] : kinds) {
    INFO(kind);
    auto run = start_text(pressed_column(
        "solver = \"newton\"", fmt::format("motion = {{ velocity = [0, 0, {}] }}", rise),
        fmt::format("{{ servo = {{ force = {}, direction = [0, 0, -2], max_speed = {}, {} }} }}", force, most, kind)));
    run.advance_to(0);
    CHECK(run.last("top", "normal_force") == Approx(expected).epsilon(1e-6));
    CHECK(run.last("plate", "z") == Approx(rise).epsilon(1e-6));
    CHECK(std::abs(run.energy_error()) < 1e-6);  // the plate's work is booked
  }
}

TEST_CASE("a plate that is drawn over rigid bodies shears them by mu F and stays on its line", "[physics][servo]") {
  // the cubes cannot follow at 0.2 m/s: they slip, tangential force mu N
  const double force = 30.0;
  const std::string motion = fmt::format(
      "{{ velocity = [0.2, 0, 0], servo = {{ force = {}, direction = [0, 0, -1], mass = 0.5, max_speed = "
      "0.1 }} }}",
      force);
  auto run = start_text(pressed_column("solver = \"newton\"", floor_at_rest, motion));
  run.advance_to(300);
  const World& world = run.simulation().world;
  const Slot plate = world.slot_of(Assembly::body_id(1));
  CHECK(world.velocity[plate].x() == Approx(0.2).epsilon(1e-12));
  CHECK(world.position[plate].x() == Approx(0.2 * 0.3).epsilon(1e-9));
  CHECK(world.position[plate].y() == 0.0);
  CHECK(run.last("top", "normal_force") == Approx(force).epsilon(1e-2));
  CHECK(run.last("top", "tangential_force") <= 0.4 * force * 1.01);
}

namespace {

/// A box between two pads that servos press on it, on a floor or in the air, all of it turned as space is.
struct Gripper {
  double capacity = 1.0;  ///< friction of both pads over the weight
  double speed = 0.0;     ///< of the pads upwards, from 0.1 s on; 0: they stay where they are and there is no floor
  Vec3 size = Vec3::Ones();
  double density = 1000.0, friction = 0.5, wall_mass = 0.1;  ///< of the walls over that of the box
  Quat turn = Quat::Identity();
};
constexpr double gripper_gravity = 9.81, gripper_end = 0.4, lift_from = 0.1;

Gripper draw_gripper(Random& random) {
  Gripper g;
  g.capacity = random.uniform(0.0, 1.0) < 0.5 ? random.uniform(0.8, 0.95) : random.uniform(1.05, 3.0);
  for (int k = 0; k < 3; ++k) g.size[k] = 0.1 * random.uniform(0.5, 1.5);
  g.speed = g.capacity < 1.0 || random.uniform(0.0, 1.0) < 0.7 ? random.uniform(0.02, 0.1) : 0.0;
  g.density = random.uniform(500.0, 8000.0);
  g.friction = random.uniform(0.2, 1.2);
  g.wall_mass = std::pow(10.0, random.uniform(-2.0, 0.0));
  const Vec3 axis(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  g.turn = Quat(Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis.normalized()));
  return g;
}

std::string text_of(const Gripper& g, const char* solver, Random& random) {
  const auto turned = [&](const Vec3& x) {
    const Vec3 y = g.turn * x;
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", y.x(), y.y(), y.z());
  };
  const std::string turn = fmt::format("orientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\nmaterial = \"m\"\n",
                                       g.turn.w(), g.turn.x(), g.turn.y(), g.turn.z());
  const double mass = g.density * g.size.prod(), force = g.capacity * mass * gripper_gravity / (2.0 * g.friction);
  std::string out = fmt::format(
      "run = {{ duration = {}, time_step = 1e-3 }}\nworld.gravity = {}\nmaterial.m = {{ density = {:.17g} }}\n"
      "contact = {{ method = \"nonsmooth\", restitution = 0, friction = {:.17g}, nonsmooth = {{ solver = \"{}\" }} }}\n"
      "[[body]]\nname = \"box\"\nshape = {{ box = {{ size = [{:.17g}, {:.17g}, {:.17g}] }} }}\n{}",
      gripper_end, turned({0, 0, -gripper_gravity}), g.density, g.friction, solver, g.size.x(), g.size.y(), g.size.z(),
      turn);
  if (g.speed > 0.0)
    out += fmt::format(
        "[[body]]\nname = \"floor\"\nfixed = true\nmaterial = \"m\"\nposition = {}\n"
        "shape = {{ half_space = {{ normal = {} }} }}\n",
        turned({0, 0, -0.5 * g.size.z()}), turned({0, 0, 1}));
  const double width = random.uniform(0.3, 0.9) * g.size.y(), height = random.uniform(0.3, 0.6) * g.size.z();
  const std::string lift =
      g.speed > 0.0 ? fmt::format(", {{ velocity = {}, from = {} }}", turned({0, 0, g.speed}), lift_from) : "";
  for (const double side : {-1.0, 1.0})
    out += fmt::format(
        "[[body]]\nname = \"{}\"\nshape = {{ box = {{ size = [0.02, {:.17g}, {:.17g}] }} }}\n{}"
        "position = {}\nmotion = [{{ servo = {{ force = {:.17g}, direction = {}, mass = {:.17g} }} }}{}]\n",
        side < 0.0 ? "left" : "right", width, height, turn, turned({side * (0.5 * g.size.x() + 0.01), 0, 0}), force,
        turned({-side, 0, 0}), g.wall_mass * mass, lift);
  return out;
}

/// Height of the box at the end: it slips until it is as fast as the pads.
double lifted(const Gripper& g) {
  if (g.speed == 0.0 || g.capacity < 1.0) return 0.0;
  const double gain = (g.capacity - 1.0) * gripper_gravity, time = gripper_end - lift_from, slips = g.speed / gain;
  return time < slips ? 0.5 * gain * time * time : g.speed * time - 0.5 * g.speed * slips;
}

}  // namespace

TEST_CASE("a box that slips between the pads of a gripper does not tilt, by any kind of solver", "[physics][servo]") {
  // Pads do not turn: every centre of pressure on them solves the step, and friction at one edge of both tilts the box.
  // Its way is that of mu F on both sides, to one step of the lift.
  Random random(62, 0);
  for (const char* solver : {"adaptive", "auto", "pgs", "nsgs"})
    for (int draw = 0; draw < 8; ++draw) {
      const Gripper g = draw_gripper(random);
      auto run = start_text(text_of(g, solver, random));
      run.advance_to(0);
      const World& world = run.simulation().world;
      const Slot box = world.slot_of(Assembly::body_id(0));
      const Vec3 at = g.turn.conjugate() * world.position[box];
      INFO(solver << " draw " << draw << ": capacity " << g.capacity << ", speed " << g.speed << ", at "
                  << at.transpose());
      CHECK(run.failure.empty());
      CHECK(std::abs(at.z() - lifted(g)) < g.speed * 1e-3 + 1e-5);
      CHECK(std::hypot(at.x(), at.y()) < 1e-5);
      CHECK(world.orientation[box].angularDistance(g.turn) < 1e-4);
    }
}
