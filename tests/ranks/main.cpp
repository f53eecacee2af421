// Run by mpirun: every rank runs all cases, a case that fails in one of them fails the test.
#define CATCH_CONFIG_RUNNER
#include "ranks/communicator.h"
#include "tests/support/catch.h"

int main(int argc, char** argv) {
  epafi::begin_ranks(argc, argv);
  const int failed = Catch::Session().run(argc, argv);
  if (failed != 0) epafi::abort_ranks(1);
  epafi::end_ranks();
  return 0;
}
