// A stage, a changed restart and a scene that starts from a run are one thing: the same bits, whichever way they are
// said.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/threads/parallel.h"
#include "scenes/session.h"
#include "scenes/stage_check.h"
#include "scenes/start_run.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/hdf5/stored_run.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

/// Balls and blocks on a floor with a wall that can be lifted; the method is put in.
std::string scene_of(const std::string& method, const std::string& head, const std::string& tail = "") {
  return head + R"(
[material.m]
density = 2500.0
youngs_modulus = "5 MPa"
poissons_ratio = 0.25
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
[[body]]
name = "gate"
shape = { box = { size = [0.01, 0.2, 0.2] } }
position = [0.05, 0, 0.1]
material = "m"
motion = { velocity = [0, 0, 0] }
[[body]]
name = "block"
repeat = 3
shape = { box = { size = [0.02, 0.02, 0.02] } }
position = ["= -0.03 + 0.0*i", 0.03, "= 0.0101 + 0.0203*i"]
material = "m"
[[fill]]
name = "grains"
shape = ["ball"]
material = "m"
count = 30
region = { box = { min = [-0.015, -0.04, 0.005], max = [0.04, 0.015, 0.2] } }
[shape.ball]
sphere = { radius = 0.006 }
)" + "[contact]\nmethod = \"" +
         method + "\"\nrestitution = 0.4\nfriction = 0.4\n" + tail;
}

const std::string run_table = "[run]\noutput_interval = 0.01\ntime_step = 1e-4\n";
const std::string one_run = "[run]\noutput_interval = 0.01\ntime_step = 1e-4\nduration = 0.03\n";
const std::string down = "[world]\ngravity = [0, 0, -9.81]\n";
const std::string first_stage = "[[stage]]\nname = \"settle\"\nduration = 0.03\n";
const std::string second_stage =
    "[[stage]]\nname = \"shift\"\nduration = 0.03\nworld.gravity = [3.0, 0, -9.3]\ncontact.friction = 0.2\n"
    "body.gate = { motion = { velocity = [0, 0, 0.5] } }\n";

