// The array job of a sweep: what Slurm is told, and that the script it is given runs what is open.
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "scenes/cli/commands.h"
#include "scenes/study/slurm_job.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"

using namespace epafi;

namespace {
const std::string program_of_tests = std::string(EPAFI_BINARY_DIR) + "/bin/epafi";
const std::string column = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/stacking/column.toml";
}  // namespace

TEST_CASE("numbers of an array are written as Slurm reads them", "[scenes][study]") {
  CHECK(array_range({}).empty());
  CHECK(array_range({4}) == "4");
  CHECK(array_range({0, 1, 2, 5, 7, 8}) == "0-2,5,7-8");
}

namespace {
/// Stands in for Slurm: keeps the lines it is given, and runs every task of the array at once.
constexpr const char* stand_in = R"sh(#!/bin/bash
here=$(dirname "$0")
printf '%s\n' "$*" >> "$here/calls.txt"
for last in "$@"; do :; done
case $last in
  --wrap=*) sh -c "${last#--wrap=}" ;;
  *) ranges=$(sed -n 's/^#SBATCH --array=//p' "$last" | tr ',' '\n' | sed 's/-/ /')
     for task in $(echo "$ranges" | while read -r a b; do seq "$a" "${b:-$a}"; done); do
       SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=1 bash "$last" >> "$here/messages.txt" 2>&1
     done
     echo "17;cluster" ;;
esac
)sh";
}  // namespace

TEST_CASE("the array job of a sweep runs the open cases, and collects their rows", "[scenes][study]") {
  const TemporaryFolder folder;
  const auto home = folder / "it's 100%";  // no character of a path is the shell's or Slurm's
  std::filesystem::create_directories(home);
  std::ofstream(home / "a sweep.toml") << "include = [\"" << column << "\"]\n[sweep]\n\"params.n\" = [2, 3, 4]\n";
  write_whole_file(folder / "sbatch", {stand_in});
  std::filesystem::permissions(folder / "sbatch", std::filesystem::perms::owner_all);
  const std::string line = "cd '" + folder.path().string() + "/it'\\''s 100%' && PATH=" + folder.path().string() +
                           ":$PATH && unset SLURM_ARRAY_TASK_ID EPAFI && ";
  const std::string slurm =
      program_of_tests +
      " sweep 'a sweep.toml' --slurm -q -t 2 -o out --set run.duration=0.02 --set 'title=\"it'\\''s\"'";
  const auto typed = [&](const std::string& command) {
    return captured([&] { return WEXITSTATUS(std::system((line + command).c_str())); });
  };
  CHECK(typed(program_of_tests + " sweep 'a sweep.toml' -q -o out --case 1 --set run.duration=0.02 "
                                 "--set 'title=\"it'\\''s\"'")
            .code == exit_done);
  const Captured written = typed(slurm);
  REQUIRE(written.code == exit_done);
  CHECK(written.out == read_whole_file(home / "out" / "sweep.sbatch"));
  CHECK_THAT(written.out, Catch::Contains("#SBATCH --array=0,2\n") && Catch::Contains("--cpus-per-task=2\n"));
  const Captured sent = typed("bash out/sweep.sbatch --partition=short");
  INFO(sent.err << read_whole_file(folder / "messages.txt"));
  CHECK(sent.code == exit_done);
  const std::string calls = read_whole_file(folder / "calls.txt");
  CHECK_THAT(calls, Catch::Contains("100%%/out/slurm_%a.txt --partition=short out/sweep.sbatch\n--partition=short "
                                    "--dependency=afterany:17 "));
  const std::string rows = read_whole_file(home / "out" / "sweep.csv");
  for (const char* row : {"\n0,completed,2,", "\n1,completed,3,", "\n2,completed,4,"})
    CHECK_THAT(rows, Catch::Contains(row));
  const Captured nothing = typed(slurm);
  CHECK(nothing.code == exit_done);
  CHECK(nothing.out.empty());
  CHECK_THAT(nothing.err, Catch::Contains("every case is finished"));
}

TEST_CASE("a sweep of more cases than an array has numbers gives each task several", "[scenes][study]") {
  const TemporaryFolder folder;
  SweepPlan sweep{"many.toml", {}, {}, {}, {}, {}};
  for (int k = 0; k < 2500; ++k) sweep.cases.push_back({{}, folder / std::to_string(k)});
  sweep.hashes.resize(sweep.cases.size());
  const std::string text = slurm_script(sweep, {"/usr/bin/epafi", folder.path(), 1});
  CHECK_THAT(text, Catch::Contains("#SBATCH --array=0-999\n") && Catch::Contains("k < 2500; k += 1000"));
}
