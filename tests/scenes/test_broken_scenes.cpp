// Every file of tests/data/broken states in its first lines what the door must say of it, word for word.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "scenes/reader/scene_reader.h"
#include "tests/support/catch.h"
#include "tests/support/scene_registry.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string folder = EPAFI_SOURCE_DIR "/tests/data/broken/";
const std::string mark = "# expect: ";

std::vector<std::string> expected_of(const fs::path& file) {
  std::vector<std::string> expected;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line) && line.compare(0, mark.size(), mark) == 0;)
    expected.push_back(line.substr(mark.size()));
  return expected;
}

/// Without the folder, and without the name of the scene itself.
std::string shortened(std::string text, const std::string& scene) {
  for (std::size_t at; (at = text.find(folder)) != std::string::npos;) text.erase(at, folder.size());
  if (text.compare(0, scene.size() + 1, scene + ":") == 0) text.erase(0, scene.size() + 1);
  return text;
}

}  // namespace

TEST_CASE("every broken scene is refused with exactly the stated messages", "[scenes][door]") {
  const Registry registry = test_registry();
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  REQUIRE(files.size() >= 30);
  for (const auto& file : files) {
    const auto expected = expected_of(file);
    const auto result = read_scene(file.string(), {}, registry);
    std::vector<std::string> found;
    for (const auto& problem : result.problems)
      found.push_back(shortened(problem.to_string(), file.filename().string()));
    INFO(file.filename().string());
    CHECK(found == expected);
    REQUIRE(!expected.empty());
    const bool refused = std::any_of(result.problems.begin(), result.problems.end(),
                                     [](const Problem& p) { return p.level == Problem::Level::error; });
    CHECK(refused == !result.scene.has_value());
  }
}

TEST_CASE("a scene file that does not exist is a problem, not an exception", "[scenes][door]") {
  const auto result = read_scene("no/such/scene.toml", {}, test_registry());
  REQUIRE(result.problems.size() == 1);
  CHECK(result.problems[0].to_string() == "no/such/scene.toml: error: the scene file does not exist");
  CHECK_FALSE(result.scene);
}

TEST_CASE("any text ends in problems or a scene, never in an exception", "[scenes][door]") {
  // prefixes and single-byte damage of a whole scene: the parser sees every state it can be left in
  std::ifstream in(EPAFI_SOURCE_DIR "/tests/data/scenes/pebbles.toml");
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const std::string file = EPAFI_SOURCE_DIR "/tests/data/scenes/pebbles.toml";
  const Registry registry = test_registry();
  std::size_t refused = 0, tried = 0;
  for (std::size_t at = 0; at < whole.size(); at += 37) {
    std::string damaged = whole;
    damaged[at] = "]=\"#{1\n"[at % 7];
    for (const auto& text : {whole.substr(0, at), damaged}) {
      const auto result = read_scene_text(text, file, {}, registry);
      refused += !result.scene;
      CHECK(result.scene.has_value() ==
            std::none_of(result.problems.begin(), result.problems.end(),
                         [](const Problem& p) { return p.level == Problem::Level::error; }));
      ++tried;
    }
  }
  CHECK(refused > tried / 4);
}
