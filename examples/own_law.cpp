// A contact law in one file, without touching the tree: a progressive spring N = k delta^3. A ball falls on a floor;
// how deep it goes follows from its energy: m g (h + delta) = k delta^4 / 4.
#include <cmath>
#include <cstdio>

#include "detection/narrow/narrow_phase.h"
#include "engine/schemes/all_schemes.h"
#include "engine/step/step.h"
#include "laws/smooth/friction.h"
#include "laws/smooth/rolling.h"
#include "laws/smooth/smooth_contact.h"

using namespace epafi;

// --- the law
struct Cubic {
  static constexpr const char* name = "cubic";
  static constexpr Needs needs{};  // no rotation, no memory, no curvature: nothing of it is stored
  static constexpr bool is_hertzian = false;
  struct Parameters {
    double stiffness;  ///< k [N/m^3], > 0
  };
  static Entry entry() {  // feeds the parser, `epafi list laws` and the reference
    return {name,
            "progressive spring",
            {{"stiffness", "k", "N/m^3", Kind::number, {}, positive, "of the cube of the overlap"}},
            needs,
            ""};
  }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair& pair) { return {pair.parameters.number("stiffness")}; }
  static bool is_damped(const Parameters&) { return false; }
  static NormalResponse respond(const Parameters& p, const ContactKinematics& c) {
    const double n = p.stiffness * c.overlap * c.overlap * c.overlap;
    return {n, n, 3 * p.stiffness * c.overlap * c.overlap,
            0.25 * n * c.overlap};  // force, its elastic part, dN/d delta, energy
  }
};
static_assert(NormalLaw<Cubic>);
// --- the law ends here

namespace {

/// A scene of two bodies needs no search.
class TheOnePair final : public BroadPhase {
 public:
  const char* name() const override { return "the one pair"; }
  void find_pairs(const World&, PairList& pairs) override { pairs.pairs = {{0, 1}}; }
};

}  // namespace

int main() {
  const double k = 2e9, h = 0.01, mass = 2.0, g = 9.81, radius = 0.05;
  ShapeStore shapes;
  World world(Columns{.rotation = true});
  world.gravity = Vec3(0, 0, -g);
  Body floor, ball;
  floor.shape = shapes.add(HalfSpace{Vec3::UnitZ()}).packed;
  ball.shape = shapes.add(Sphere{radius}).packed;
  ball.position = Vec3(0, 0, radius + h);
  ball.mass = mass;
  ball.inertia = Vec3::Constant(0.4 * mass * radius * radius);
  world.add(floor);
  world.add(ball);

  MaterialTable materials{1, std::vector<MaterialPair>(1)};
  materials.pairs[0].restitution = 1.0;
  materials.pairs[0].parameters.set("stiffness", k);
  Pipeline stages{std::make_unique<VelocityVerlet>(), std::make_unique<TheOnePair>(),
                  std::make_unique<BatchNarrowPhase>(shapes, 0.0, false, false),
                  std::make_unique<SmoothContact>(smooth_law<Cubic, NoFriction, NoRolling>(materials))};
  Workspace work;
  double deepest = 0.0, highest = 0.0;
  for (int i = 0; i < 12000; ++i) {
    step(world, stages, work, 1e-5);
    if (work.contacts.size() > 0) deepest = std::max(deepest, -work.contacts.gap[0]);
    if (i > 6000) highest = std::max(highest, world.position[1].z() - radius);
  }
  double exact = 0.01;
  for (int i = 0; i < 100; ++i) exact = std::pow(4 * mass * g * (h + exact) / k, 0.25);
  std::printf("{\"deepest\": %.9g, \"exact\": %.9g, \"rebound\": %.6g}\n", deepest, exact, highest);
  return std::abs(deepest / exact - 1) < 1e-3 && std::abs(highest / h - 1) < 1e-2 ? 0 : 1;
}
