/// Starts the program as one of the processes that mpirun has begun. Rank 0 speaks; the others keep what they have to
/// say until they fail alone.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <vector>

#include "engine/threads/parallel.h"
#include "ranks/communicator.h"
#include "ranks/team.h"
#include "scenes/cli/program.h"

namespace {

/// Messages of a rank that is not rank 0, set aside.
class QuietRank {
 public:
  QuietRank() : speaks_(dup(STDERR_FILENO)), kept_(std::tmpfile()) {
    std::fflush(nullptr);
    if (std::freopen("/dev/null", "w", stdout) == nullptr || kept_ == nullptr) return;
    dup2(fileno(kept_), STDERR_FILENO);
  }
  QuietRank(const QuietRank&) = delete;
  QuietRank& operator=(const QuietRank&) = delete;
  ~QuietRank() = default;  // the process ends with it

  void report_all(int rank) const {
    std::fflush(nullptr);
    dup2(speaks_, STDERR_FILENO);
    std::fprintf(stderr, "epafi: process %d of the run failed:\n", rank);
    if (kept_ == nullptr) return;
    std::rewind(kept_);
    for (int c = std::fgetc(kept_); c != EOF; c = std::fgetc(kept_)) std::fputc(c, stderr);
    std::fflush(stderr);
  }

 private:
  int speaks_;
  std::FILE* kept_;
};

/// Threads of all ranks of this machine together: its cores, unless options say how many.
void share_threads() {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return;
  const char* const here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  const int ranks = here != nullptr ? std::max(1, std::atoi(here)) : epafi::rank_count();
  epafi::set_thread_count(std::max(1, epafi::thread_count() / ranks));
}

int run_shared(int argc, char** argv) {
  if (epafi::rank_count() == 1) return epafi::program(argc, argv);  // nothing to share out
  epafi::MpiTeam team;
  epafi::RankTeam::set_of_program(&team);
  share_threads();
  if (team.number() == 0) {
    if (!team.end(epafi::program(argc, argv))) epafi::abort_ranks(team.code());
    return team.code();
  }
  const QuietRank quiet;
  if (!team.end(epafi::program(argc, argv))) {
    quiet.report_all(team.number());
    epafi::abort_ranks(team.code());
  }
  return team.code();
}

}  // namespace

int main(int argc, char** argv) {
  epafi::begin_ranks(argc, argv);
  const std::string_view command = argc > 1 ? argv[1] : "";
  int code = 0;
  if (command == "run" || command == "resume")
    code = run_shared(argc, argv);
  else if (epafi::rank_number() == 0)
    code = epafi::program(argc, argv);
  epafi::end_ranks();
  return code;
}
