// A scene that starts from a run: from its end or from an earlier time, moved or not, driven and free bodies go on as
// they would have.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "scenes/session.h"
#include "scenes/start_run.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string started_head =
    "[run]\ntime_step = 1e-3\noutput_interval = 0.05\n<duration>[world]\ngravity = [0, 0, -2]\n[material.m]\n"
    "density = 2000\nyoungs_modulus = 1e7\npoissons_ratio = 0.3\n[contact]\nmethod = \"<method>\"\nrestitution = 0.5\n"
    "friction = 0.5\n";

struct Draw {
  std::mt19937 engine;
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  std::string vector(double size) {
    return fmt::format("[{}, {}, {}]", (*this)(-size, size), (*this)(-size, size), (*this)(-size, size));
  }
};

/// One motion of every kind; on its own in the first four bodies, several at once in the last.
std::vector<std::string> motions(Draw& draw) {
  const std::string table = fmt::format(
      "table = [[0, 0, 0, 0], [{}, 1, {}, 0], [0.4, 0, 1, -1], [0.7, 0, 0, 0]], of = \"{}\"", draw(0.1, 0.3),
      draw(-1, 1), std::vector<std::string>{"velocity", "acceleration", "displacement"}[draw.engine() % 3]);
  const std::string orbit =
      fmt::format("rotation = {{ axis = {}, rate = {}, about = {} }}", draw.vector(1), draw(-5, 5), draw.vector(2));
  const std::string swing =
      fmt::format("oscillation = {{ direction = {}, amplitude = 0.2, frequency = {} }}", draw.vector(1), draw(0.5, 3));
  const std::string way =
      fmt::format("velocity = {}, from = {}, until = {}", draw.vector(1), draw(0, 0.2), draw(0.4, 0.9));
  return {"{ " + table + " }", "{ " + orbit + " }", "{ " + swing + " }", "{ " + way + " }",
          "[{ " + way + " }, { " + orbit + " }, { " + table + " }]"};
}

/// Driven bodies, and a stone that tumbles freely and whose axes of inertia are not those of its corners.
std::string started_scene(const std::string& method, const std::string& duration, Draw& draw,
                          const std::vector<std::string>& driven) {
  std::string text = started_head;
  text.replace(text.find("<duration>"), 10, duration);
  text.replace(text.find("<method>"), 8, method);
  for (std::size_t k = 0; k < driven.size(); ++k)
    text += fmt::format(
        "[[body]]\nname = \"d{}\"\nshape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}\nposition = [{}, 0, "
        "{}]\nmaterial = \"m\"\nmotion = {}\n",
        k, 10.0 * static_cast<double>(k), draw(-1, 1), driven[k]);
  return text + "[[body]]\nname = \"stone\"\nmaterial = \"m\"\nposition = [0, 60, 0]\nvelocity = " + draw.vector(1) +
         "\nangular_velocity = " + draw.vector(6) +
         "\n[body.shape.polyhedron]\nvertices = [[0, 0, 0], [0.4, 0, 0], [0.1, 0.2, 0], [0, 0.1, 0.3]]\n";
}

