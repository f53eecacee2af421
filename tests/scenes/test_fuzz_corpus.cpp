// The inputs that fuzzing kept (tests/fuzz/run.sh): each ends in a value or in a message with place and cause.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/feeds.h"
#include "tests/support/catch.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

struct Count {
  std::size_t files = 0, accepted = 0;
};

Count replay(const std::string& reader, bool (*feed)(std::string_view)) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(EPAFI_SOURCE_DIR "/tests/data/fuzz/" + reader))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Count count;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    INFO(file.filename().string());
    ++count.files;
    count.accepted += feed(bytes);
  }
  return count;
}

}  // namespace

TEST_CASE("inputs kept from fuzzing the readers end in a value or in a message with place and cause",
          "[scenes][fuzz]") {
  for (const auto& [reader, feed, least] :
       {std::tuple("scene", &fuzz::feed_scene, 20), std::tuple("mesh", &fuzz::feed_mesh, 20),
        std::tuple("problem", &fuzz::feed_problem, 4), std::tuple("run", &fuzz::feed_run, 2)}) {
    INFO(reader);
    const Count count = replay(reader, feed);
    CHECK(count.files >= static_cast<std::size_t>(least));
    CHECK(count.accepted > 0);  // the corpus is not only noise
    CHECK(count.accepted < count.files + (std::string(reader) == "run"));
  }
}
