// Impacts of one contact alone happen at their own time under the default law: exact at steps of any length.
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/rigid_experiment.h"

using namespace epafi;
using namespace epafi::test;

namespace {

constexpr double ball_gravity = 9.81, ball_radius = 0.5;

RigidSettings single_settings(double restitution, double dt, double friction, double reach) {
  RigidSettings s{.friction = friction, .restitution = restitution, .dt = dt, .reach = reach};
  s.parameters.set("correction", 0.0);
  return s;
}

/// A ball that falls from rest by `height` at time 0.
struct BounceSeries {
  double height, e;
  double first() const { return std::sqrt(2.0 * height / ball_gravity); }
  /// Height above the floor at time t, and how far the nearest impact is.
  double at(double t, double& apart) const {
    double since = t - first(), speed = ball_gravity * first();
    apart = std::abs(since);
    if (since < 0.0) return height - 0.5 * ball_gravity * t * t;
    for (speed *= e; since > 2.0 * speed / ball_gravity; speed *= e) since -= 2.0 * speed / ball_gravity;
    apart = std::min({apart, since, 2.0 * speed / ball_gravity - since});
    return (speed - 0.5 * ball_gravity * since) * since;
  }
};

/// Eight balls in a closed box of 2 m.
struct BoxOfBalls {
  double energy = 0.0;    ///< at the start [J]
  double gained = 0.0;    ///< the most in a step [J]
  double heaviest = 0.0;  ///< [kg]
};

BoxOfBalls gain_in_box(RigidSettings s, double tolerance, std::uint64_t seed) {
  s.reach = 0.1;
  s.solver = "newton";
  s.parameters.set("tolerance", tolerance);
  s.parameters.set("iterations", 200.0);
  s.parameters.set("correction", 0.0);
  RigidExperiment run(s);
  for (const Vec3& n : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    run.plane(-1.0 * n, n);
    run.plane(1.0 * n, -n);
  }
  Random random(seed, 0);
  const auto in = [&](double low, double high) { return random.uniform(low, high); };
  BoxOfBalls out;
  for (int k = 0; k < 8; ++k) {
    const Vec3 at(k % 2 - 0.5, k / 2 % 2 - 0.5, k / 4 - 0.5);
    const Slot ball = run.sphere(in(0.1, 0.4), 1000, at, Vec3(in(-3, 3), in(-3, 3), in(-3, 3)));
    out.heaviest = std::max(out.heaviest, 1.0 / run.world.inverse_mass[ball]);
  }
  out.energy = run.energy();
  for (int k = 0; k < 240; ++k) {
    run.run(1);
    out.gained = std::max(out.gained, -run.work.report.dissipated);
  }
  return out;
}

}  // namespace

TEST_CASE("a bouncing sphere is on the parabolas of n bounces at steps of 1/20 to 1/240 s", "[laws][impact][single]") {
  Random random(11, 0);
  for (const double dt : {0.05, 1.0 / 60.0, 1.0 / 240.0})
    for (const double e : {0.5, 0.8, 1.0})
      for (const double reach : {1e-4, 1.0})  // found when it overlaps, and before it closes
        for (int k = 0; k < 3; ++k) {
          const BounceSeries exact_answer{random.uniform(0.5, 3.0), e};
          RigidExperiment run(single_settings(e, dt, 0.0, reach));
          run.plane(Vec3::Zero(), Vec3::UnitZ());
          const Slot ball = run.sphere(ball_radius, 1000, Vec3(0, 0, ball_radius + exact_answer.height));
          // three bounces, or until they are slower than the law resolves
          const double slowest = 4.0 * ball_gravity * dt;
          double end = exact_answer.first(), speed = ball_gravity * end;
          for (int n = 0; n < 3 && e * speed > slowest; ++n) end += 2.0 * (speed *= e) / ball_gravity;
          for (double t = dt; t < end - dt; t += dt) {
            run.run(1);
            double apart = 0.0;
            const double height = exact_answer.at(t, apart);
            INFO("dt " << dt << " e " << e << " reach " << reach << " height " << exact_answer.height << " t " << t);
            if (apart > dt) CHECK(run.world.position[ball].z() - ball_radius == Approx(height).margin(1e-9));
          }
          CHECK(run.energy() + run.dissipated ==
                Approx(run.world.gravity.norm() * (ball_radius + exact_answer.height) / run.world.inverse_mass[ball]));
        }
}

