// Coordination against its definition: neighbours counted pair by pair, rattlers taken away one round after the other.
#include <algorithm>
#include <set>

#include "engine/threads/parallel.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "viz_export/measures/contact_measures.h"

using namespace epafi;

namespace {

/// Random points of random pairs, some apart, some apart with a force, some of bodies that are fixed; the first third
/// with forces, the others gaps alone, as where a model shows contacts of its own. In any order, as balls of clumps
/// come.
ContactSet random_contacts(std::uint64_t seed, Slot bodies, std::size_t pairs) {
  Random random(seed, 1);
  ContactSet c;
  for (std::size_t p = 0; p < pairs; ++p) {
    const auto a = static_cast<Slot>(random.uniform() * (bodies - 1));
    const auto b = a + 1 + static_cast<Slot>(random.uniform() * std::min<double>(30, bodies - a - 1));
    for (double points = random.uniform(0, 3); points > 0; points -= 1) {
      c.a.push_back(a);
      c.b.push_back(b);
      c.gap.push_back(random.uniform(-1, 0.5));
      if (3 * p < pairs) c.force.push_back(random.uniform() < 0.3 ? Vec3(0, 0, 1) : Vec3(0, 0, 0));
    }
  }
  for (std::size_t k = 0; k < c.size(); ++k) {
    const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(c.size()));
    std::swap(c.a[k], c.a[other]);
    std::swap(c.b[k], c.b[other]);
    std::swap(c.gap[k], c.gap[other]);
  }
  return c;
}

std::vector<double> by_definition(const World& world, const ContactSet& c, int least) {
  std::vector<std::set<Slot>> of(world.size());
  for (std::size_t k = 0; k < c.size(); ++k)
    if (c.gap[k] < 0 || (k < c.force.size() && !c.force[k].isZero())) {
      of[c.a[k]].insert(c.b[k]);
      of[c.b[k]].insert(c.a[k]);
    }
  std::vector<bool> in(world.size());
  const auto degree = [&](Slot s) {
    return std::count_if(of[s].begin(), of[s].end(), [&](Slot o) { return in[o] || !world.is_movable(o); });
  };
  const auto mean = [&](double& count) {
    double sum = 0;
    count = 0;
    for (Slot s = 0; s < world.size(); ++s) {
      count += in[s];
      sum += in[s] ? static_cast<double>(degree(s)) : 0.0;
    }
    return count > 0 ? sum / count : 0.0;
  };
  for (Slot s = 0; s < world.size(); ++s) in[s] = world.is_movable(s);
  double all, kept;
  const double number = mean(all);
  for (bool changed = true; changed;) {
    changed = false;
    for (Slot s = 0; s < world.size(); ++s)
      if (in[s] && degree(s) < least) {
        in[s] = false;
        changed = true;
      }
  }
  const double without = mean(kept);
  return {number, without, all - kept};
}

}  // namespace

TEST_CASE("coordination counts pairs that touch, rattlers taken away, for every thread count",
          "[viz_export][measures]") {
  const support::KeepThreads keep;
  for (const auto& [bodies, pairs] :
       {std::pair<Slot, std::size_t>{2, 1}, {40, 90}, {40, 110}, {3000, 9000}, {13000, 37000}}) {
    World world;
    for (Slot s = 0; s < bodies; ++s) {
      Body body;
      body.mass = s % 7 == 5 ? 0.0 : 1.0;
      world.add(body);
    }
    const ContactSet contacts = random_contacts(bodies + pairs, bodies, pairs);
    MeasureSetup setup;
    setup.parameters.set("least", Value(3.0));
    Coordination measure(setup);
    const auto expected = by_definition(world, contacts, 3);
    const PairList none;
    const StepReport report;
    const EnergyLedger ledger;
    for (const int n : {1, 2, 3, 7}) {
      set_thread_count(n);
      std::vector<double> values;
      measure.sample({world, contacts, none, report, ledger, 0, 0.1, 0, false}, values);
      REQUIRE(values.size() == expected.size());
      for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == Approx(expected[k]).epsilon(1e-13));
    }
    if (bodies > 2) CHECK((expected[1] > 3.0 && expected[2] > 0.0));
  }
}
