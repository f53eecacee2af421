// Every normal law with every law of friction and of rolling friction, in the loop over spheres: over random contacts
// of spheres of several sizes and materials it gives what the generic loop gives, which asks the laws for one contact
// at a time; and the same bits on lanes of two, four and eight numbers and from a state saved on the way.
#include <fmt/format.h>

#include <random>

#include "engine/lanes/targets.h"
#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "laws/smooth/choose_law.h"
#include "tests/support/catch.h"
#include "tests/support/unfused.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

struct LawCase {
  std::string normal, tangential, rolling;
  bool has_friction, rolls;
};

/// Names of the laws that may stand together; of those that share one evaluation the first.
std::vector<LawCase> law_cases() {
  std::vector<LawCase> out;
  const auto with_parts = [&](auto n, auto t) {
    using N = typename decltype(n)::type;
    using T = typename decltype(t)::type;
    if (!std::same_as<Loop<N>, N> || N::needs.area || !T::template fits<N>) return;
    for (const Entry& r : law_entries(RollingLaws{})) {
      const bool rolls = r.name != NoRolling::name;
      if (T::is_present || !rolls) out.push_back({N::name, T::name, r.name, T::is_present, rolls});
    }
  };
  for (const Entry& n : law_entries(NormalLaws{}))
    for (const Entry& t : law_entries(TangentialLaws{}))
      with_law(NormalLaws{}, n.name, [&](auto normal) {
        with_law(TangentialLaws{}, t.name, [&](auto tangential) { with_parts(normal, tangential); });
      });
  return out;
}

std::string contact_table(const LawCase& c, std::size_t materials) {
  const std::map<std::string, std::string> fields{{"linear", "stiffness = 2e4\n"},
                                                  {"walton-braun", "stiffness = 2e4\n"},
                                                  {"hunt-crossley", "reference_speed = 1\n"},
                                                  {"power-law", "exponent = 1.3\nstiffness = 1e5\n"},
                                                  {"kuwabara-kono", "relaxation_time = 1e-5\n"},
                                                  {"dmt", "work_of_adhesion = 5\n"},
                                                  {"jkr", "work_of_adhesion = 5\n"}};
  std::string text = "[contact]\nmethod = 'smooth'\nrestitution = 0.6\n";
  text += c.has_friction ? "friction = 0.3\n" : "friction = 0\n";
  if (c.rolls) text += "rolling_friction = 0.1\n";
  text += "[contact.smooth]\nlaw = '" + c.normal + "'\n";
  if (c.has_friction) text += "tangential = '" + c.tangential + "'\n";
  if (c.rolls) text += "rolling = '" + c.rolling + "'\n";
  if (fields.count(c.normal) > 0) text += fields.at(c.normal);
  for (std::size_t m = 1; m < materials; ++m) {
    const auto number = static_cast<double>(m);
    text += fmt::format("[[contact.pair]]\nbetween = ['m{}', 'm{}']\nrestitution = {}\n", m - 1, m, 0.3 + 0.1 * number);
    if (c.has_friction) text += fmt::format("friction = {}\n", 0.1 * number);
  }
  return text;
}

/// Spheres on a lattice, so large and so far from their places that of neighbours many overlap and some nearly touch.
std::string random_scene(const LawCase& c, std::size_t materials, bool periodic, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  constexpr double spacing = 0.01;
  std::string text = "run = { duration = 1.0, time_step = 2e-6 }\n";
  if (periodic)
    text +=
        "[world.domain]\nmin = [0, 0, 0]\nmax = [0.05, 0.05, 0.05]\nperiodic = ['x', 'y', 'z']\n"
        "strain_rate = [-3, 2, 1]\n";
  for (std::size_t m = 0; m < materials; ++m) {
    const auto number = static_cast<double>(m);
    text += fmt::format("[material.m{}]\ndensity = {}\nyoungs_modulus = {}\npoissons_ratio = {}\n", m,
                        2500.0 + 400.0 * number, 5e6 * (1.0 + number), 0.2 + 0.05 * number);
  }
  text += contact_table(c, materials);
  if (!periodic)
    text +=
        "[[body]]\nname = 'floor'\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = 'm0'\nfixed = true\n";
  for (int i = 0; i < 125; ++i) {
    const auto at = [&](int k) { return spacing * (k + 0.5 + between(-0.08, 0.08)); };
    const double radius = spacing * (i % 7 == 0 ? between(0.2, 0.3) : between(0.46, 0.56));
    text += fmt::format("[[body]]\nshape = {{ sphere = {{ radius = {} }} }}\nmaterial = 'm{}'\n", radius,
                        static_cast<std::size_t>(i) * 7 % materials);
    text += fmt::format("position = [{}, {}, {}]\n", at(i % 5), at(i / 5 % 5), at(i / 25));
    text += fmt::format("velocity = [{}, {}, {}]\n", between(-5, 5), between(-5, 5), between(-5, 5));
    if (c.has_friction)
      text +=
          fmt::format("angular_velocity = [{}, {}, {}]\n", between(-400, 400), between(-400, 400), between(-400, 400));
  }
  return text;
}

