// What `epafi explain` prints, as a newcomer reads it in a terminal of 80 columns.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "scenes/cli/commands.h"
#include "scenes/cli/new_scene.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;

namespace {

/// Rows fit 80 columns; the place in the scene, where a row has one, begins below its heading.
void check_table_of_costs(const std::string& text, const std::string& file) {
  std::istringstream lines(text.substr(text.find("\n cost ") + 1));
  std::string line;
  std::getline(lines, line);
  const std::size_t where = line.find("where");
  REQUIRE(where != line.npos);
  std::size_t rows = 0;
  while (std::getline(lines, line) && !line.starts_with(" NOT paid")) {
    INFO(line);
    CHECK(line.size() <= 80);
    if (line.size() <= where) continue;
    ++rows;
    const std::string place = line.substr(where);
    CHECK((place == "default" || place.starts_with(file + ":")));
    CHECK(line[where - 1] == ' ');
  }
  CHECK(rows > 1);
}

}  // namespace

TEST_CASE("costs of a scene fit 80 columns, each with its line below the heading", "[scenes][commands]") {
  const TemporaryFolder folder;
  for (const std::string& kind : starter_kinds()) {
    INFO(kind);
    const std::filesystem::path file = folder / (kind + ".toml");
    std::ofstream(file) << captured([&] { return command_new(kind); }).out;
    check_table_of_costs(captured([&] { return command_explain({file.string(), {}}); }).out, kind + ".toml");
  }
}