void write_file(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

Scene read_or_fail(const fs::path& path, const std::vector<std::string>& overrides = {}) {
  ReadResult read = read_scene(path.string(), overrides, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  return std::move(*read.scene);
}

std::string run_through(const fs::path& scene, const fs::path& out) {
  Session session(assemble(read_or_fail(scene)), {}, out);
  REQUIRE(session.run({}, true) == Ending::completed);
  return session.summary().state_hash;
}

std::unique_ptr<Session> reopened(const fs::path& out) {
  const CheckpointHeader header = read_checkpoint_header(out / "checkpoint.h5");
  const RunRecord record = RunRecord::from_text(header.record);
  return Session::resume(assemble(scene_of(header, record), options_of(record)), header.overrides, out);
}

/// Cut off after so many steps, then resumed to the end.
std::string cut_and_resumed(const fs::path& scene, const fs::path& out, std::uint64_t steps) {
  {
    Session session(assemble(read_or_fail(scene)), {}, out);
    SessionLimits limits;
    limits.steps = steps;
    REQUIRE(session.run(limits, true) == Ending::until);
  }
  auto again = reopened(out);
  REQUIRE(again->run({}, true) == Ending::completed);
  return again->summary().state_hash;
}

/// The first scene alone, then the changes of the second stage by `epafi resume --set`.
std::string changed_on_restart(const fs::path& scene, const fs::path& out) {
  run_through(scene, out);
  auto session = reopened(out);
  const CheckpointHeader header = read_checkpoint_header(out / "checkpoint.h5");
  RunRecord record = session->record();
  record.inserted.push_back(
      {record.stage,
       session->rest(0.06),
       0.01,
       {"world.gravity=[3.0, 0, -9.3]", "contact.friction=0.2", "body.gate={ motion = { velocity = [0, 0, 0.5] } }"}});
  ReadResult read = read_scene(header.scene_path, header.overrides, full_registry(), {1, record.inserted, {}});
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  session->change(std::move(*read.scene), record, {});
  REQUIRE(session->run({}, true) == Ending::completed);
  return session->summary().state_hash;
}

}  // namespace

TEST_CASE("stages and changed restarts give the same bits, and a scene starts from a run", "[scenes][stages][long]") {
  for (const std::string method : {"smooth", "nonsmooth"}) {
    INFO(method);
    const TemporaryFolder folder;
    const fs::path two = folder / "two.toml", one = folder / "one.toml", next = folder / "next.toml";
    write_file(two, scene_of(method, run_table + down) + first_stage + second_stage);
    write_file(one, scene_of(method, one_run + down));
    write_file(next, "[start]\nfrom = \"one\"\n" + one_run +
                         "[world]\ngravity = [3.0, 0, -9.3]\n[contact]\nmethod = \"" + method +
                         "\"\nrestitution = 0.4\nfriction = 0.2\n[[body]]\nname = \"gate\"\nmaterial = \"m\"\n" +
                         "shape = { box = { size = [0.01, 0.2, 0.2] } }\nmotion = { velocity = [0, 0, 0.5] }\n");
    const std::string hash = run_through(two, folder / "two");
    for (const std::uint64_t steps : {100u, 299u, 300u, 301u, 450u}) {
      INFO(steps);
      CHECK(cut_and_resumed(two, folder / ("cut" + std::to_string(steps)), steps) == hash);
    }
    CHECK(changed_on_restart(one, folder / "one") == hash);
    fs::remove_all(folder / "one");
    const std::string end = run_through(one, folder / "one");
    Session chained(assemble(read_or_fail(next)), {}, folder / "next");
    SessionLimits at_once;
    at_once.steps = 0;
    CHECK(chained.run(at_once, true) == Ending::until);
    CHECK(chained.summary().state_hash == end);  // it begins where that run has ended
    CHECK(chained.run({}, true) == Ending::completed);
    CHECK(chained.summary().state_hash == hash);
  }
}

namespace {

/// A kind of scene in two acts: "<a|b>" in its text is a in the first and b in the second.
struct Acts {
  std::string name, text, changes;
  double time_step;
  std::uint64_t first, second;  ///< steps of each
  bool chained = true;          ///< two scenes say the same; the time of a load begins anew in the second one
};

std::string act(const std::string& text, bool second) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = std::min(text.find('<', at), text.size());
    out += text.substr(at, open - at);
    if (open == text.size()) break;
    const std::size_t bar = text.find('|', open), close = text.find('>', open);
    out += second ? text.substr(bar + 1, close - bar - 1) : text.substr(open + 1, bar - open - 1);
    at = close + 1;
  }
  return out;
}

const std::string acts_head =
    "[world]\ngravity = [0, 0, -9.81]\n[material.m]\ndensity = 2500\nyoungs_modulus = \"5 MPa\"\n"
    "poissons_ratio = 0.3\n";
const std::string acts_floor =
    "[[body]]\nname = \"floor\"\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = \"m\"\n";
const std::string smooth_mu = "[contact]\nmethod = \"smooth\"\nrestitution = 0.3\nfriction = <0.4|0.2>\n";
const std::string rigid_mu = "[contact]\nmethod = \"nonsmooth\"\nrestitution = 0.3\nfriction = <0.5|0.2>\n";

std::string grains(const std::string& shape, int count) {
  return "[shape.g]\n" + shape +
         "\n[[fill]]\nname = \"g\"\nshape = \"g\"\nmaterial = \"m\"\ncount = " + std::to_string(count) +
         "\nregion = { box = { min = [-0.03, -0.0095, -0.03], max = [0.03, 0.0095, 0.03] } }\n";
}

std::string blocks(const std::string& size, const std::string& apart) {
  return "[[body]]\nname = \"blk\"\nrepeat = 4\nshape = { box = { size = [" + size + ", " + size + ", " + size +
         "] } }\nposition = [\"= 0.002*i*i\", 0, \"= 0.5*" + size + " + i*" + apart + "\"]\nmaterial = \"m\"\n";
}

