#include "laws/nonsmooth/coloring.h"

#include <map>
#include <set>

#include "engine/state/hash.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"

using namespace epafi;
using namespace epafi::test;

namespace {
/// Every contact once, no free body twice in a colour that runs in parallel.
void check_valid(const ContactProblem& p, const Coloring& coloring) {
  std::vector<int> seen(p.size(), 0);
  for (std::size_t c = 0; c < coloring.colors(); ++c) {
    std::set<Slot> busy;
    for (std::size_t g = coloring.begin(c); g < coloring.begin(c + 1); ++g) {
      const ContactGroup& group = coloring.groups()[g];
      for (std::uint32_t k = 0; k < group.count; ++k) {
        ++seen[group.first + k];
        REQUIRE((p.a[group.first + k] == group.a && p.b[group.first + k] == group.b));
      }
      if (coloring.in_sequence(c)) continue;
      for (const Slot s : {group.a, group.b})
        if (p.is_free(s)) REQUIRE(busy.insert(s).second);
    }
  }
  REQUIRE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

/// One free body in the middle, touched by n others.
ContactProblem star(int n) {
  World world{Columns{.rotation = false, .force = false}};
  for (int i = 0; i <= n; ++i) world.add({.mass = 1.0});
  ContactSet contacts;
  for (Slot b = 1; b <= static_cast<Slot>(n); ++b) contacts.append(0, b, {.gap = 0.0});
  ContactProblem p;
  p.load_bodies(world, 0.1);
  p.load_contacts(world, contacts);
  p.load_diagonal();
  return p;
}
}  // namespace

TEST_CASE("colours never share a free body and cover every contact", "[laws][coloring]") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const ContactProblem p = random_problem(200, seed, true, 0.3);
    check_valid(p, p.coloring());
    CHECK(p.coloring().colors() <= 13);  // greedy: at most 2 * 6 neighbours - 1 taken, plus one
  }
}

// each pair of a path has two neighbours, so a third colour is always left; the ground joins the stacks of no path
TEST_CASE("a stack needs at most three colours: the ground does not conflict", "[laws][coloring]") {
  const ContactProblem p = stack_problem(20, 0.5);
  const Coloring& coloring = p.coloring();
  CHECK(coloring.colors() <= 3);
  CHECK(coloring.groups().size() == 20);
}

namespace {
using IdPair = std::pair<BodyId, BodyId>;

/// Of each pair that is to be coloured its colour, and the number of rounds, by the definition: in a round all pairs
/// take the first free colour whose hash is below those of all neighbours without one.
std::pair<std::map<IdPair, std::size_t>, std::size_t> colors_by_rounds(const ContactProblem& p) {
  struct Pair {
    Slot a, b;
    std::uint64_t hash;
    std::size_t color = Coloring::max_colors;
  };
  std::vector<Pair> pairs;
  for (const ContactGroup& g : p.coloring().groups())
    pairs.push_back({g.a, g.b, mix_bits(std::uint64_t(p.id[g.a]) << 32 | std::uint64_t(p.id[g.b]))});
  const auto meet = [&](const Pair& x, const Pair& y) {
    const auto at = [&](Slot s) { return p.is_free(s) && (s == y.a || s == y.b); };
    return at(x.a) || at(x.b);
  };
  std::size_t rounds = 0;
  for (std::vector<Pair*> chosen{nullptr}; !chosen.empty();) {
    chosen.clear();
    for (Pair& x : pairs)
      if (x.color == Coloring::max_colors && std::ranges::none_of(pairs, [&](const Pair& y) {
            return y.color == Coloring::max_colors && y.hash < x.hash && meet(x, y);
          }))
        chosen.push_back(&x);
    rounds += chosen.empty() ? 0 : 1;
    for (Pair* x : chosen) {
      std::set<std::size_t> used;
      for (const Pair& y : pairs)
        if (y.color != Coloring::max_colors && meet(*x, y)) used.insert(y.color);
      for (x->color = 0; used.contains(x->color);) ++x->color;
    }
  }
  std::map<IdPair, std::size_t> out;
  for (const Pair& x : pairs) out[{p.id[x.a], p.id[x.b]}] = x.color;
  return {out, rounds};
}

std::map<IdPair, std::size_t> colors_of(const ContactProblem& p) {
  const Coloring& coloring = p.coloring();
  std::map<IdPair, std::size_t> out;
  for (std::size_t c = 0; c < coloring.colors(); ++c)
    for (std::size_t g = coloring.begin(c); g < coloring.begin(c + 1); ++g) {
      const ContactGroup& pair = coloring.groups()[g];
      out[{p.id[pair.a], p.id[pair.b]}] = c;
    }
  return out;
}

/// A heap of 500 spheres, each on a few earlier ones; body k lies in slot (k turn) mod 501.
ContactProblem turned_heap(std::size_t turn) {
  constexpr std::size_t n = 501;
  Random random(6, 6);
  const auto vec = [&](double s) { return Vec3(random.uniform(-s, s), random.uniform(-s, s), random.uniform(-s, s)); };
  const auto slot = [&](std::size_t k) { return static_cast<Slot>(k * turn % n); };
  World world{Columns{.rotation = true, .force = false}};
  std::vector<Slot> order(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double mass = k == 0 ? 0.0 : random.uniform(0.5, 2.0);
    world.add({.position = vec(1.0), .velocity = vec(1.0), .mass = mass, .inertia = Vec3::Constant(0.1)});
    order[slot(k)] = static_cast<Slot>(k);
  }
  (void)world.reorder(order);
  struct Meeting {
    Slot a, b;
    ContactPoint point;
  };
  std::vector<Meeting> all;
  for (std::size_t k = 1; k < n; ++k)
    for (const std::size_t by : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{64}})
      all.push_back({slot(k > by ? k - by : 0),
                     slot(k),
                     {.gap = 0.0, .normal = vec(1.0).normalized(), .arm = vec(0.5), .feature = by}});
  std::ranges::sort(all, {}, [](const Meeting& m) { return std::tuple(m.a, m.b, m.point.feature); });
  ContactSet contacts;
  for (const Meeting& m : all) contacts.append(m.a, m.b, m.point);
  ContactProblem p;
  p.load_bodies(world, 0.01);
  p.load_contacts(world, contacts);
  p.load_diagonal();
  p.friction.assign(p.size(), 0.4);
  return p;
}
}  // namespace

