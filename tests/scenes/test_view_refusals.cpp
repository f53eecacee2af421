// What `view`, `render`, `watch` and `run` say of what they cannot take.
#include <sys/stat.h>

#include <fstream>
#include <functional>
#include <random>

#include "engine/units/error.h"
#include "scenes/cli/commands.h"
#include "scenes/cli/library.h"
#include "scenes/cli/view_commands.h"
#include "scenes/cli/watch.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/view/page.h"

using namespace epafi;
using Catch::Contains;

namespace {

int view_of(const std::string& what) {
  ViewOptions options;
  options.what = what;
  options.out = "/dev/null";
  return command_view(options);
}

}  // namespace

TEST_CASE("for a file that is no scene, view says what it takes, without TOML's grammar", "[scenes][view]") {
  if (page_parts().three[0] == '\0') return;
  const TemporaryFolder folder;
  std::mt19937 random(4);
  for (int k = 0; k < 20; ++k) {
    const std::string file = (folder / ("file" + std::to_string(k))).string();
    std::ofstream out(file, std::ios::binary);
    for (int byte = 0; byte < 400; ++byte) out << static_cast<char>(k % 2 == 0 ? random() : 'a' + random() % 26);
    out.close();
    CHECK_THROWS_WITH(view_of(file), Contains("is no scene; `epafi view` takes the output folder of a run"));
    CommonOptions common;
    common.scene = file;
    CHECK_THROWS_WITH(command_check(common), Contains("is no scene file"));
  }
  CHECK_THROWS_AS(view_of("/dev/null"), SceneError);
  // a scene by another name keeps its places
  std::ofstream(folder / "scene.txt") << "[run]\nduration = \n";
  CHECK_THROWS_WITH(view_of((folder / "scene.txt").string()), Contains("scene.txt:2"));
  CHECK(looks_like_scene(folder / "scene.txt"));
  // a file of a run means the run
  std::ofstream(folder / "run.h5") << "x";
  std::ofstream(folder / "summary.json") << "{}";
  CHECK_THROWS_WITH(view_of((folder / "summary.json").string()), Contains("`epafi view " + folder.path().string()));
}

TEST_CASE("view, render and watch of a sweep's folder name report and the runs in it", "[scenes][view]") {
  if (page_parts().three[0] == '\0') return;
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "case_0000");
  std::ofstream(folder / "case_0000" / "run.h5") << "x";
  const std::string name = folder.path().string();
  const auto said = [](const std::function<int()>& command) {
    try {
      command();
    } catch (const FileError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  RenderRequest render;
  render.directory = name;
  for (const std::function<int()>& command :
       {std::function<int()>([&] { return view_of(name); }), std::function<int()>([&] { return command_watch(name); }),
        std::function<int()>([&] { return command_render(render); }),
        std::function<int()>([&] { return command_resume(name, {}, {}); }),
        std::function<int()>([&] { return command_export(name, "vtk"); })})
    CHECK_THAT(said(command), Contains("`epafi report " + name + "`") && Contains(name + "/case_0000"));
}