const std::string wheels =
    "[world]\ngravity = [0, 0, 9.81]\n[material.steel]\ndensity = 7850\nyoungs_modulus = \"210 GPa\"\npoissons_ratio = "
    "0.28\n[contact]\nmethod = \"smooth\"\nfriction = <0.3|0.2>\nrestitution = 0\nwheel_rail = { normal = \"hertz\", "
    "tangential = \"fastsim\", slowest = 5 }\n[shape.w]\nwheel_profile = { name = \"s1002\", radius = 0.46, mass = "
    "1500, "
    "inertia = [950, 120, 950] }\n[shape.t]\nrail_profile = { name = \"uic60\", cant = 0.025 }\n[[body]]\nname = "
    "\"track\"\nshape = \"t\"\nmaterial = \"steel\"\nfixed = true\n[[body]]\nname = \"set\"\nshape = \"w\"\nmaterial = "
    "\"steel\"\nposition = [0, 0, -0.46]\non_rails = true\n";

const std::string softer = "contact.friction = 0.2\n", still = "fixed = true\n";

std::vector<Acts> plain_acts() {
  const std::string springs =
      "[[spring]]\nname = \"link\"\nrepeat = 3\nbody = \"blk[i]\"\nto = \"blk[i + 1]\"\nstiffness = [200, 100, 100]\n"
      "damping = [0.1, 0, 0]\n[[spring]]\nname = \"hook\"\nbody = \"blk[0]\"\nspeed = 0.5\nstiffness = [100, 0, 0]\n";
  return {{"spheres", acts_head + smooth_mu + acts_floor + still + grains("sphere = { radius = 0.004 }", 25), softer,
           1e-4, 300, 200},
          {"blocks", acts_head + smooth_mu + acts_floor + still + blocks("0.02", "0.0202"), softer, 1e-4, 150, 150},
          {"springs", acts_head + smooth_mu + acts_floor + still + blocks("0.02", "0.03") + springs, softer, 1e-4, 150,
           150},
          {"stack", acts_head + rigid_mu + acts_floor + still + blocks("0.2", "0.2"), softer, 5e-3, 12, 12},
          {"newton",
           acts_head + rigid_mu + "nonsmooth = { solver = \"newton\", tolerance = 1e-8 }\n" + acts_floor + still +
               blocks("0.2", "0.2"),
           softer, 5e-3, 12, 12}};
}

std::vector<Acts> driven_acts() {
  const std::string drum =
      std::string("[[body]]\nname = \"drum\"\nshape = { mesh = { file = \"") + EPAFI_SOURCE_DIR +
      "/scenes/library/stages/drum.obj\" } }\nmaterial = \"m\"\nmotion = { rotation = { axis = "
      "[0, 1, 0], rate = <1|-3>, about = [0, 0, 0] } }\n[[body]]\nname = \"end\"\nrepeat = 2\nshape "
      "= { half_space = { normal = [0, \"= 1 - 2*i\", 0] } }\nposition = [0, \"= -0.01 + 0.02*i\", "
      "0]\nmaterial = \"m\"\nfixed = true\n";
  const std::string turned =
      "contact.friction = 0.2\nbody.drum = { motion = { rotation = { axis = [0, 1, 0], rate = -3, about = [0, 0, 0] } "
      "} }\n";
  const std::string table = "{ table = [[0, 0, 0], [0.01, 2, 1], [0.02, -2, 0], [0.03, 0, 0]], of = \"acceleration\" }";
  const std::string press = "{ servo = { force = <3|6>, direction = [0, 0, -1], mass = 0.05, max_speed = 0.5 } }";
  const std::string harder = "contact.friction = 0.2\nbody.plate = { motion = " + act(press, true) + " }\n";
  return {
      {"table",
       acts_head + rigid_mu + acts_floor + "motion = <{ velocity = [0, 0, 0] }|" + table + ">\n" + blocks("0.2", "0.2"),
       softer + "body.floor = { motion = " + table + " }\n", 2e-3, 12, 16},
      {"rigid mesh", acts_head + rigid_mu + drum + grains("box = { size = [0.01, 0.008, 0.008] }", 7), turned, 2e-3, 30,
       30},
      {"smooth mesh", acts_head + smooth_mu + drum + grains("sphere = { radius = 0.004 }", 15), turned, 1e-4, 300, 150},
      {"servo",
       acts_head + smooth_mu + acts_floor + still +
           "[[body]]\nname = \"plate\"\nshape = { half_space = { normal = "
           "[0, 0, -1] } }\nposition = [0, 0, 0.035]\nmaterial = \"m\"\nmotion = " +
           press + "\n" + grains("sphere = { radius = 0.004 }", 25),
       harder, 1e-4, 300, 200},
      {"wheelset", wheels, softer, 1e-4, 60, 60}};
}

