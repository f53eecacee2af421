// Runs that are written, ended, killed, copied or on another machine are told apart.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/files/side_file.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

void make_older(const fs::path& file, int seconds) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::seconds(seconds));
}

/// A child that marks the folder and ends at once, as if killed; it is left a zombie until the caller waits.
pid_t marked_by_a_child(const fs::path& folder) {
  const pid_t child = ::fork();
  if (child == 0) {
    new RunMark(folder);
    ::_exit(0);
  }
  siginfo_t info{};
  REQUIRE(::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT) == 0);
  return child;
}

void replace_entry(const fs::path& mark, const std::string& key, const std::string& value) {
  std::string text = "\n" + read_whole_file(mark);
  const std::size_t at = text.find("\n" + key + " ");
  REQUIRE(at != text.npos);
  text.replace(at, text.find('\n', at + 1) - at, "\n" + key + " " + value);
  write_whole_file(mark, {text.substr(1)});
}

}  // namespace

TEST_CASE("a run is running while its process is there, and over once it has its summary", "[viz_export][run_mark]") {
  const TemporaryFolder folder;
  {
    RunMark mark(folder.path());
    make_older(folder / ".running", 100'000);  // a step may take long: on this machine the process itself is asked
    CHECK(run_state(folder.path()).life == RunLife::running);
    mark.tell({"the balance is open", "two\nlines"});
    CHECK(run_state(folder.path()).warnings == std::vector<std::string>{"the balance is open", "two lines"});
    std::ofstream(folder / "summary.json") << "{}";
    CHECK(run_state(folder.path()).life == RunLife::over);
  }
  CHECK_FALSE(fs::exists(folder / ".running"));
  CHECK(run_state(folder.path()).life == RunLife::over);
}

TEST_CASE("a run whose process is gone was cut, be it a zombie or its number another's", "[viz_export][run_mark]") {
  const TemporaryFolder folder;
  std::this_thread::sleep_for(std::chrono::milliseconds(30));  // starts are told apart by hundredths of a second
  const pid_t child = marked_by_a_child(folder.path());
  CHECK(run_state(folder.path()).life == RunLife::cut);
  REQUIRE(::waitpid(child, nullptr, 0) == child);
  const RunState state = run_state(folder.path());
  CHECK(state.life == RunLife::cut);
  CHECK(state.cause == "its process " + std::to_string(child) + " is gone");
  // this process has the number now, but began at another time
  replace_entry(folder / ".running", "process", std::to_string(::getpid()));
  CHECK(run_state(folder.path()).life == RunLife::cut);
}

TEST_CASE("a copy of a folder that is written is not written", "[viz_export][run_mark]") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "run");
  const RunMark mark(folder / "run");
  std::ofstream(folder / "run" / "measures.csv") << "\n";
  fs::copy(folder / "run", folder / "copy", fs::copy_options::recursive);
  make_older(folder / "copy" / "measures.csv", 60);
  CHECK(run_state(folder / "run").life == RunLife::running);
  CHECK(run_state(folder / "copy").life == RunLife::cut);
  fs::rename(folder / "run", folder / "moved");  // a move is no copy
  CHECK(run_state(folder / "moved").life == RunLife::running);
}

TEST_CASE("on another machine the mark must move on; without a mark the files tell", "[viz_export][run_mark]") {
  const TemporaryFolder folder;
  const pid_t child = marked_by_a_child(folder.path());
  REQUIRE(::waitpid(child, nullptr, 0) == child);
  replace_entry(folder / ".running", "machine", "elsewhere");
  replace_entry(folder / ".running", "host", "node7");
  CHECK(run_state(folder.path()).life == RunLife::running);
  make_older(folder / ".running", 60);
  CHECK(run_state(folder.path()).life == RunLife::running);
  make_older(folder / ".running", 200);
  CHECK(run_state(folder.path()).life == RunLife::cut);
  CHECK(run_state(folder.path()).cause.find("node7") != std::string::npos);
  fs::remove(folder / ".running");
  std::ofstream(folder / "measures.csv") << "time,measure,component,value\n";
  CHECK(run_state(folder.path()).life == RunLife::running);
  make_older(folder / "measures.csv", 60);
  CHECK(run_state(folder.path()).life == RunLife::cut);
}
