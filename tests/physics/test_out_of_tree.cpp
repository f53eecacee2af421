// A shape, a law and a solver defined outside of the tree run through the same stages as those inside, by the
// extension points of CONTRIBUTING.md alone.
#include <cmath>

#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/shapes/box.h"
#include "engine/schemes/all_schemes.h"
#include "engine/step/step.h"
#include "laws/nonsmooth/nonsmooth_contact.h"
#include "laws/smooth/friction.h"
#include "laws/smooth/rolling.h"
#include "laws/smooth/smooth_contact.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// All points with |x| + |y| + |z| <= r, by its support function alone.
struct Octahedron {
  static constexpr const char* name = "octahedron";
  double radius = 1.0;
  static Entry entry() {
    return {name, "octahedron", {{"radius", "r", "m", Kind::number, {}, positive, "to a corner"}}, {}, ""};
  }
  double bounding_radius() const { return radius; }
  double contact_radius() const { return radius; }
  double rounding() const { return 0.0; }
  Aabb bounding_box(const Pose& p) const { return {p.position.array() - radius, p.position.array() + radius}; }
  MassProperties mass_properties() const {
    const double m = 4.0 / 3.0 * radius * radius * radius;
    return {m, Vec3::Zero(), 0.2 * m * radius * radius * Mat3::Identity()};
  }
  Vec3 support(const Vec3& d) const {
    int k = 0;
    d.cwiseAbs().maxCoeff(&k);
    Vec3 x = Vec3::Zero();
    x[k] = d[k] < 0 ? -radius : radius;
    return x;
  }
};
static_assert(SolidShape<Octahedron> && ConvexShape<Octahedron>);

/// N = k delta^3, elastic.
struct Cubic {
  static constexpr const char* name = "cubic";
  static constexpr Needs needs{};
  static constexpr bool is_hertzian = false;
  struct Parameters {
    double stiffness;
  };
  static Entry entry() {
    return {name, "cubic spring", {{"stiffness", "k", "N/m^3", Kind::number, {}, positive, ""}}, needs, ""};
  }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair& pair) { return {pair.parameters.number("stiffness")}; }
  static bool is_damped(const Parameters&) { return false; }
  static NormalResponse respond(const Parameters& p, const ContactKinematics& c) {
    const double n = p.stiffness * c.overlap * c.overlap * c.overlap;
    return {n, n, 3 * p.stiffness * c.overlap * c.overlap, 0.25 * n * c.overlap};
  }
};
static_assert(NormalLaw<Cubic>);

/// One relaxed Jacobi sweep after another on the normals: correct for one contact, slow for many.
class JacobiSolver final : public ContactSolver {
 public:
  SolverReport solve(const ContactProblem& problem, Impulses& r) override {
    for (int k = 0; k < 200; ++k) {
      problem.velocities(r, v_);
      problem.relative_velocities(v_, u_);
      for (std::size_t i = 0; i < r.size(); ++i)
        r[i] = Vec3(std::max(0.0, r[i].x() - 0.5 * u_[i].x() / problem.diagonal[i](0, 0)), 0, 0);
    }
    return {true, 200, 0.0};
  }

 private:
  BodyVelocities v_;
  std::vector<Vec3> u_;
};

/// The default cell of two convex shapes, with a shape of this file.
class OctahedronOnBox final : public NarrowPhase {
 public:
  const char* name() const override { return "octahedron on box"; }
  void collide(const World& world, const PairList&, ContactSet& contacts) override {
    contacts.clear();
    ContactSink sink(contacts);
    sink.begin(0, 1);
    epafi::collide(box_, octahedron_, PairQuery{world.pose(0), world.pose(1), reach, false, nullptr}, sink);
    sink.end();
  }
  double reach = 0.0;
  const Box box_{Vec3(5, 5, 1)};
  const Octahedron octahedron_{0.5};
};

/// A box as floor with its face at z = 0 and an octahedron on its corner, `height` above it.
World corner_on_floor(bool smooth, double height) {
  World world(Columns{.rotation = true, .force = smooth});
  world.gravity = Vec3(0, 0, -10);
  Body floor, body;
  floor.position = Vec3(0, 0, -1);
  body.position = Vec3(0, 0, 0.5 + height);
  body.mass = 2.0;
  body.inertia = Vec3::Constant(0.1);
  world.add(floor);
  world.add(body);
  return world;
}

MaterialTable one_material(double stiffness) {
  MaterialTable table{1, std::vector<MaterialPair>(1)};
  table.pairs[0].restitution = 0.0;
  table.pairs[0].parameters.set("stiffness", stiffness);
  return table;
}

class OnePair final : public BroadPhase {
 public:
  const char* name() const override { return "one pair"; }
  void find_pairs(const World&, PairList& pairs) override { pairs.pairs = {{0, 1}}; }
};

}  // namespace

TEST_CASE("a shape and a law from outside oscillate with the amplitude of their energy", "[physics][extensions]") {
  // dropped from h: m g (h + delta) = k delta^4 / 4 at the turning point; energy is kept
  const double k = 2e9, h = 0.01, m = 2.0, g = 10.0;
  World world = corner_on_floor(true, h);
  auto narrow = std::make_unique<OctahedronOnBox>();
  Pipeline stages{std::make_unique<VelocityVerlet>(), std::make_unique<OnePair>(), nullptr,
                  std::make_unique<SmoothContact>(smooth_law<Cubic, NoFriction, NoRolling>(one_material(k)))};
  stages.narrow_phase = std::move(narrow);
  Workspace work;
  double deepest = 0.0;
  for (int i = 0; i < 10000; ++i) {
    step(world, stages, work, 1e-5);
    if (work.contacts.size() > 0) deepest = std::max(deepest, -work.contacts.gap[0]);
  }
  double delta = 0.01;
  for (int i = 0; i < 50; ++i) delta = std::pow(4 * m * g * (h + delta) / k, 0.25);
  CHECK(deepest == Approx(delta).epsilon(1e-3));  // EPA gives the depth to 1e-6 of the size, Verlet 1e-4 at this step
}

TEST_CASE("a solver from outside holds a body at rest", "[physics][extensions]") {
  World world = corner_on_floor(false, 0.0);
  auto narrow = std::make_unique<OctahedronOnBox>();
  narrow->reach = 0.01;
  const SolverEntry jacobi{{"jacobi", "damped Jacobi", {}, {}, ""},
                           [](const Parameters&) { return std::make_unique<JacobiSolver>(); }};
  Pipeline stages{std::make_unique<MoreauJean>(), std::make_unique<OnePair>(), nullptr,
                  make_nonsmooth_contact(NonsmoothSetup{"", {}, one_material(1)}, jacobi)};
  stages.narrow_phase = std::move(narrow);
  Workspace work;
  for (int i = 0; i < 100; ++i) step(world, stages, work, 1e-3);
  // one free step would fall g dt^2 = 1e-5 m and gain g dt = 1e-2 m/s
  CHECK(std::abs(world.position[1].z() - 0.5) < 1e-6);
  CHECK(world.velocity[1].norm() < 1e-9);
  REQUIRE(work.contacts.size() == 1);
  CHECK(work.contacts.force[0].z() == Approx(-20.0).epsilon(1e-9));  // the floor, body A, carries m g
}