/// Sources, cells, loads and steps that follow something.
std::vector<Acts> loose_acts() {
  const std::string press = "{ servo = { force = <40|90>, direction = [1, 0, 0], mass = 5, max_speed = 0.5 } }";
  const std::string side =
      "[[body]]\nname = \"side\"\nshape = { half_space = { normal = [-1, 0, 0] } }\nposition = [0.15, 0, "
      "0]\nmaterial = \"m\"\nfixed = true\n[[body]]\nname = \"press\"\nshape = { half_space = { normal = [1, 0, 0] } "
      "}\n"
      "position = [-0.12, 0, 0]\nmaterial = \"m\"\nmotion = " +
      press + "\n";
  const std::string cell =
      "[world]\ngravity = [0, 0, <-9|-12>]\ndomain = { min = [-0.03, -0.03, -0.03], max = [0.03, 0.03, 0.03], "
      "periodic = [\"x\", \"y\"], strain_rate = [0.5, -0.2, 0] }\n[material.m]\ndensity = 2500\n"
      "youngs_modulus = \"5 MPa\"\npoissons_ratio = 0.3\n";
  const std::string loads =
      "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.02 } }\nposition = [0.3, 0, 0.02]\n"
      "material = \"m\"\nforce = [\"= 0.1*sin(40*t)\", 0, 0]\ntorque = [0, 0, 1e-4]\n[[body]]\nname = \"gone\"\n"
      "shape = { sphere = { radius = 0.02 } }\nposition = [0.6, 0, 0.02]\nmaterial = \"m\"\nremove_at = <0.02|0.5>\n";
  const std::string twice =
      "[[body]]\nname = \"stirrer\"\nshape = { box = { size = [0.02, 0.01, 0.01] } }\nmaterial = \"m\"\n"
      "position = [0.02, 0, 0.01]\nmotion = [{ rotation = { axis = [0, 0, 1], rate = 9 } }, { rotation = { axis = [0, "
      "0, 1], "
      "rate = <4|-4>, about = [0, 0, 0] } }, { table = [[0, 0, 0, 0], [0.01, 0, 0, 0.004], [0.05, 0, 0, 0]], of = "
      "\"displacement\" }]\n";
  const std::string back =
      "body.stirrer = { motion = [{ rotation = { axis = [0, 0, 1], rate = 9 } }, { rotation = { axis = [0, 0, "
      "1], rate = -4, about = [0, 0, 0] } }, { table = [[0, 0, 0, 0], [0.01, 0, 0, 0.004], [0.05, 0, 0, 0]], of = "
      "\"displacement\" }] }\n";
  return {
      {"rigid servo", acts_head + rigid_mu + acts_floor + still + blocks("0.1", "0.1") + side,
       softer + "body.press = { motion = " + act(press, true) + " }\n", 2e-3, 60, 60},
      {"periodic cell",
       cell + smooth_mu + acts_floor + "position = [0, 0, -0.03]\n" + still + grains("sphere = { radius = 0.004 }", 25),
       softer + "world.gravity = [0, 0, -12]\n", 1e-4, 200, 200},
      {"two motions and a table",
       acts_head + smooth_mu + acts_floor + still + twice + grains("sphere = { radius = 0.003 }", 9), softer + back,
       1e-4, 200, 200},
      {"loads", acts_head + smooth_mu + acts_floor + still + loads, softer, 1e-4, 300, 200, false}};
}

}  // namespace