void put(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::unique_ptr<Assembly> opened(const fs::path& path) {
  ReadResult read = read_scene(path.string(), {}, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  return assemble(std::move(*read.scene));
}

Ending run_to(const fs::path& scene, const fs::path& out, std::optional<double> until = {}) {
  Session session(opened(scene), {}, out);
  SessionLimits limits;
  limits.until = until;
  return session.run(limits, true);
}

/// Bodies by name, as they are in the checkpoint of a run.
struct Places {
  std::shared_ptr<MadeRun> run;
  explicit Places(const fs::path& folder) : run(open_made_run(folder)) {}
  Slot slot(const std::string& name) const {
    const Assembly& a = *run->assembly;
    for (std::size_t k = 0; k < a.scene.bodies.size(); ++k)
      if (body_name(a, a.id_of(k)) == name) return a.simulation->world.slot_of(a.id_of(k));
    return no_slot;
  }
  const World& world() const { return run->assembly->simulation->world; }
  Vec3 position(const std::string& name) const { return world().position[slot(name)]; }
  Quat orientation(const std::string& name) const { return world().orientation[slot(name)]; }
};

void check_same(const Places& now, const Places& then, const Vec3& moved, std::size_t driven) {
  for (std::size_t k = 0; k < driven; ++k) {
    INFO("driven body " << k);
    const std::string name = "d" + std::to_string(k);
    CHECK((now.position(name) - then.position(name) - moved).norm() < 1e-9);
    CHECK(now.orientation(name).angularDistance(then.orientation(name)) < 1e-7);
  }
  CHECK((now.position("stone") - then.position("stone") - moved).norm() < 1e-9);
  CHECK(now.orientation("stone").angularDistance(then.orientation("stone")) < 1e-5);
}

}  // namespace

TEST_CASE("a scene starts from the end of a run, moved: all go on along their paths", "[scenes][start]") {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    INFO("seed " << seed);
    const std::string method = seed % 2 ? "smooth" : "nonsmooth";
    const TemporaryFolder folder;
    Draw draw{std::mt19937(seed)};
    const auto driven = motions(draw);
    const Draw as_before = draw;
    const double cut = 0.05 * std::floor(draw(2, 10)), whole = 1.0;
    const auto scene = [&](double duration) {
      Draw again = as_before;
      return started_scene(method, fmt::format("duration = {}\n", duration), again, driven);
    };
    put(folder / "long.toml", scene(whole));
    put(folder / "short.toml", scene(cut));
    const Vec3 move(draw(-5, 5), draw(-5, 5), draw(-5, 5));
    std::string next = started_head;
    next.replace(next.find("<duration>"), 10, fmt::format("duration = {}\n", whole - cut));
    next.replace(next.find("<method>"), 8, method);
    put(folder / "next.toml",
        fmt::format("[start]\nfrom = {{ run = \"short\", move = [{}, {}, {}] }}\n", move.x(), move.y(), move.z()) +
            next);
    run_to(folder / "long.toml", folder / "long");
    run_to(folder / "short.toml", folder / "short");
    run_to(folder / "next.toml", folder / "next");
    check_same(Places(folder / "next"), Places(folder / "long"), move, driven.size());
  }
}

TEST_CASE("a scene starts from an earlier time of a run, in the stage and with the motions of that time",
          "[scenes][start]") {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    INFO("seed " << seed);
    const std::string method = seed % 2 ? "smooth" : "nonsmooth";
    const TemporaryFolder folder;
    Draw draw{std::mt19937(100 + seed)};
    const auto driven = motions(draw);
    const auto later = motions(draw);
    // first stage 0 to 0.5 s; in the second (to 0.9 s) bodies move otherwise; in the third the first of them is gone
    std::string stages = "[[stage]]\nname = \"one\"\nduration = 0.5\n[[stage]]\nname = \"two\"\nduration = 0.4\n";
    for (std::size_t k = 1; k < later.size(); ++k) stages += fmt::format("body.d{} = {{ motion = {} }}\n", k, later[k]);
    stages += "[[stage]]\nname = \"three\"\nduration = 0.2\nbody.d0 = { remove = true }\n";
    put(folder / "acts.toml", started_scene(method, "", draw, driven) + stages);
    run_to(folder / "acts.toml", folder / "acts");
    const bool in_first = seed % 3 != 0;
    const double from = in_first ? 0.05 * std::floor(draw(1, 7)) : 0.6, until = in_first ? 0.45 : 0.85;
    std::string next = started_head;
    next.replace(next.find("<duration>"), 10, fmt::format("duration = {}\n", until - from));
    next.replace(next.find("<method>"), 8, method);
    put(folder / "next.toml", fmt::format("[start]\nfrom = {{ run = \"acts\", time = {} }}\n", from) + next);
    run_to(folder / "next.toml", folder / "next");
    CHECK(run_to(folder / "acts.toml", folder / "cut", until) == Ending::until);
    check_same(Places(folder / "next"), Places(folder / "cut"), Vec3::Zero(), driven.size());
  }
}

TEST_CASE("bodies that came or went later are as they were at the time that a scene starts from", "[scenes][start]") {
  const TemporaryFolder folder;
  put(folder / "rain.toml",
      "[run]\nduration = 0.4\ntime_step = 1e-3\noutput_interval = 0.05\n[world]\ngravity = [0, 0, -9.81]\n"
      "[material.m]\ndensity = 2000\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[contact]\nmethod = \"smooth\"\n"
      "restitution = 0.5\nfriction = 0.5\n[shape.g]\nsphere = { radius = 0.01 }\n[[fill]]\nname = \"rain\"\n"
      "shape = \"g\"\nmaterial = \"m\"\ncount = 20\nmethod = \"pour\"\nrate = 50\n"
      "region = { box = { min = [-0.1, -0.1, 0.3], max = [0.1, 0.1, 0.4] } }\n[[body]]\nname = \"early\"\n"
      "shape = \"g\"\nmaterial = \"m\"\nposition = [1, 0, 0]\nremove_at = 0.22\n");
  run_to(folder / "rain.toml", folder / "rain");
  for (const double time : {0.1, 0.2, 0.3}) {
    INFO(time);
    const auto made = open_made_run_at(folder / "rain", time);
    const World& world = made->assembly->simulation->world;
    CHECK(world.size() == static_cast<std::size_t>(std::round(time * 50)) + (time < 0.22 ? 1u : 0u));
    CHECK(state_hash(world) == made->hash);  // the snapshot's own
    CHECK(world.clock == Approx(time));
  }
  CHECK(open_made_run_at(folder / "rain", 0.1003)->assembly->simulation->world.time == Approx(0.1));
  CHECK_THROWS_WITH(open_made_run_at(folder / "rain", 0.102), Catch::Contains("no snapshot of 0.102 s"));
  CHECK_THROWS_WITH(open_made_run_at(folder / "rain", 0.12),
                    Catch::Contains("the run has no snapshot of 0.12 s; there are 0, 0.05, 0.1"));
}

