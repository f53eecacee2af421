// A state shared out and gathered again is the same state; each part is what its bodies and contacts are.
#include <algorithm>
#include <map>

#include "engine/state/types.h"
#include "engine/units/random.h"
#include "ranks/communicator.h"
#include "ranks/state_image.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

struct Spring {
  Slot a, b;
  double load;
};

/// Bodies, contacts with features and records, and springs, as contact models keep them.
struct State {
  double time = 0.0;
  std::vector<Slot> slot_of, a, b;
  std::vector<std::uint32_t> id;
  std::vector<double> x, record;
  std::vector<std::uint64_t> feature;
  std::vector<Spring> springs;

  void visit(StateVisitor& v) {
    v.rows(RowsOf::first_slots, "c/a", a);
    v.rows(RowsOf::second_slots, "c/b", b);
    v.rows(RowsOf::contacts, "c/feature", feature);
    v.rows(RowsOf::contacts, "c/record", record);
    v.rows(RowsOf::pairs, "springs", springs);
    v.value("time", time);
    v.rows(RowsOf::ids, "world/slot_of", slot_of);
    v.rows(RowsOf::bodies, "world/id", id);
    v.rows(RowsOf::bodies, "world/x", x);
  }
  StateWalk walk() {
    return [this](StateVisitor& v) { visit(v); };
  }
};

constexpr std::uint32_t bodies = 60;

/// Body k in slot k with id 7 k mod 61; the last three are held. Contacts of neighbours, two of each pair.
State whole_state() {
  State s;
  s.time = 1.5;
  s.slot_of.assign(61, no_slot);
  for (std::uint32_t k = 0; k < bodies; ++k) {
    s.id.push_back(7 * k % 61);
    s.slot_of[s.id.back()] = k;
    s.x.push_back(0.25 * k);
  }
  for (std::uint32_t k = 0; k + 1 < bodies; ++k)
    for (std::uint64_t f = 0; f < 2; ++f) {
      s.a.push_back(k);
      s.b.push_back(k + 1);
      s.feature.push_back(f);
      s.record.push_back(k + 0.5 * static_cast<double>(f));
    }
  for (std::uint32_t k = 0; k + 2 < bodies; k += 3) s.springs.push_back({k, k + 2, 1.0 / (k + 1)});
  return s;
}

bool is_held(std::uint32_t k) { return k >= bodies - 3; }
/// Changes from round to round, with neighbours on different ranks.
int owner_of(std::uint32_t k, int round) {
  return static_cast<int>((k / 4 + static_cast<std::uint32_t>(round)) % static_cast<std::uint32_t>(rank_count()));
}

/// present: owner by slot of this rank's state, before; all ranks get their bodies and those up to two places away.
Routes routes_of(const std::vector<std::uint32_t>& place, const std::vector<std::uint8_t>& mine, int round) {
  Routes r;
  r.place = place;
  r.mine = mine;
  for (std::size_t s = 0; s < place.size(); ++s) {
    r.begin.push_back(static_cast<std::uint32_t>(r.to.size()));
    const std::uint32_t k = place[s];
    r.owner.push_back(is_held(k) ? Routes::all_ranks : owner_of(k, round));
    std::vector<int> ranks;
    for (std::uint32_t n = k < 2 ? 0 : k - 2; n <= k + 2 && n < bodies && !is_held(k); ++n)
      if (!is_held(n)) ranks.push_back(owner_of(n, round));
    std::ranges::sort(ranks);
    ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
    r.to.insert(r.to.end(), ranks.begin(), ranks.end());
  }
  r.begin.push_back(static_cast<std::uint32_t>(r.to.size()));
  return r;
}

/// Every rank keeps the held bodies, or rank 0 hands them out.
void route_held(Routes& r, bool to_all) {
  Routes wide = r;
  wide.begin.clear();
  wide.to.clear();
  wide.to_all.clear();
  for (int rank = 0; rank < rank_count(); ++rank)
    if (to_all || rank == rank_number()) wide.to_all.push_back(rank);
  for (std::size_t s = 0; s < r.place.size(); ++s) {
    wide.begin.push_back(static_cast<std::uint32_t>(wide.to.size()));
    if (is_held(r.place[s]))
      wide.to.insert(wide.to.end(), wide.to_all.begin(), wide.to_all.end());
    else
      wide.to.insert(wide.to.end(), r.to.begin() + r.begin[s], r.to.begin() + r.begin[s + 1]);
  }
  wide.begin.push_back(static_cast<std::uint32_t>(wide.to.size()));
  r = wide;
}

