#include "scenes/study/case_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/threads/all_places.h"
#include "engine/units/error.h"
#include "scenes/stop.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> arguments(const std::string& scene, const Case& wanted, const CaseLimits& limits) {
  std::vector<std::string> args{
      "epafi", "run", scene, "--quiet", "--force", "-t", std::to_string(limits.threads), "-o", wanted.folder.string()};
  if (limits.least_output) args.push_back("--least-output");
  if (limits.seconds > 0)
    args.insert(args.end(),
                {"--cpu-limit", fmt::format("{}s", std::max(1.0, std::ceil(limits.seconds * limits.threads)))});
  for (const auto& o : wanted.overrides) args.insert(args.end(), {"--set", o});
  return args;
}

/// Every case leaves its log: a folder without one is not ours.
bool is_case(const fs::path& folder) { return fs::is_regular_file(folder / "log.txt"); }

pid_t start(const std::string& scene, const Case& wanted, const CaseLimits& limits) {
  const bool taken = fs::exists(wanted.folder) && !(fs::is_directory(wanted.folder) && fs::is_empty(wanted.folder));
  if (taken && !is_case(wanted.folder))
    throw FileError("'" + wanted.folder.string() +
                    "' is in the way of a case of that name, and no case itself; name another folder with -o");
  fs::remove_all(wanted.folder);
  fs::create_directories(wanted.folder);
  const std::vector<std::string> args = arguments(scene, wanted, limits);
  std::vector<char*> raw;
  for (const auto& a : args) raw.push_back(const_cast<char*>(a.c_str()));
  raw.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const std::string log = (wanted.folder / "log.txt").string();
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  const AllPlaces places;
  pid_t child = 0;
  const int error = posix_spawn(&child, limits.program.c_str(), &files, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw FileError(std::string("a case cannot be started: ") + std::strerror(error));
  return child;
}

std::string status_of(int wait_status) {
  if (WIFSIGNALED(wait_status)) {  // by those two before it could listen to them
    const int signal = WTERMSIG(wait_status);
    return signal == SIGINT || signal == SIGTERM ? "interrupted" : "crashed";
  }
  switch (WEXITSTATUS(wait_status)) {
    case 0:
      return "completed";
    case 1:
      return "bound_violated";
    case 2:
      return "wrong_scene";
    case 3:
      return "file_error";
    case 4:
      return "failed";
    case 75:
      return "over_budget";
    case 130:
    case 143:
      return "interrupted";
    default:
      return "crashed";
  }
}

/// The last line that the process wrote.
std::string last_line(const fs::path& log) {
  std::string text = read_whole_file(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

CaseResult collect(const Case& wanted, int wait_status) {
  CaseResult result;
  result.status = status_of(wait_status);
  if (!result.completed()) {
    result.trouble = last_line(wanted.folder / "log.txt");
    if (result.status == "file_error" && result.trouble.empty())  // nor the log, it seems
      result.trouble = "epafi: " + wanted.folder.string() + ": cannot write (is the disk full?)";
    if (WIFSIGNALED(wait_status)) result.trouble += fmt::format(" (signal {})", WTERMSIG(wait_status));
  }
  if (result.status != "file_error" && fs::exists(wanted.folder / "summary.json"))
    result.summary = read_json(wanted.folder / "summary.json");
  return result;
}

}  // namespace

CaseResult run_case(const std::string& scene, const Case& wanted, const CaseLimits& limits) {
  CaseResult result;
  const bool whole = run_cases(scene, {wanted}, limits, 1, [&](std::size_t, const CaseResult& r) { result = r; });
  if (!whole) result.status = "interrupted";
  return result;
}

bool run_cases(const std::string& scene, const std::vector<Case>& cases, const CaseLimits& limits, int jobs,
               const std::function<void(std::size_t, const CaseResult&)>& done) {
  SignalWatch signals;  // handed on to the children, which save themselves
  std::map<pid_t, std::size_t> running;
  std::size_t next = 0;  // cases.size() where no other is to begin
  bool whole = true;
  std::string refused;  // what a case could not read or write
  const auto end_all = [&] {
    if (!std::exchange(whole, false)) return;
    for (const auto& [child, index] : running) kill(child, SIGTERM);
  };
  while (next < cases.size() || !running.empty()) {
    if (SignalWatch::received() != 0) end_all();
    if (limits.until && std::chrono::steady_clock::now() >= *limits.until) next = cases.size();
    while (whole && next < cases.size() && running.size() < static_cast<std::size_t>(std::max(1, jobs))) {
      running.emplace(start(scene, cases[next], limits), next);
      ++next;
    }
    if (running.empty()) break;
    int status = 0;
    const pid_t child = wait4(-1, &status, 0, nullptr);
    if (child < 0) continue;  // interrupted: look at the signal, then wait for the children to save themselves
    const auto at = running.find(child);
    if (at == running.end()) continue;
    const std::size_t index = at->second;
    running.erase(at);
    const CaseResult result = collect(cases[index], status);
    if (result.status == "file_error") {
      if (refused.empty()) refused = result.trouble.substr(result.trouble.starts_with("epafi: ") ? 7 : 0);
      end_all();
      continue;
    }
    whole = whole && result.status != "interrupted";
    done(index, result);
  }
  if (!refused.empty()) throw FileError(refused);
  return whole && SignalWatch::received() == 0;  // also one that came with the end of the last case
}

void remove_cases(const fs::path& folder) {
  if (!fs::is_directory(folder)) return;
  std::vector<fs::path> cases;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_case(entry.path())) cases.push_back(entry.path());
  for (const fs::path& one : cases) fs::remove_all(one);
}

std::optional<CaseResult> finished_case(const Case& wanted, const std::string& scene_hash) {
  const fs::path file = wanted.folder / "summary.json";
  if (!fs::exists(file)) return std::nullopt;
  CaseResult result;
  result.summary = read_json(file);
  result.status = result.summary.text("status");
  result.trouble = result.summary.text("failure");
  const bool ended = result.status == "completed" || result.status == "bound_violated" || result.status == "failed";
  if (!ended || result.summary.text("scene_hash") != scene_hash) return std::nullopt;
  return result;
}

std::string command_line(const std::string& scene, const Case& wanted, const CaseLimits& limits) {
  std::string all;
  for (const auto& a : arguments(scene, wanted, limits)) {
    const bool plain = a.find_first_of(" \"'$&|;<>()[]{}*?!\\") == std::string::npos;
    all += (all.empty() ? "" : " ") + (plain ? a : "'" + a + "'");
  }
  return all;
}

}  // namespace epafi