TEST_CASE("whole, cut anywhere, and chained: every kind of scene keeps one hash", "[scenes][stages][long]") {
  const support::KeepThreads keep;
  std::vector<Acts> kinds = plain_acts();
  std::ranges::move(driven_acts(), std::back_inserter(kinds));
  std::ranges::move(loose_acts(), std::back_inserter(kinds));
  for (const Acts& kind : kinds) {
    INFO(kind.name);
    const TemporaryFolder folder;
    const auto duration = [&](std::uint64_t steps) {
      return "duration = " + std::to_string(kind.time_step * static_cast<double>(steps)) + "\n";
    };
    const std::string run = "[run]\noutput_interval = 0.01\ntime_step = " + std::to_string(kind.time_step) + "\n";
    const std::string first = run + duration(kind.first), second = run + duration(kind.second);
    write_file(folder / "two.toml", run + act(kind.text, false) + "[[stage]]\nname = \"one\"\n" + duration(kind.first) +
                                        "[[stage]]\nname = \"two\"\n" + duration(kind.second) + kind.changes);
    write_file(folder / "one.toml", first + act(kind.text, false));
    write_file(folder / "next.toml", "[start]\nfrom = \"one\"\n" + second + act(kind.text, true));
    set_thread_count(1);
    const std::string hash = run_through(folder / "two.toml", folder / "two");
    for (const std::uint64_t steps : {kind.first - 1, kind.first, kind.first + 1, kind.first + kind.second / 2}) {
      INFO(steps);
      CHECK(cut_and_resumed(folder / "two.toml", folder / ("cut" + std::to_string(steps)), steps) == hash);
    }
    run_through(folder / "one.toml", folder / "one");
    if (kind.chained) CHECK(run_through(folder / "next.toml", folder / "next") == hash);
    for (const int threads : {3, 8}) {
      set_thread_count(threads);
      CHECK(run_through(folder / "two.toml", folder / ("threads" + std::to_string(threads))) == hash);
    }
  }
}

TEST_CASE("bodies that a stage brings find room where the others stand now", "[scenes][stages]") {
  const TemporaryFolder folder;
  const fs::path scene = folder / "more.toml";
  const std::string more =
      "[[stage.fill]]\nname = \"more\"\nshape = [\"ball\"]\nmaterial = \"m\"\ncount = 12\n"
      "method = \"random\"\nregion = { box = { min = [-0.015, -0.04, 0.0], max = [0.04, 0.015, "
      "0.06] } }\n";
  write_file(scene, scene_of("smooth", run_table + down) + first_stage + second_stage + more);
  const std::string hash = run_through(scene, folder / "whole");
  for (const std::uint64_t steps : {299u, 301u, 450u}) {
    INFO(steps);
    CHECK(cut_and_resumed(scene, folder / ("cut" + std::to_string(steps)), steps) == hash);
  }
  Session session(assemble(read_or_fail(scene)), {}, folder / "looked at");
  SessionLimits limits;
  limits.steps = 301;
  CHECK(session.run(limits, true) == Ending::until);
  CHECK(session.summary().bodies == 2 + 3 + 30 + 12);
  CHECK(session.summary().overlap->max < 1e-3);  // they would stand in each other by 6 mm and more
}

