// Every scene of the library by all ranks: the golden hash of one process, or refused with its line.
#include <chrono>
#include <cstdio>
#include <numeric>

#include "engine/threads/parallel.h"
#include "ranks/communicator.h"
#include "ranks/team.h"
#include "scenes/several_ranks.h"
#include "tests/support/catch.h"
#include "tests/support/library_scenes.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Why the scene is refused; empty where it is not.
std::string refusal(const Assembly& assembly) {
  try {
    check_shareable(assembly);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

/// By all ranks; the hash at rank 0, empty elsewhere.
std::string shared_hash(SceneRun& run, const Short& s) {
  MpiTeam team;
  if (team.number() != 0) {
    CHECK(team.follow(run.simulation(), part_setup(*run.assembly)).code == 0);
    return "";
  }
  SceneRun part = prepare_scene(library(s.scene), s.overrides);
  share_out(*run.assembly, std::move(part.assembly), team);
  RankTeam::set_of_program(&team);
  if (team.helpers()) team.helpers()->least_contacts = 0;
  run.simulation().start();
  run.advance_to(s.steps);
  run.simulation().gather_state();
  RankTeam::set_of_program(nullptr);
  CHECK(run.failure == "");
  const auto figures = team.figures();
  REQUIRE(figures);
  CHECK(figures->ranks == rank_count());
  const std::string hash = run.hash();
  team.end(0);
  return hash;
}

}  // namespace

TEST_CASE("every library scene has its golden hash on all ranks, or is refused with its line", "[.][library]") {
  const auto golden = golden_hashes();
  std::size_t equal = 0, refused = 0;
  for (const auto& scene : all_scenes()) {
    const Short s = shortened(scene);
    INFO(scene);
    SceneRun run = prepare_scene(library(scene), s.overrides);
    std::string told = refusal(*run.assembly);
    if (!told.empty()) {
      ++refused;
      const std::size_t line = told.find(scene.substr(scene.find('/') + 1) + ":");
      CHECK(line != std::string::npos);
      if (line != std::string::npos) told = told.substr(line);
      if (rank_number() == 0) std::printf("%-34s refused  %s\n", scene.c_str(), told.c_str());
      continue;
    }
    const std::string hash = shared_hash(run, s);
    if (rank_number() != 0) continue;
    const bool same = hash == golden.at(scene + " as-written");
    CHECK(same);
    equal += same;
    std::printf("%-34s %s\n", scene.c_str(), same ? "golden" : ("OTHER: " + hash).c_str());
    std::fflush(stdout);
  }
  if (rank_number() == 0) std::printf("%zu golden, %zu refused\n", equal, refused);
}

TEST_CASE("the stages of a process that follows, and its waiting, are all of its time") {
  MpiTeam team;
  SceneRun run = prepare_scene(library("bed/bed.toml"), {"params.n=300"});
  if (team.number() != 0) {
    CHECK(team.follow(run.simulation(), part_setup(*run.assembly)).code == 0);
    return;
  }
  SceneRun part = prepare_scene(library("bed/bed.toml"), {"params.n=300"});
  share_out(*run.assembly, std::move(part.assembly), team);
  run.simulation().start();
  run.advance_to(10);
  const auto before = team.figures();
  const auto begin = std::chrono::steady_clock::now();
  run.advance_to(400);
  const auto after = team.figures();
  const double all = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  team.end(0);
  REQUIRE(before);
  REQUIRE(after);
  REQUIRE(after->seconds.size() == static_cast<std::size_t>(rank_count()));
  for (std::size_t rank = 1; rank < after->seconds.size(); ++rank) {
    const RankSeconds& seconds = after->seconds[rank];
    const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0) -
                       std::accumulate(before->seconds[rank].begin(), before->seconds[rank].end(), 0.0);
    // a process that follows tells its figures at moments of its own, a message later
    CHECK(sum > 0.8 * all);
    CHECK(sum < 1.1 * all);
    CHECK(seconds[static_cast<std::size_t>(RankStage::contact)] > 0.0);
  }
}
