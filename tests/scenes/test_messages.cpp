// Messages name the one mistake that was made, and only what would mend it.
#include <algorithm>
#include <random>

#include "scenes/assemble.h"
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

namespace {

/// Of a ball on a floor: what reading and putting together warn of.
std::string warnings_of(const std::string& contact, const std::string& smooth) {
  const std::string text = message_head + "[contact]\nmethod = \"smooth\"\n" + contact + "[contact.smooth]\n" + smooth +
                           "[[body]]\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = \"a\"\nfixed = "
                           "true\n[[body]]\nshape = { sphere = { radius = 1 } }\nposition = [0, 0, 2]\nmaterial = "
                           "\"a\"\n";
  ReadResult read = read_scene_text(text, "s.toml", {}, full_registry());
  std::string all;
  for (const Problem& p : read.problems) all += p.to_string() + "\n";
  CAPTURE(text, all);
  REQUIRE(read.scene);
  const auto a = assemble(std::move(*read.scene));
  for (const Problem& p : a->warnings) all += p.to_string() + "\n";
  return all;
}

/// The least that a law needs beside the material.
std::string law_text(const std::string& law) {
  std::string text = "law = \"" + law + "\"\n";
  if (law == "linear" || law == "walton-braun" || law == "power-law") text += "stiffness = 1e6\n";
  if (law == "power-law") text += "exponent = 1.5\n";
  if (law == "jkr" || law == "dmt") text += "work_of_adhesion = 0.1\n";
  if (law == "kuwabara-kono") text += "relaxation_time = 1e-5\n";
  if (law == "hunt-crossley") text += "reference_speed = 1.0\n";
  return text;
}

const std::string rubs = "restitution = 0.5\nfriction = 0.5\n";
const std::vector<std::string> message_laws{"linear",        "hertz",        "hunt-crossley", "power-law",
                                            "kuwabara-kono", "walton-braun", "dmt",           "jkr"};

}  // namespace

TEST_CASE("laws tell of locate_edges where they have none, and of those that have it", "[scenes][warnings]") {
  for (const std::string& law : message_laws) {
    INFO(law);
    const bool has = law != "walton-braun" && law != "dmt" && law != "jkr";
    const std::string told = warnings_of(rubs, law_text(law) + "locate_edges = true\n");
    CHECK((told.find("locate_edges is not used by law '" + law + "'; laws that have it: linear, hertz") ==
           std::string::npos) == has);
    CHECK(warnings_of(rubs, law_text(law)).find("locate_edges") == std::string::npos);
  }
}

TEST_CASE("keys that do nothing are told, whichever law passes them over", "[scenes][warnings]") {
  std::mt19937 engine(3);
  for (int k = 0; k < 12; ++k) {
    const std::string law = message_laws[engine() % message_laws.size()], base = law_text(law);
    INFO(law);
    const bool hertzian = law != "linear" && law != "power-law" && law != "walton-braun";
    const std::string ratio = "tangential_ratio = 0.5\n";
    CHECK((warnings_of(rubs, base + ratio).find("tangential_ratio is not used") != std::string::npos) == hertzian);
    CHECK(warnings_of(rubs, base + ratio + "tangential = \"coulomb-spring\"\n").find("tangential_ratio") ==
          std::string::npos);
    CHECK_THAT(warnings_of(rubs, base + "rolling = \"spring\"\n"),
               Catch::Contains("rolling law 'spring' does nothing"));
    CHECK(warnings_of(rubs + "rolling_friction = 0.1\n", base + "rolling = \"spring\"\n").find("does nothing") ==
          std::string::npos);
    CHECK_THAT(warnings_of(rubs + "rolling_friction = 0.1\n", base + "rolling = \"none\"\n"),
               Catch::Contains("7:20: warning: rolling_friction is not used by rolling law 'none'"));
    CHECK_THAT(warnings_of(rubs, base + "tangential = \"none\"\n"),
               Catch::Contains("friction is not used by tangential law 'none'"));
    const bool told = warnings_of(rubs, base).find("is not used by law") != std::string::npos;
    CHECK(told == (law == "kuwabara-kono"));  // its restitution
  }
  CHECK(warnings_of("friction = 0.5\n", law_text("kuwabara-kono")).empty());
  CHECK_THAT(warnings_of(rubs, law_text("power-law") + "calibration_overlap = [1e-5]\ncalibration_force = [1]\n"),
             Catch::Contains("calibration_overlap and calibration_force are not used"));
  CHECK_THAT(warnings_of(rubs, law_text("power-law") + "damping = 1\n"),
             Catch::Contains("restitution 0.500000 is not used by law 'power-law'"));
  CHECK_THAT(warnings_of("restitution = 0.02\nfriction = 0\n", law_text("walton-braun")),
             Catch::Contains("it acts as 0.05"));
}

