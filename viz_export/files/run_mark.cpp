#include "viz_export/files/run_mark.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "engine/units/error.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr const char* mark_name = ".running";
constexpr auto patience = std::chrono::seconds(120);          // with a mark of another machine
constexpr auto patience_unmarked = std::chrono::seconds(10);  // measures.csv is written each second

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "?";
}

/// Processes can be asked for where boot and namespace are the same; "" where that is not known.
std::string machine() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code none;
  const fs::path processes = fs::read_symlink("/proc/self/ns/pid", none);
  return boot.empty() || processes.empty() ? "" : boot + "/" + processes.string();
}

/// Start of a process in ticks since boot; "" where it does not exist or is a zombie.
std::string start_of(const std::string& process) {
  std::ifstream in("/proc/" + process + "/stat");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::size_t name_end = text.rfind(')');  // names may hold blanks and brackets
  if (name_end == text.npos) return "";
  std::istringstream fields(text.substr(name_end + 1));
  std::string state, field;
  fields >> state;
  constexpr int between = 19;  // proc(5): starttime is the 22nd field, the state the third
  for (int k = 0; k < between; ++k) fields >> field;
  return state == "Z" || state == "X" ? "" : field;
}

/// Inode of the folder, which tells it from its copies.
std::string number_of(const fs::path& folder) {
  struct stat about {};
  return stat(folder.c_str(), &about) == 0 ? std::to_string(about.st_ino) : "";
}

struct MarkText {
  std::map<std::string, std::string> entries;
  std::vector<std::string> warnings;
};

MarkText read_mark(const fs::path& path) {
  MarkText out;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    const std::size_t blank = std::min(line.find(' '), line.size());
    const std::string key = line.substr(0, blank), value = line.substr(std::min(blank + 1, line.size()));
    if (key == "warning")
      out.warnings.push_back(value);
    else
      out.entries[key] = value;
  }
  return out;
}

bool changed_within(const fs::path& file, std::chrono::seconds age) {
  std::error_code none;
  const auto changed = fs::last_write_time(file, none);
  return !none && fs::file_time_type::clock::now() - changed < age;
}

}  // namespace

RunState run_state(const fs::path& folder) {
  std::error_code none;
  if (fs::exists(folder / "summary.json", none)) return {};
  const fs::path path = folder / mark_name;
  MarkText mark = read_mark(path);
  RunState out{RunLife::running, {}, std::move(mark.warnings)};
  auto& entry = mark.entries;
  if (entry["process"].empty() || entry["folder"] != number_of(folder)) {
    const bool changes = changed_within(folder / "measures.csv", patience_unmarked) ||
                         changed_within(folder / "run.h5", patience_unmarked);
    if (!changes) out = {RunLife::cut, "no program writes it", std::move(out.warnings)};
  } else if (!entry["machine"].empty() && entry["machine"] == machine()) {
    if (start_of(entry["process"]) != entry["started"])
      out = {RunLife::cut, fmt::format("its process {} is gone", entry["process"]), std::move(out.warnings)};
  } else if (!changed_within(path, patience)) {
    out = {RunLife::cut,
           fmt::format("process {} on {} has given no sign of life for {} s", entry["process"], entry["host"],
                       patience.count()),
           std::move(out.warnings)};
  }
  return out;
}

RunMark::RunMark(fs::path folder)
    : path_(folder / mark_name),
      head_(fmt::format("host {}\nprocess {}\nstarted {}\nmachine {}\nfolder {}\n", host_name(), getpid(),
                        start_of(std::to_string(getpid())), machine(), number_of(folder))) {
  write();
}

RunMark::~RunMark() {
  std::error_code none;
  fs::remove(path_, none);
}

void RunMark::write() const {
  std::string warnings;
  for (const std::string& warning : warnings_) warnings += "warning " + warning + "\n";
  try {
    write_whole_file(path_, {head_, warnings});
  } catch (const FileError&) {  // the run goes on without: readers then look at its other files
    return;
  }
}

bool RunMark::beat() {
  const auto now = std::chrono::steady_clock::now();
  if (now - beaten_ < std::chrono::seconds(1)) return false;
  beaten_ = now;
  utimensat(AT_FDCWD, path_.c_str(), nullptr, 0);
  return true;
}

void RunMark::tell(std::vector<std::string> warnings) {
  for (std::string& line : warnings) std::replace(line.begin(), line.end(), '\n', ' ');
  if (warnings == warnings_) return;
  warnings_ = std::move(warnings);
  write();
}

}  // namespace epafi