SceneRun prepare_text(const std::string& text) {
  return prepare(read_scene_text(text, "scene.toml", {}, full_registry()));
}

constexpr std::uint64_t middle = 5, steps = 12;

/// With another width, and from a state saved in the middle.
std::string hash_of(const std::string& text, Target widest) {
  limit_target(widest);
  SceneRun first = prepare_text(text);
  first.simulation().start();
  first.advance_to(middle);
  StateSnapshot state;
  state.save([&](StateVisitor& v) { first.simulation().visit(v); });
  SceneRun second = prepare_text(text);
  state.restore([&](StateVisitor& v) { second.simulation().visit(v); });
  second.advance_to(steps);
  limit_target(Target::avx512);
  return second.hash();
}

/// narrow: lanes to compare the widest with, by turns.
void check_law(const std::string& text, Target narrow) {
  SceneRun fused = prepare_text(text), generic = unfused(prepare_text(text));
  REQUIRE(fused.assembly->plan.fused_spheres);
  fused.simulation().start();
  generic.simulation().start();
  CHECK(compare(fused, generic).force < 1e-12);  // sums of some ten terms, each to a few ulp of the largest
  fused.advance_to(steps);
  generic.advance_to(steps);
  REQUIRE((fused.failure.empty() && generic.failure.empty()));
  const Difference after = compare(fused, generic);
  CHECK(after.force < 1e-9);  // a gap of 1e-5 radii is known to 1e-11 of itself
  CHECK(after.torque < 1e-9);
  CHECK(after.velocity < 1e-10);
  const StepReport &r = fused.simulation().work.report, &q = generic.simulation().work.report;
  CHECK(q.touching > 100);
  CHECK(r.touching == q.touching);
  CHECK(r.elastic == Approx(q.elastic).epsilon(1e-9));
  const Losses &lost = fused.simulation().ledger.last().losses, &same = generic.simulation().ledger.last().losses;
  const double margin = 1e-9 * (std::abs(q.elastic) + same.viscous + same.frictional);
  CHECK(lost.viscous == Approx(same.viscous).epsilon(1e-7).margin(margin));
  CHECK(lost.frictional == Approx(same.frictional).epsilon(1e-7).margin(margin));
  CHECK(lost.plastic == Approx(same.plastic).epsilon(1e-7).margin(margin));
  CHECK(lost.adhesive == Approx(same.adhesive).epsilon(1e-7).margin(margin));
  CHECK(hash_of(text, narrow) == fused.hash());
}

}  // namespace

TEST_CASE("every law of contact in the loop over spheres answers as one contact at a time",
          "[physics][fused][laws][long]") {
  set_thread_count(1);
  const std::vector<LawCase> cases = law_cases();
  CHECK(cases.size() > 100);
  constexpr std::size_t materials[] = {1, 2, 5};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const LawCase& c = cases[k];
    const std::size_t count = materials[k % 3];
    const bool periodic = k % 2 == 1;
    INFO(c.normal << ", " << c.tangential << ", " << c.rolling << ", " << count << " materials"
                  << (periodic ? ", periodic" : ""));
    check_law(random_scene(c, count, periodic, static_cast<unsigned>(k)), k % 4 < 2 ? Target::baseline : Target::avx2);
  }
}
