// A run that goes on where its files were torn: the state is that of the last checkpoint, nothing is read as if whole.
#include <filesystem>
#include <fstream>

#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/support/scene_text.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/hdf5/stored_run.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string two_bodies = R"(
run = { duration = 0.04, time_step = 1e-3, output_interval = 5e-3 }
world = { gravity = [0, 0, -9.81] }
material.m = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "nonsmooth", restitution = 0.5, friction = 0.5 }
)" + experiments::half_space_floor("m") +
                               R"([[body]]
name = "stone"
shape = { box = { size = [0.01, 0.02, 0.015] } }
material = "m"
position = [0, 0, 0.02]
euler_deg = [10, 20, 30]
[[measure]]
name = "height"
kind = "position"
body = "stone"
)";

std::unique_ptr<Assembly> ready(const std::string& more = "") {
  ReadResult read = read_scene_text(two_bodies + more, "two.toml", {}, full_registry());
  REQUIRE(read.scene);
  return assemble(std::move(*read.scene));
}

std::string first_half(const fs::path& folder) {
  Session straight(ready(), {}, folder / "straight");
  straight.run({}, true);
  Session cut(ready(), {}, folder / "cut");
  CHECK(cut.run({std::nullopt, 20, std::nullopt}, true) == Ending::until);
  return straight.summary().state_hash;
}

}  // namespace

TEST_CASE("a torn run.h5 is set aside and the run goes on from its checkpoint", "[scenes][restart]") {
  const TemporaryFolder folder;
  const std::string hash = first_half(folder.path());
  const fs::path run = folder / "cut/run.h5";
  const auto whole = fs::file_size(run);
  CHECK(damage_of(run).empty());
  fs::copy_file(run, folder / "whole.h5");
  int damaged = 0;
  for (const double part : {0.0, 0.1, 0.5, 0.9, 0.999}) {
    INFO(part);
    fs::copy(folder / "cut", folder / "again", fs::copy_options::recursive);
    fs::resize_file(folder / "again/run.h5", static_cast<std::uintmax_t>(part * static_cast<double>(whole)));
    auto resumed = Session::resume(ready(), {}, folder / "again");
    CHECK(resumed->run({}, true) == Ending::completed);
    CHECK(resumed->summary().state_hash == hash);
    CHECK(resumed->note().find("it is kept as run.h5.damaged, a new one begins at step 20") != std::string::npos);
    CHECK(fs::exists(folder / "again/run.h5.damaged"));
    damaged += !damage_of(folder / "again/run.h5.damaged").empty();
    CHECK(StoredRun(folder / "again/run.h5").snapshots() == 4);  // after the checkpoint: 25, 30, 35, 40 ms
    fs::remove_all(folder / "again");
  }
  CHECK(damaged == 5);
}

TEST_CASE("a run is not continued with another scene's checkpoint or run file", "[scenes][restart]") {
  const TemporaryFolder folder;
  first_half(folder.path());
  CHECK_THROWS_WITH(Session::resume(ready("[bounds]\nenergy_error = 1\n"), {}, folder / "cut"),
                    Catch::Contains("another scene"));
}
