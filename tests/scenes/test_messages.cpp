// Messages name the one mistake that was made, and only what would mend it.
#include <algorithm>

#include "scenes/cli/library.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const std::string message_head = R"(run = { duration = 1.0, time_step = 0.001 }
material.a = { density = 1000.0, youngs_modulus = "1 MPa", poissons_ratio = 0.3 }
)";

std::string problems_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  std::string all;
  for (const Problem& p : read_scene_text(text, "s.toml", overrides, full_registry()).problems)
    all += p.to_string() + "\n";
  return all;
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("who names a body whose table is wrong is not told that there is none", "[scenes][reader]") {
  for (const char* user :
       {"[[measure]]\nkind = \"position\"\nbody = \"left\"\n", "[[measure]]\nkind = \"position\"\nbody = \"left[3]\"\n",
        "[bounds]\ndrift = { body = \"left\", below = 1.0 }\n"})
    for (const char* table : {"[[body]]\nname = \"left\"\nshape = { sphere = { radius = -1 } }\nmaterial = \"a\"\n",
                              "[[fill]]\nname = \"left\"\nshape = \"g\"\nmaterial = \"b\"\ncount = 1\n"
                              "region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n"}) {
      const std::string text = problems_of(message_head +
                                           "contact = { method = \"nonsmooth\", restitution = 0, friction = 0 "
                                           "}\nshape.g = { sphere = { radius = 1 } }\n" +
                                           table + user);
      CAPTURE(text);
      CHECK(text.find("unknown body") == std::string::npos);
      CHECK(lines(text) >= 1);
    }
}

TEST_CASE("the message for an unknown key lists the keys of the chosen law, solver or measure", "[scenes][reader]") {
  const auto told = [](const std::string& contact) {
    return problems_of(message_head + "contact = { restitution = 0.5, friction = 0, " + contact +
                       " }\n[[body]]\nshape = { sphere = { radius = 1 } }\nmaterial = \"a\"\n");
  };
  // `stiffness` is a key of linear, not of hertz
  CHECK_THAT(told("method = \"smooth\", smooth = { law = \"linear\", stifness = 1 }"),
             Catch::Contains("did you mean 'stiffness'?"));
  CHECK_THAT(told("method = \"smooth\", smooth = { law = \"hertz\", stifness = 1 }"),
             !Catch::Contains("did you mean 'stiffness'?"));
}

TEST_CASE("a name that looks like a number is a name after --set", "[scenes][reader]") {
  const std::string scene = message_head +
                            "contact = { method = \"nonsmooth\", restitution = 0, friction = 0 }\n[[body]]\nname = "
                            "\"b\"\nshape = { sphere = { radius = 1 } }\nmaterial = \"a\"\n";
  for (const char* name : {"60e1", "007", "1e3", "12", "true"}) {
    const ReadResult read = read_scene_text(scene, "s.toml", {std::string("body.0.name=") + name}, full_registry());
    REQUIRE(read.scene);
    CHECK(read.scene->groups.at(0).name == name);
  }
  CHECK_THAT(problems_of(scene, {"body.b.material=60e1"}), Catch::Contains("60e1"));
}

TEST_CASE("run takes the names that the list of scenes shows", "[scenes][commands]") {
  CHECK(scene_file("hopper/hopper.toml") == (library_folder() / "hopper/hopper.toml").string());
  CHECK(scene_file("hopper/hopper") == (library_folder() / "hopper/hopper.toml").string());
  CHECK(scene_file("no/such.toml") == "no/such.toml");
}