TEST_CASE("a run is not continued with other files than it began with, whichever stage names them",
          "[scenes][start][restart]") {
  const std::string rows = "t,x,y,z\n0,0,0,0\n0.1,1,0,0\n0.2,0,0,0\n",
                    other = "t,x,y,z\n0,0,0,0\n0.1,2,0,0\n0.2,0,0,0\n";
  const std::string motion = "motion = { file = \"rows.csv\", of = \"velocity\" }",
                    still = "motion = { velocity = [0, 0, 0] }";
  const std::string gravity = "gravity = { file = \"rows.csv\" }", body = "\n[[stage.body]]\nname = \"late\"\n";
  struct Case {
    std::string what, file, before, after, first, second;
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n",
                    moved_corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\n";
  const std::string faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const std::vector<Case> cases{
      {"motion", "rows.csv", rows, other, motion, ""},
      {"motion of a later stage", "rows.csv", rows, other, still, "body.d = { " + motion + " }\n"},
      {"gravity of a later stage", "rows.csv", rows, other, still, "world." + gravity + "\n"},
      {"shape of a later stage", "stone.obj", corners + faces, moved_corners + faces, still,
       body + "shape = { polyhedron = { file = \"stone.obj\" } }\nposition = [0, 9, 0]\nmaterial = \"m\"\n"},
      {"radius in a list of bodies", "list.csv", "x,y,z,radius\n0,5,0,0.1\n", "x,y,z,radius\n0,5,0,0.2\n", still,
       "[[stage.bodies]]\nfile = \"list.csv\"\nmaterial = \"m\"\n"}};
  for (const Case& c : cases) {
    INFO(c.what);
    const TemporaryFolder folder;
    put(folder / c.file, c.before);
    put(folder / "scene.toml",
        "[run]\ntime_step = 1e-3\noutput_interval = 0.1\n[material.m]\ndensity = 2000\nyoungs_modulus = 1e7\n"
        "poissons_ratio = 0.3\n[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0.5\n[[body]]\n"
        "name = \"d\"\nshape = { box = { size = [0.1, 0.1, 0.1] } }\nmaterial = \"m\"\n" +
            c.first +
            "\n[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\n"
            "position = [0, 0, 9]\n[[stage]]\nname = \"one\"\nduration = 0.1\n[[stage]]\nname = \"two\"\n"
            "duration = 0.1\n" +
            c.second);
    for (const double cut : {0.05, 0.15}) {
      put(folder / c.file, c.before);
      const fs::path out = folder / fmt::format("out{}", cut);
      CHECK(run_to(folder / "scene.toml", out, cut) == Ending::until);
      CHECK_NOTHROW(open_made_run(out));
      put(folder / c.file, c.after);
      CHECK_THROWS_WITH(open_made_run(out), Catch::Contains("has changed since the run was started"));
    }
  }
}

TEST_CASE("what contacts carry is not told as nothing where a scene starts from a run at rest", "[scenes][start]") {
  for (const char* method : {"smooth", "nonsmooth"}) {
    INFO(method);
    const TemporaryFolder folder;
    const std::string head = fmt::format(
        "[run]\nduration = 0.5\ntime_step = 2e-4\noutput_interval = 0.1\n[world]\ngravity = [0, 0, -10]\n[material.m]\n"
        "density = 2000\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[contact]\nmethod = \"{}\"\nrestitution = 0.1\n"
        "friction = 0.5\n",
        method);
    put(folder / "bed.toml",
        head +
            "[[body]]\nname = \"floor\"\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = \"m\"\n"
            "fixed = true\n[[body]]\nname = \"block\"\nrepeat = 3\nshape = { box = { size = [0.1, 0.1, 0.1] } }\n"
            "position = [0, 0, \"= 0.05 + 0.1*i\"]\nmaterial = \"m\"\n");
    put(folder / "next.toml", "[start]\nfrom = \"bed\"\n" + head +
                                  "[[measure]]\nname = \"load\"\nkind = \"force\"\nbody = \"floor\"\n"
                                  "interval = 0.02\n");
    run_to(folder / "bed.toml", folder / "bed");
    Session session(opened(folder / "next.toml"), {}, folder / "next");
    REQUIRE(session.run({}, true) == Ending::completed);
    const auto load = session.summary().measures.at("load").at("z");
    const double weight = 3 * 2000 * 1e-3 * 10;
    CHECK(load.min == Approx(-weight).epsilon(1e-2));
    CHECK(load.max == Approx(-weight).epsilon(1e-2));
  }
}

namespace {

struct GroupedRows {
  std::string text;
  std::size_t count = 0;
};

/// A file of one to four groups; the rows of the first may name none.
GroupedRows grouped_rows(Draw& draw) {
  GroupedRows rows{"x,y,z,radius,group\n"};
  const std::size_t groups = 1 + draw.engine() % 4;
  const bool nameless = draw.engine() % 2 == 0;
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t left = 1 + draw.engine() % 5; left > 0; --left, ++rows.count)
      rows.text += fmt::format("{},{},{},{},{}\n", 0.5 * static_cast<double>(rows.count), draw(-0.1, 0.1),
                               draw(-0.1, 0.1), draw(0.05, 0.2), nameless && g == 0 ? "" : fmt::format("g{}", g));
  return rows;
}

}  // namespace

