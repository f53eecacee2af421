#include "engine/lanes/program_pages.h"

#include <fstream>

#include "tests/support/catch.h"

using namespace epafi;

#if defined(__linux__)
namespace {
double pages_of_files() {
  std::ifstream statm("/proc/self/statm");
  double all = 0.0, resident = 0.0, of_files = 0.0;
  statm >> all >> resident >> of_files;
  return of_files;
}
}  // namespace

TEST_CASE("pages of the program are given back, and it runs on", "[engine][memory]") {
  const double before = pages_of_files();
  REQUIRE(before > 100.0);
  give_back_program();
  const double after = pages_of_files();
  CHECK(after < 0.7 * before);
}
#endif
