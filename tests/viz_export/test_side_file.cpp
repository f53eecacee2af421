#include "viz_export/files/side_file.h"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <vector>

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

TEST_CASE("several processes write one file at the same time, each whole", "[viz_export]") {
  const TemporaryFolder folder;
  const auto file = folder / "study.json";
  constexpr int writers = 4;
  std::vector<pid_t> children;
  for (int k = 0; k < writers; ++k) {
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      bool good = true;
      try {
        for (int n = 0; n < 200; ++n) write_whole_file(file, {std::string(1000, static_cast<char>('a' + k))});
      } catch (const FileError&) {
        good = false;
      }
      ::_exit(good ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(status == 0);
  }
  const std::string text = read_whole_file(file);
  CHECK(text == std::string(1000, text.front()));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("a device is written to and stays what it is", "[viz_export]") {
  write_whole_file("/dev/null", {"x"});
  CHECK(std::filesystem::is_character_file("/dev/null"));
  CHECK_FALSE(std::filesystem::exists("/dev/null.part"));
  CHECK_THROWS_WITH(write_whole_file("/dev/full", {"x"}), Catch::Contains("/dev/full: cannot write: No space left"));
  CHECK(std::filesystem::is_character_file("/dev/full"));
}