void check_part(const State& part, const Arrival& got, const State& whole, int round) {
  REQUIRE(part.id.size() == got.place.size());
  CHECK(std::ranges::is_sorted(got.place));
  std::size_t own = 0, expected = 0;
  for (std::uint32_t k = 0; k < bodies; ++k) expected += !is_held(k) && owner_of(k, round) == rank_number();
  for (std::size_t s = 0; s < part.id.size(); ++s) {
    CHECK(part.id[s] == whole.id[got.place[s]]);
    CHECK(part.x[s] == whole.x[got.place[s]]);
    CHECK(part.slot_of[part.id[s]] == s);
    own += got.owner[s] == rank_number();
  }
  CHECK(own == expected);
  const auto is_own = [&](std::uint32_t k) { return !is_held(k) && owner_of(k, round) == rank_number(); };
  std::size_t contacts = 0, springs = 0;
  for (std::uint32_t k = 0; k + 1 < bodies; ++k)
    if (is_own(k) || is_own(k + 1) || (is_held(k) && is_held(k + 1))) contacts += 2;
  for (const Spring& s : whole.springs) springs += is_own(s.a) || is_own(s.b) || (is_held(s.a) && is_held(s.b));
  CHECK(part.a.size() == contacts);
  CHECK(part.springs.size() == springs);
  for (std::size_t c = 0; c < part.a.size(); ++c)
    CHECK(part.record[c] == got.place[part.a[c]] + 0.5 * static_cast<double>(part.feature[c]));
  for (const Spring& s : part.springs) {
    CHECK(got.place[s.b] == got.place[s.a] + 2);
    CHECK(s.load == 1.0 / (got.place[s.a] + 1));
  }
  const auto key = [&](std::size_t c) { return std::tuple(part.a[c], part.b[c], part.feature[c]); };
  for (std::size_t c = 1; c < part.a.size(); ++c) CHECK(key(c - 1) < key(c));
}

/// All bodies to rank 0, held ones from there.
Routes routes_home(const Arrival& got) {
  Routes r;
  r.place = got.place;
  r.gathers = true;
  if (rank_number() == 0) r.to_all = {0};
  for (std::uint32_t s = 0; s < got.place.size(); ++s) {
    const bool held = got.owner[s] == Routes::all_ranks;
    r.owner.push_back(held ? Routes::all_ranks : 0);
    r.mine.push_back(held ? rank_number() == 0 : got.owner[s] == rank_number());
    r.begin.push_back(s);
    r.to.push_back(0);
  }
  r.begin.push_back(static_cast<std::uint32_t>(got.place.size()));
  return r;
}

/// Springs have padding between their numbers.
void check_whole(StateImage& image, const StateImage& before, const State& whole) {
  REQUIRE(image.size() == before.size());
  for (std::size_t c = 0; c < image.size(); ++c) {
    INFO(image[c].name);
    if (image[c].name != "springs") CHECK(image[c].data == before[c].data);
  }
  State back;
  restore(image, back.walk());
  REQUIRE(back.springs.size() == whole.springs.size());
  for (std::size_t k = 0; k < back.springs.size(); ++k)
    CHECK(std::tuple(back.springs[k].a, back.springs[k].b, back.springs[k].load) ==
          std::tuple(whole.springs[k].a, whole.springs[k].b, whole.springs[k].load));
}

}  // namespace

TEST_CASE("a state is shared out, moves from part to part and comes together again to the byte") {
  State whole = whole_state();
  const StateImage before = image_of(whole.walk());
  State part;
  // out
  StateImage image = before;
  std::vector<std::uint32_t> place;
  if (rank_number() == 0)
    for (std::uint32_t k = 0; k < bodies; ++k) place.push_back(k);
  else
    for (ImageColumn& c : image)
      if (c.whose != RowsOf::nobody && c.whose != RowsOf::ids) c.data.clear();
  Routes r = routes_of(place, std::vector<std::uint8_t>(place.size(), 1), 0);
  route_held(r, true);
  Arrival got = exchange_rows(image, r);
  restore(image, part.walk());
  check_part(part, got, whole, 0);
  // from part to part
  for (int round = 1; round < 4; ++round) {
    image = image_of(part.walk());
    std::vector<std::uint8_t> mine;
    for (std::size_t s = 0; s < got.place.size(); ++s)
      mine.push_back(got.owner[s] == Routes::all_ranks || got.owner[s] == rank_number());
    r = routes_of(got.place, mine, round);
    route_held(r, false);
    got = exchange_rows(image, r);
    restore(image, part.walk());
    check_part(part, got, whole, round);
  }
  // and back
  image = image_of(part.walk());
  exchange_rows(image, routes_home(got));
  if (rank_number() == 0) check_whole(image, before, whole);
}