TEST_CASE("the file of a run holds the shapes of all its stages", "[scenes][stages]") {
  const TemporaryFolder folder;
  const fs::path scene = folder / "shapes.toml";
  const std::string more =
      "[[stage.fill]]\nname = \"more\"\nshape = [\"brick\"]\nmaterial = \"m\"\ncount = 3\n"
      "region = { box = { min = [-0.1, -0.1, 0.2], max = [0.1, 0.1, 0.4] } }\n[shape.brick]\nbox = { size = [0.01, "
      "0.02, 0.03] }\n";
  write_file(scene, scene_of("nonsmooth", run_table + down) + first_stage + second_stage + more);
  run_through(scene, folder / "out");
  const StoredRun run(folder / "out" / "run.h5");
  int blocks = 0, bricks = 0;
  for (const BodyRecord& b : run.bodies()) {
    if (b.surface == nullptr || b.mass == 0.0) continue;
    Vec3 low = b.surface->points.front(), high = low;
    for (const Vec3& x : b.surface->points) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    Vec3 size = high - low;
    std::sort(size.data(), size.data() + 3);
    blocks += (size - Vec3(0.02, 0.02, 0.02)).norm() < 1e-12;
    bricks += (size - Vec3(0.01, 0.02, 0.03)).norm() < 1e-12;
  }
  CHECK(blocks == 3);
  CHECK(bricks == 3);
}

TEST_CASE("the bits of stages do not depend on the number of threads", "[scenes][stages]") {
  const int before = thread_count();
  const TemporaryFolder folder;
  write_file(folder / "two.toml", scene_of("nonsmooth", run_table + down) + first_stage + second_stage);
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    hashes.push_back(run_through(folder / "two.toml", folder / std::to_string(threads)));
  }
  set_thread_count(before);
  CHECK(hashes[1] == hashes[0]);
  CHECK(hashes[2] == hashes[0]);
}

TEST_CASE("a stage that changes nothing is no event, to the bit", "[scenes][stages]") {
  for (const std::string method : {"smooth", "nonsmooth"}) {
    INFO(method);
    const TemporaryFolder folder;
    write_file(folder / "whole.toml",
               scene_of(method, "[run]\noutput_interval = 0.01\ntime_step = 1e-4\nduration = 0.06\n" + down));
    write_file(folder / "parts.toml",
               scene_of(method, run_table + down) + first_stage +
                   "[[stage]]\nname = \"on\"\nduration = 0.02\n[[stage]]\nname = \"and on\"\nduration = 0.01\n");
    CHECK(run_through(folder / "parts.toml", folder / "parts") == run_through(folder / "whole.toml", folder / "whole"));
  }
}

TEST_CASE("a bound that stops ends a run early and well", "[scenes][stages]") {
  const TemporaryFolder folder;
  write_file(folder / "falls.toml",
             scene_of("smooth", one_run + down,
                      "[bounds]\nsag = { body = \"grains\", below = 0.001, then = \"stop\" }\n"
                      "[[measure]]\nname = \"fallen\"\nkind = \"drift\"\nbody = \"grains\"\ninterval = 0.01\n"));
  Session session(assemble(read_or_fail(folder / "falls.toml")), {}, folder / "falls");
  CHECK(session.run({}, true) == Ending::stopped);
  CHECK(session.summary().status == "completed");
  CHECK(session.summary().simulated_time == Approx(std::sqrt(2 * 0.001 / 9.81)).epsilon(0.01));  // free fall by 1 mm
  CHECK(session.stop_reason().find("sag.grains") != std::string::npos);
  // the state that the bound has seen is the last sample, between two of the interval
  CHECK(session.summary().measures.at("fallen").at("sag").max >= 0.001);
  const double end = session.summary().simulated_time;
  const StoredRun run(folder / "falls" / "run.h5");
  CHECK(run.time(run.snapshots() - 1) == end);  // and the last picture
}

TEST_CASE("a cut between two stages where bodies are sorted changes no bit", "[scenes][stages]") {
  const TemporaryFolder folder;
  const fs::path scene = folder / "two.toml";
  write_file(scene,
             scene_of("smooth", run_table + down) + "[[stage]]\nname = \"settle\"\nduration = 0.1\n" + second_stage);
  const std::string hash = run_through(scene, folder / "whole");
  CHECK(cut_and_resumed(scene, folder / "cut", 1000) == hash);
}