TEST_CASE("a stage that leaves the contact without a key is named, with its line", "[scenes][reader][stages]") {
  std::mt19937 engine(9);
  for (int k = 0; k < 4; ++k) {
    const std::size_t stages = 2 + engine() % 3, wrong = 1 + engine() % (stages - 1);
    std::string text =
        "run = { time_step = 0.001 }\nmaterial.a = { density = 1000.0, youngs_modulus = \"1 MPa\", poissons_ratio = "
        "0.3 "
        "}\n[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0.5\nsmooth = { law = \"hertz\" }\n[[body]]\n"
        "repeat = 2\nshape = { sphere = { radius = 1 } }\nposition = [\"= 3*i\", 0, 0]\nmaterial = \"a\"\n";
    std::string expected;
    for (std::size_t s = 0; s < stages; ++s) {
      if (s == wrong)
        expected =
            "s.toml:" + std::to_string(lines(text) + 1) + ":1: error: [[stage]] 'w': missing key 'work_of_adhesion'";
      text += std::string("[[stage]]\nname = \"") + (s == wrong ? "w" : std::to_string(s)) + "\"\nduration = 1\n" +
              (s == wrong ? "contact.smooth.law = \"jkr\"\n" : "");
    }
    const std::string told = problems_of(text);
    CAPTURE(told);
    CHECK(told.starts_with(expected));
    CHECK(lines(told) == 1);  // later stages repeat it
  }
}

TEST_CASE("messages of fills and steps name the fill and every word", "[scenes][reader]") {
  const std::string head =
      message_head +
      "contact = { method = \"nonsmooth\", restitution = 0, friction = 0 }\nshape.g = { sphere = { "
      "radius = 0.2 } }\n[[fill]]\nname = \"heap\"\nshape = \"g\"\nmaterial = \"a\"\n";
  const std::string region = "region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
  CHECK_THAT(problems_of(head + region + "count = 2\nmethod = \"pour\"\nrate = 1\nmass_rate = 2\n"),
             Catch::Contains("[[fill]] 'heap': rate and mass_rate both say"));
  CHECK_THAT(problems_of(head + region + "count = 2\n", {"run.time_step=\"autom\""}),
             Catch::Contains("expected a number, \"auto\" or \"adaptive\", found 'autom'"));
  const auto put_together = [&](const std::string& more) {
    ReadResult read = read_scene_text(head + more, "s.toml", {}, full_registry());
    REQUIRE(read.scene);
    return assemble(std::move(*read.scene));
  };
  CHECK_THROWS_WITH(put_together(region + "count = 500\n"), Catch::Contains("[[fill]] 'heap': only"));
  CHECK_THROWS_WITH(put_together("region = { box = { min = [0, 0, 0], max = [1, 1, 0.3] } }\ncount = 1\nmethod = "
                                 "\"pour\"\nrate = 1\n"),
                    Catch::Contains("[[fill]] 'heap': a body is larger"));
}

TEST_CASE("what the loop of spheres leaves to the generic one is told with its reason", "[scenes][commands]") {
  const auto told = [](const std::string& wall) {
    ReadResult read = read_scene_text(
        message_head +
            "contact = { method = \"smooth\", restitution = 0.5, friction = 0.5 }\nshape.g = { sphere = { radius = 0.1 "
            "} "
            "}\n[[fill]]\nshape = \"g\"\nmaterial = \"a\"\ncount = 3\nregion = { box = { min = [0, 0, 1], max = [1, 1, "
            "2] } }\n[[body]]\nmaterial = \"a\"\n" +
            wall,
        "s.toml", {}, full_registry());
    REQUIRE(read.scene);
    const auto a = assemble(std::move(*read.scene));
    return explain(a->scene, a->plan, *a->shapes);
  };
  CHECK_THAT(told("shape = { box = { size = [9, 9, 1] } }\nfixed = true\n"),
             Catch::Contains("generic loop: sphere-box: a body of other shape than a fixed half-space"));
  CHECK_THAT(told("shape = { half_space = { normal = [0, 0, 1] } }\nmotion = { velocity = [0, 0, 1] }\n"),
             Catch::Contains("generic loop: half-spaces that are driven"));
  CHECK_THAT(told("shape = { half_space = { normal = [0, 0, 1] } }\nfixed = true\n"),
             Catch::Contains("generic loop: all other pairs"));
}