TEST_CASE("colours and rounds are those of the definition, and few rounds do", "[laws][coloring]") {
  for (const std::uint64_t seed : {1, 2}) {
    const ContactProblem p = random_problem(100, seed, true, 0.3);
    const auto [colors, rounds] = colors_by_rounds(p);
    CHECK(colors_of(p) == colors);
    CHECK(p.coloring().rounds() == rounds);
  }
  // 27 000 spheres in rows: 87 300 pairs; in canonical order a row alone is a chain of 29
  CHECK(lattice_problem(30, 0.5).coloring().rounds() <= 30);
}

TEST_CASE("colours and what sweeps make of them do not depend on the slots of the bodies", "[laws][coloring]") {
  const ContactProblem straight = turned_heap(1);
  const auto solved = [](const ContactProblem& p, const SolverEntry& entry) {
    Parameters parameters;
    parameters.set("iterations", 20.0);
    parameters.set("tolerance", 1e-30);
    Impulses r(p.size(), Vec3::Zero());
    (void)entry.make(parameters)->solve(p, r);
    std::map<std::tuple<BodyId, BodyId, std::size_t>, std::array<double, 3>> out;
    for (std::size_t i = 0, nth = 0; i < p.size(); ++i) {
      nth = i > 0 && p.a[i] == p.a[i - 1] && p.b[i] == p.b[i - 1] ? nth + 1 : 0;
      out[{p.id[p.a[i]], p.id[p.b[i]], nth}] = {r[i].x(), r[i].y(), r[i].z()};
    }
    return out;
  };
  for (const std::size_t turn : {std::size_t{2}, std::size_t{100}, std::size_t{335}}) {
    const ContactProblem turned = turned_heap(turn);
    REQUIRE(turned.size() == straight.size());
    CHECK(colors_of(turned) == colors_of(straight));
    CHECK(turned.coloring().rounds() == straight.coloring().rounds());
    CHECK(turned.mean_effective_mass() == straight.mean_effective_mass());
    for (const SolverEntry& entry : {pgs_entry(), nsgs_entry()})
      CHECK(solved(turned, entry) == solved(straight, entry));
  }
}

TEST_CASE("a body with more than 63 neighbours leaves the rest to a colour in sequence", "[laws][coloring]") {
  const ContactProblem p = star(100);
  const Coloring& coloring = p.coloring();
  check_valid(p, coloring);
  REQUIRE(coloring.colors() == 64);
  CHECK(coloring.in_sequence(63));
  CHECK_FALSE(coloring.in_sequence(62));
  CHECK(coloring.groups().size() - coloring.begin(63) == 37);
}

