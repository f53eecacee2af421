#include "engine/step/warnings.h"

#include "engine/state/state_snapshot.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

void add_two_kinds(Warnings& w) {
  w.add({.kind = "energy", .text = "open by 0.02", .first_step = 100, .first_time = 0.1, .value = 0.02});
  w.add({.kind = "solver",
         .text = "residual 1e-3",
         .first_step = 150,
         .first_time = 0.15,
         .value = 1e-3,
         .body = BodyId{4}});
}

}  // namespace

TEST_CASE("a kind of warning is one entry: first step, number of times, and the text of the worst",
          "[engine][warnings]") {
  Warnings w;
  CHECK(w.empty());
  add_two_kinds(w);
  w.add({.kind = "energy", .text = "open by 0.3", .first_step = 200, .first_time = 0.2, .value = 0.3});
  w.add({.kind = "energy", .text = "open by 0.1", .first_step = 300, .first_time = 0.3, .value = 0.1});
  REQUIRE(w.all().size() == 2);
  CHECK(warning_line(w.all()[0]) == "open by 0.3 (first in step 100, t = 0.1 s; 3 times; worst in step 200)");
  CHECK(warning_line(w.all()[1], "top") == "residual 1e-3, body 'top' (in step 150, t = 0.15 s)");
}

TEST_CASE("warnings are state: they come back as they were saved", "[engine][warnings]") {
  Warnings w;
  add_two_kinds(w);
  StateSnapshot kept;
  kept.save([&](StateVisitor& v) { w.visit(v); });
  const Warnings before = w;
  w = {};
  w.add({.kind = "other", .text = "x", .first_step = 1});
  kept.restore([&](StateVisitor& v) { w.visit(v); });
  REQUIRE(w.all().size() == before.all().size());
  for (std::size_t k = 0; k < before.all().size(); ++k) {
    CHECK(w.all()[k].kind == before.all()[k].kind);
    CHECK(w.all()[k].body == before.all()[k].body);
    CHECK(warning_line(w.all()[k]) == warning_line(before.all()[k]));
  }
}
