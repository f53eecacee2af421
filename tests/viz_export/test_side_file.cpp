#include "viz_export/files/side_file.h"

#include <fstream>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;

TEST_CASE("a side file replaces its target only when it is committed", "[viz_export]") {
  const TemporaryFolder folder;
  const auto target = folder / "a.txt";
  write_whole_file(target, {"old", " text"});
  {
    SideFile side(target);
    std::ofstream(side.path()) << "half of the new te";
    CHECK(read_whole_file(target) == "old text");
  }  // as after an exception
  CHECK(read_whole_file(target) == "old text");
  write_whole_file(target, {"new"}, true);
  CHECK(read_whole_file(target) == "new");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);  // no side file is left
}

TEST_CASE("writing where there is no folder is an error with path and cause", "[viz_export]") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(write_whole_file(folder / "no/a.txt", {"x"}),
                    Catch::Contains("no/a.txt") && Catch::Contains("No such file"));
  CHECK_THROWS_AS(read_whole_file(folder / "a.txt"), FileError);
}

TEST_CASE("a device is written to and stays what it is", "[viz_export]") {
  write_whole_file("/dev/null", {"x"});
  CHECK(std::filesystem::is_character_file("/dev/null"));
  CHECK_FALSE(std::filesystem::exists("/dev/null.part"));
  CHECK_THROWS_WITH(write_whole_file("/dev/full", {"x"}), Catch::Contains("/dev/full: cannot write: No space left"));
  CHECK(std::filesystem::is_character_file("/dev/full"));
}