TEST_CASE("the colouring is kept while pairs last and follows them when they change", "[laws][coloring]") {
  Coloring coloring;
  const auto update = [](Coloring& c, const ContactProblem& p) { c.update(p.a, p.b, {p.inverse_mass, p.id}); };
  const ContactProblem four = lattice_problem(4, 0.5, 4), one = lattice_problem(4, 0.5, 1);
  const ContactProblem other = lattice_problem(3, 0.5);
  for (const ContactProblem* p : {&four, &one, &other, &four}) {  // four and one: same pairs, other points
    update(coloring, *p);
    check_valid(*p, coloring);
    Coloring anew;
    update(anew, *p);
    REQUIRE(anew.groups().size() == coloring.groups().size());
    for (std::size_t g = 0; g < anew.groups().size(); ++g) CHECK(anew.groups()[g].first == coloring.groups()[g].first);
  }
  CHECK(ContactProblem{}.coloring().colors() == 0);
  CHECK(ContactProblem{}.lane_groups().size() == 0);
}

TEST_CASE("a problem finds its colours and groups anew once its contacts were loaded", "[laws][coloring]") {
  World world{Columns{.rotation = false, .force = false}};
  for (int i = 0; i < 3; ++i) world.add({.mass = 1.0});
  const auto contacts = [](std::initializer_list<std::pair<Slot, Slot>> pairs) {
    ContactSet out;
    for (const auto& [a, b] : pairs) out.append(a, b, {.gap = 0.0});
    return out;
  };
  ContactProblem p;
  p.load_bodies(world, 0.1);
  p.load_contacts(world, contacts({{0, 1}}));
  CHECK(p.lane_groups().size() == 1);
  p.load_contacts(world, contacts({{0, 1}, {1, 2}}));
  CHECK(p.coloring().colors() == 2);
  CHECK(p.lane_groups().size() == 2);
}

TEST_CASE("groups of four have every contact once, in rows as many as the longest lane", "[laws][coloring]") {
  const ContactProblem lattice = lattice_problem(4, 0.5, 3), crowd = star(100);
  for (const ContactProblem* p : {&lattice, &crowd}) {
    const LaneGroups& groups = p->lane_groups();
    std::vector<int> seen(p->size(), 0);
    std::uint32_t rows = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const LaneGroup& group = groups.data()[g];
      REQUIRE(group.begin == rows);
      rows = group.end;
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        REQUIRE(group.count[lane] <= group.end - group.begin);
        for (std::uint32_t k = 0; k < group.count[lane]; ++k) {
          ++seen[group.first[lane] + k];
          REQUIRE(p->a[group.first[lane] + k] == group.a[lane]);
          REQUIRE(p->b[group.first[lane] + k] == group.b[lane]);
        }
      }
    }
    CHECK(rows == groups.rows());
    CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
  }
}

TEST_CASE(
    "a stage of groups is a colour that threads share, or small ones and the one in sequence, one after the other",
    "[laws][coloring]") {
  const ContactProblem lattice = lattice_problem(8, 0.5, 3), crowd = star(100);
  for (const ContactProblem* p : {&lattice, &crowd}) {
    const LaneGroups& groups = p->lane_groups();
    std::size_t shared = 0, at = 0;
    bool before = true;
    for (std::size_t s = 0; s < groups.stages(); ++s) {
      REQUIRE(groups.begin(s) == at);
      at += groups.size(s);
      const bool is_shared = groups.size(s) > groups.piece(s);
      REQUIRE((is_shared || before));  // two stages of one thread would be one
      before = is_shared;
      if (!is_shared) continue;
      shared += groups.size(s);
      std::vector<int> seen(p->inverse_mass.size(), 0);
      for (std::size_t g = groups.begin(s); g < groups.begin(s + 1); ++g)
        for (std::size_t lane = 0; lane < lane_count; ++lane)
          for (const Slot body : {groups.data()[g].a[lane], groups.data()[g].b[lane]})
            if (groups.data()[g].count[lane] > 0 && p->inverse_mass[body] > 0.0) REQUIRE(++seen[body] == 1);
    }
    CHECK(at == groups.size());
    CHECK(shared == groups.shared());
  }
  CHECK(lattice.lane_groups().shared() > 0);
  CHECK(crowd.lane_groups().stages() == 1);  // 64 colours
  CHECK(crowd.coloring().colors() == 64);
}