TEST_CASE("a run goes on beyond its duration as if that had been longer", "[scenes][stages]") {
  const TemporaryFolder folder;
  write_file(folder / "long.toml",
             scene_of("smooth", "[run]\noutput_interval = 0.01\ntime_step = 1e-4\nduration = 0.05\n" + down));
  write_file(folder / "short.toml", scene_of("smooth", one_run + down));
  const std::string hash = run_through(folder / "long.toml", folder / "long");
  run_through(folder / "short.toml", folder / "short");
  auto session = reopened(folder / "short");
  session->extend(0.05);
  CHECK(session->run({}, true) == Ending::completed);
  CHECK(session->summary().state_hash == hash);
  CHECK(session->summary().simulated_time == Approx(0.05));
}

TEST_CASE("a condition ends a stage when it has held so long, else the longest time does", "[scenes][stages]") {
  const TemporaryFolder folder;
  const std::string measure = "[[measure]]\nname = \"energy\"\nkind = \"energy\"\ninterval = 0.001\n";
  const auto until = [](const char* below, const char* at_most) {
    return std::string(
               "[[stage]]\nname = \"settle\"\nuntil = { measure = \"energy\", component = \"kinetic\", below = ") +
           below + ", for = 0.002, at_most = " + at_most + " }\n[[stage]]\nname = \"after\"\nduration = 0.002\n";
  };
  write_file(folder / "met.toml", scene_of("smooth", run_table + down) + measure + until("1e3", "0.05"));
  write_file(folder / "not.toml", scene_of("smooth", run_table + down) + measure + until("1e-30", "0.01"));
  Session met(assemble(read_or_fail(folder / "met.toml")), {}, folder / "met");
  CHECK(met.run({}, true) == Ending::completed);
  const auto stages = met.summary().stages;
  REQUIRE(stages.size() == 2);
  CHECK(stages[0].ended == "condition");
  CHECK(stages[0].until == Approx(0.002).margin(1.1e-3));  // it holds from the first sample on, every 1 ms
  CHECK(stages[1].from == stages[0].until);
  CHECK(stages[1].until == Approx(stages[0].until + 0.002).margin(1e-6));
  Session never(assemble(read_or_fail(folder / "not.toml")), {}, folder / "not");
  CHECK(never.run({}, true) == Ending::completed);
  CHECK(never.summary().stages[0].ended == "at_most");
  CHECK(never.summary().stages[0].until == Approx(0.01).margin(1e-6));
  REQUIRE(never.warnings().size() == 1);
  CHECK(never.warnings()[0].find("stage 'settle' ended at its longest time") != std::string::npos);
  CHECK(never.warnings()[0].find("was rotation") != std::string::npos);
}

TEST_CASE("what a record holds comes back from its text", "[scenes][stages]") {
  RunRecord r;
  r.stage = 2;
  r.scenes = 1;
  r.start_run = "some where/checkpoint-1.h5";
  r.stages = {{"a b", 0.0, 0.1, 0.1, 0, "duration"}, {"", 0.1, 0.30000000000000004, 0.2, 77, ""}};
  r.inserted = {{0, 0.25, 0.01, {"contact.friction=0.2", "x=\"a b: c\""}}};
  r.time_step = TimeStep{1e-5, infinity, "contact m-m: as written", "of the load", AdaptiveStep{1, 2, 3, 4, 5}};
  r.fills = {{}, {FillBody{1, 1.5, Vec3(0.1, 0.2, 0.3), Vec3(1, 2, 3), Quat(0.5, 0.5, 0.5, 0.5)}}};
  const RunRecord back = RunRecord::from_text(r.to_text());
  CHECK(back.to_text() == r.to_text());
  CHECK(back.stages[1].until == r.stages[1].until);
  CHECK(back.time_step->limit == infinity);
  CHECK_THROWS(RunRecord::from_text("stage 1"));
}