TEST_CASE("bodies of a file are those of the run that a scene goes on from, whatever their groups",
          "[scenes][start][restart]") {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    INFO("seed " << seed);
    const TemporaryFolder folder;
    Draw draw{std::mt19937(seed)};
    const GroupedRows rows = grouped_rows(draw);
    put(folder / "rows.csv", rows.text);
    std::string head = started_head;
    head.replace(head.find("<duration>"), 10, "duration = 0.05\n");
    head.replace(head.find("<method>"), 8, seed % 2 ? "smooth" : "nonsmooth");
    const std::string bodies = "[[bodies]]\nname = \"bed\"\nfile = \"rows.csv\"\nmaterial = \"m\"\n";
    put(folder / "scene.toml", head + bodies);
    put(folder / "next.toml", "[start]\nfrom = \"run\"\n" + head + bodies);
    run_to(folder / "scene.toml", folder / "run");
    const Places before(folder / "run");
    REQUIRE(before.world().size() == rows.count);
    for (const char* way : {"resume --scene", "[start]"}) {
      INFO(way);
      ReadOptions options;
      if (way[0] == 'r') options.start_run = (folder / "run").string();
      const fs::path file = folder / (way[0] == 'r' ? "scene.toml" : "next.toml");
      ReadResult read = read_scene(file.string(), {}, full_registry(), options);
      for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
      REQUIRE(read.scene);
      CHECK_FALSE(read.scene->changes_bodies);
      const auto now = assemble(std::move(*read.scene));
      const World& world = now->simulation->world;
      REQUIRE(world.size() == rows.count);
      for (const BodyId id : world.id) {
        const Slot s = world.slot_of(id), t = before.world().slot_of(id);
        CHECK(world.position[s] == before.world().position[t]);
        CHECK(world.velocity[s] == before.world().velocity[t]);
      }
    }
  }
}

TEST_CASE("every group of a file comes with the stage that names the file", "[scenes][start][stages]") {
  Draw draw{std::mt19937(7)};
  const TemporaryFolder folder;
  const GroupedRows rows = grouped_rows(draw);
  put(folder / "rows.csv", rows.text);
  std::string head = started_head;
  head.replace(head.find("<duration>"), 10, "");
  head.replace(head.find("<method>"), 8, "smooth");
  put(folder / "scene.toml", head +
                                 "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\nmaterial = "
                                 "\"m\"\nposition = [0, 0, 9]\n[[stage]]\nname = \"one\"\nduration = 0.01\n"
                                 "[[stage]]\nname = \"two\"\nduration = 0.01\n[[stage.bodies]]\nname = \"bed\"\n"
                                 "file = \"rows.csv\"\nmaterial = \"m\"\n");
  run_to(folder / "scene.toml", folder / "begin", 0.005);
  CHECK(Places(folder / "begin").world().size() == 1);
  run_to(folder / "scene.toml", folder / "end");
  CHECK(Places(folder / "end").world().size() == 1 + rows.count);
}
