// Contacts of the fused loop as observers see them, among those of others: in canonical order, each with its values,
// the same for every thread count, and together what the bodies feel; read in pieces they are the same ones.
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <tuple>

#include "engine/step/contact_pieces.h"
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"
#include "viz_export/vtk/contact_list.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {
bool is_same(const ContactSet& p, const ContactSet& q) {
  return std::tie(p.a, p.b, p.feature, p.gap, p.normal, p.arm, p.effective_radius, p.area, p.force, p.moment) ==
         std::tie(q.a, q.b, q.feature, q.gap, q.normal, q.arm, q.effective_radius, q.area, q.force, q.moment);
}

/// All pieces, by one thread each, and then in canonical order.
ContactSet read_in_pieces(const Simulation& sim) {
  const ContactPieces pieces(sim.world, sim.work.contacts, sim.pipeline.contact_model.get());
  std::vector<ContactSet> read(pieces.size());
  std::vector<char> is_counted(pieces.size(), 0);
  parallel_for(
      pieces.size(),
      [&](std::size_t k) {
        pieces.read(k, [&](const ContactSet& c, std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            read[k].append(c.a[i], c.b[i], {c.gap[i], c.normal[i], c.arm[i], 0.0, c.feature[i]});
            read[k].force.push_back(c.force[i]);
          }
          is_counted[k] = pieces.all_touching(k).value_or(end - begin) == end - begin;
        });
      },
      1);
  REQUIRE(std::ranges::find(is_counted, 0) == is_counted.end());  // not by each thread: Catch is made for one
  ContactSet all;
  for (const ContactSet& piece : read) {
    all.append(piece);
    all.force.insert(all.force.end(), piece.force.begin(), piece.force.end());
  }
  all.sort();
  return all;
}

bool is_wanted(Slot a, Slot b) { return (a + b) % 3 == 0; }

ContactSet chosen(const Simulation& sim) {
  return ContactPieces(sim.world, sim.work.contacts, sim.pipeline.contact_model.get()).wanted(is_wanted);
}

ContactSet those_of(const ContactSet& all, const ContactModel::Wanted& are_wanted) {
  ContactSet some;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!are_wanted(all.a[i], all.b[i])) continue;
    some.append(all.a[i], all.b[i], {all.gap[i], all.normal[i], all.arm[i], 0.0, all.feature[i]});
    some.force.push_back(all.force[i]);
  }
  return some;
}
}  // namespace

TEST_CASE("contacts of the fused loop are published in canonical order, the same for every thread count",
          "[physics][fused][long]") {
  const support::KeepThreads keep;
  set_thread_count(1);
  const bool rolls = GENERATE(false, true);
  std::vector<std::string> overrides{"params.n=4200", "body.floor.shape={ box = { size = [1, 1, 1] } }",
                                     "body.floor.position=[0, 0, -0.5]"};  // the floor's are of the generic loop
  if (rolls)
    for (const char* more : {"contact.smooth.rolling=spring", "contact.rolling_friction=0.1", "run.time_step=1.9e-5"})
      overrides.emplace_back(more);
  SceneRun run = run_scene("bed/bed.toml", overrides, rolls ? 3400 : 1600);
  REQUIRE(run.assembly->plan.fused_spheres);
  Simulation& sim = run.simulation();
  std::optional<ContactSet> first;
  for (const int threads : {1, 2, 3, 8}) {
    set_thread_count(threads);
    sim.start();  // no step: the same forces again, and none is published
    const std::size_t others = sim.work.contacts.size();
    const ContactSet pieces = read_in_pieces(sim);
    const ContactSet some = chosen(sim);
    sim.pipeline.contact_model->publish(sim.world, sim.work.contacts);
    const ContactSet& c = sim.work.contacts;
    CHECK((others > 50 && c.size() > others + 2000));
    for (std::size_t i = 1; i < c.size(); ++i)
      REQUIRE(std::tuple(c.a[i - 1], c.b[i - 1], c.feature[i - 1]) < std::tuple(c.a[i], c.b[i], c.feature[i]));
    CHECK((c.normal.size() == c.size() && c.force.size() == c.size() && c.moment.size() == (rolls ? c.size() : 0)));
    if (!first) first = c;
    CHECK(is_same(c, *first));
    CHECK(std::tie(pieces.a, pieces.b, pieces.feature, pieces.gap, pieces.normal, pieces.arm, pieces.force) ==
          std::tie(c.a, c.b, c.feature, c.gap, c.normal, c.arm, c.force));
    const ContactSet wanted = those_of(c, is_wanted);
    CHECK((is_same(some, wanted) && is_same(chosen(sim), wanted) && wanted.size() > 500));
    const ContactSet again = read_in_pieces(sim);  // now that all are in the set: none of them twice
    CHECK(std::tie(again.a, again.b, again.force) == std::tie(c.a, c.b, c.force));
  }
  REQUIRE_FALSE(sim.advance(true));  // over no time springs stay as they were, whatever the bodies feel
  sim.pipeline.contact_model->publish(sim.world, sim.work.contacts);
  const ContactSet& c = sim.work.contacts;
  std::vector<Vec3> sum(sim.world.size(), Vec3::Zero());  // what contacts say the bodies feel
  for (std::size_t i = 0; i < c.size(); ++i) {
    sum[c.a[i]] += c.force[i];
    sum[c.b[i]] -= c.force[i];
  }
  double worst = 0.0, most = 0.0;
  for (Slot s = 0; s < sim.world.size(); ++s) {
    if (!sim.world.is_movable(s)) continue;
    worst = std::max(worst, (sum[s] - sim.world.force[s]).norm());
    most = std::max(most, sim.world.force[s].norm());
  }
  CHECK(worst < 1e-12 * most);
}