TEST_CASE("a sphere with spin leaves an oblique impact with the impulse of sticking or sliding",
          "[laws][impact][single]") {
  // J_T = min(mu (1 + e) v_n, 2/7 |v_t - w r|) of the mass: a solid sphere
  Random random(12, 0);
  int sticks = 0;
  for (int k = 0; k < 40; ++k) {
    const double e = random.uniform(0.2, 1.0), mu = random.uniform(0.05, 0.8), dt = random.uniform(2e-3, 0.03);
    const Vec3 v(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, -2));
    const Vec3 spin(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const double height = random.uniform(0.1, 1.0);
    RigidExperiment run(single_settings(e, dt, mu, random.uniform(0, 1) < 0.5 ? 1e-4 : 0.5));
    run.plane(Vec3::Zero(), Vec3::UnitZ());
    const Slot ball = run.sphere(ball_radius, 1000, Vec3(0, 0, ball_radius + height), v, spin);
    const double down = std::sqrt(v.z() * v.z() + 2.0 * ball_gravity * height), time = (down + v.z()) / ball_gravity;
    const int steps = static_cast<int>((time + 0.5 * e * down / ball_gravity) / dt) + 2;
    run.run(steps);
    const Vec3 slip(v.x() - ball_radius * spin.y(), v.y() + ball_radius * spin.x(), 0.0);
    const double most = mu * (1.0 + e) * down, stick = 2.0 / 7.0 * slip.norm();
    sticks += stick < most;
    const Vec3 change = -std::min(most, stick) / slip.norm() * slip;
    const double rest = steps * dt - time;
    const Vec3 place = time * v + rest * (v + change);
    INFO("case " << k << " e " << e << " mu " << mu << " dt " << dt);
    CHECK(run.world.position[ball].x() == Approx(place.x()).margin(1e-8));
    CHECK(run.world.position[ball].y() == Approx(place.y()).margin(1e-8));
    const double risen = (e * down - 0.5 * ball_gravity * rest) * rest;
    CHECK(run.world.position[ball].z() == Approx(ball_radius + risen).margin(1e-8));
    const Vec3 turn = 2.5 / ball_radius * Vec3(0, 0, -1).cross(change);
    CHECK((run.world.angular_velocity[ball] - spin - turn).norm() < 1e-8);
  }
  CHECK(sticks > 5);
  CHECK(sticks < 35);
}

TEST_CASE("spheres that strike alone and together in a box gain no energy beyond the solver's tolerance",
          "[laws][impact][single]") {
  // Newton's law gains up to 9e-2 of it
  for (const double tolerance : {1e-6, 1e-10})
    for (const std::uint64_t seed : {8, 12})
      for (const double dt : {1.0 / 60.0, 1.0 / 240.0})
        for (const double e : {0.7, 1.0})  // below, balls come to rest, where half a step of gravity counts
          for (const double mu : {0.0, 0.4}) {
            const BoxOfBalls b = gain_in_box({.friction = mu, .restitution = e, .dt = dt}, tolerance, seed);
            INFO("tolerance " << tolerance << " seed " << seed << " dt " << dt << " e " << e << " mu " << mu);
            const double fall = b.heaviest * ball_gravity * ball_gravity * dt * dt;
            CHECK(b.gained < tolerance * b.energy + (mu > 0.0 ? 1e-3 * fall : 0.0));
          }
}

TEST_CASE("a ball that leaves an overlap slower than gravity takes it back gains nothing", "[laws][impact][single]") {
  // stopped at u_N = 0 it would gain r u_N / 2; at -u_N it is after the step where it was before, whatever the depth,
  // and the next step stops it, dt/2 u_N deeper
  for (const double dt : {1.0 / 60.0, 1e-3})
    for (const double depth : {0.0, 1e-4, 1e-3, 1e-2, 0.1})
      for (const double share : {0.1, 0.5, 0.9}) {
        RigidExperiment run(single_settings(0.5, dt, 0.0, 0.1));
        run.plane(Vec3::Zero(), Vec3::UnitZ());
        const Vec3 up(0, 0, share * ball_gravity * dt);
        const Slot ball = run.sphere(ball_radius, 1000, Vec3(0, 0, ball_radius - depth), up);
        const double scale = ball_gravity * ball_gravity * dt * dt / run.world.inverse_mass[ball];
        double lowest = 0.0;
        for (int k = 0; k < 10; ++k) {
          run.run(1);
          CHECK(run.work.report.dissipated > -1e-12 * scale);
          lowest = std::min(lowest, run.world.position[ball].z() - (ball_radius - depth));
        }
        INFO("dt " << dt << " depth " << depth << " share " << share);
        CHECK(lowest > -0.5 * dt * up.z() - 1e-12 * ball_radius);
        CHECK(std::abs(run.world.velocity[ball].z()) < 1e-9 * ball_gravity * dt);
      }
}
