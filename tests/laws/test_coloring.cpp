#include "laws/nonsmooth/coloring.h"

#include <set>

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
  p.load_contacts(world, contacts), p.load_diagonal();
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

TEST_CASE("a stack needs two colours: the ground does not conflict", "[laws][coloring]") {
  const ContactProblem p = stack_problem(20, 0.5);
  const Coloring& coloring = p.coloring();
  CHECK(coloring.colors() == 2);
  CHECK(coloring.groups().size() == 20);
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
  const auto update = [](Coloring& c, const ContactProblem& p) { c.update(p.a, p.b, p.inverse_mass); };
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