namespace {

/// Thirty grains that stick, of drawn stiffness, restitution and adhesion, thrown about in a cup.
std::string sticky_cup(const std::string& law, int seed, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  return fmt::format(R"([run]
duration = 0.2
output_interval = 1.0
seed = {}
[world]
gravity = [0, 0, -9.81]
[material.a]
density = 1500.0
youngs_modulus = 1e7
poissons_ratio = 0.1
[material.b]
density = 1500.0
youngs_modulus = {}
poissons_ratio = 0.03
[contact]
method = "smooth"
restitution = {}
friction = 0.8
smooth = {{ law = "{}", work_of_adhesion = {} }}
[shape.grain]
sphere = {{ radius = 0.005 }}
[[body]]
name = "cup"
shape = {{ tube = {{ radius = 0.03, length = 0.4, ends = "closed" }} }}
position = [0, 0, 0.2]
material = "b"
fixed = true
[[fill]]
name = "grains"
shape = "grain"
material = "a"
count = 30
region = {{ box = {{ min = [-0.02, -0.02, 0.005], max = [0.02, 0.02, 0.18] }} }}
velocity_deviation = 0.7
)",
                     seed, 1e6 + 1e7 * unit(random), unit(random), law, 0.1 * unit(random));
}

/// Contacts of all pieces that overlap or carry force, and those that are listed within reach without either.
std::pair<std::size_t, std::size_t> holding_and_idle(const ContactPieces& pieces) {
  std::size_t holding = 0, idle = 0;
  for (std::size_t k = 0; k < pieces.size(); ++k)
    pieces.read(k, [&](const ContactSet& c, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++(c.gap[i] < 0.0 || c.force[i].squaredNorm() > 0.0 ? holding : idle);
    });
  return {holding, idle};
}

}  // namespace

TEST_CASE("frames list those adhesive contacts of the sphere loop that hold, whatever lies within reach",
          "[physics][fused]") {
  std::mt19937 random(11);
  std::size_t within_reach = 0;  // of the last looks, in all draws
  for (int draw = 0; draw < 6; ++draw) {
    const std::string law = draw % 3 == 2 ? "dmt" : "jkr";
    SceneRun run = start_text(sticky_cup(law, draw + 1, random));
    REQUIRE(run.assembly->plan.fused_spheres);
    Simulation& sim = run.simulation();
    for (int look = 0; look < 40; ++look) {
      run.advance_to(sim.steps() + 97);
      const ContactPieces pieces(sim.world, sim.work.contacts, sim.pipeline.contact_model.get());
      const auto [holding, idle] = holding_and_idle(pieces);
      const ContactList list(sim.world, pieces);
      CHECK(list.size() == holding);
      for (std::size_t k = 0; holding > 0 && k + 1 < list.begins().size(); ++k)
        list.read(k, [&](const ContactRows& rows) {
          CHECK((rows.begin() == list.begins()[k] && rows.end() == list.begins()[k + 1]));
        });
      ContactSet copy;
      std::vector<float> residual;
      list.copy(copy, residual);
      CHECK(copy.size() == holding);
      within_reach += idle;
    }
    CHECK(run.failure.empty());
  }
  CHECK(within_reach > 0);  // or the test would have seen nothing
}
