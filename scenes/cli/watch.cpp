#include "scenes/cli/watch.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <vector>

#include "engine/units/error.h"
#include "scenes/cli/commands.h"
#include "scenes/stop.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/measures/measure_rows.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t columns = 40;  // of a course

/// Values of one component; halved where they have become too many, so that all of the run stays in sight.
struct Course {
  std::vector<double> values;
  std::size_t stride = 1, seen = 0;
  double last = 0;

  void add(double value) {
    last = value;
    if (seen++ % stride != 0) return;
    values.push_back(value);
    if (values.size() < 2 * columns) return;
    std::vector<double> half;
    for (std::size_t k = 0; k < values.size(); k += 2) half.push_back(values[k]);
    values = std::move(half);
    stride *= 2;
  }

  std::string picture() const {
    static constexpr const char* bars[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    double low = INFINITY, high = -INFINITY;
    for (const double v : values) {
      low = std::fmin(low, v);
      high = std::fmax(high, v);
    }
    std::string out;
    const std::size_t first = values.size() > columns ? values.size() - columns : 0;
    for (std::size_t k = first; k < values.size(); ++k) {
      const double share = high > low ? (values[k] - low) / (high - low) : std::isfinite(values[k]) ? 0.0 : NAN;
      out += std::isfinite(share) ? bars[static_cast<std::size_t>(std::lround(7 * share))] : " ";
    }
    return out;
  }
};

/// The rows that a file has got since the last look.
class MeasureTail {
 public:
  /// only: measures that are shown; empty: all.
  explicit MeasureTail(fs::path path, std::vector<std::string> only = {})
      : path_(std::move(path)), only_(std::move(only)) {}

  void read() {
    std::error_code none;
    if (fs::file_size(path_, none) < at_) at_ = 0;  // a resumed run has cut it to its checkpoint, or begun anew
    std::ifstream in(path_, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(at_));
    for (std::string line; std::getline(in, line) && !in.eof();) {  // at eof the line is not whole yet
      at_ += line.size() + 1;
      const auto row = measure_row(line);
      if (!row) continue;
      time_ = row->time;
      known_.insert(row->measure);
      if (only_.empty() || std::ranges::count(only_, row->measure) > 0)
        courses_[row->measure + "," + row->component].add(row->value);
    }
  }
  double time() const { return time_; }
  const std::map<std::string, Course>& courses() const { return courses_; }
  const std::set<std::string>& known() const { return known_; }

 private:
  fs::path path_;
  std::vector<std::string> only_;
  std::uintmax_t at_ = 0;
  double time_ = 0;
  std::map<std::string, Course> courses_;
  std::set<std::string> known_;  ///< measures
};

/// The name in so many columns; a long one keeps its beginning and its component.
std::string in_columns(std::string name, std::size_t columns) {
  if (name.size() > columns) {
    const std::size_t comma = std::min(name.rfind(','), name.size() - 1);
    const std::string end = name.substr(std::max(comma, name.size() - columns / 2));
    std::size_t kept = columns - end.size() - 2;
    while (kept > 0 && (static_cast<unsigned char>(name[kept]) & 0xC0) == 0x80) --kept;  // of UTF-8
    name = name.substr(0, kept) + ".." + end;
  }
  return name + std::string(columns - std::min(columns, name.size()), ' ');
}

/// What is watched: the run's own values, then its measures.
struct Watched {
  MeasureTail own, measures;

  void read() {
    own.read();
    measures.read();
  }
  /// Lines printed. most: as the terminal holds; 0: all.
  int show(int most) const {
    std::printf("t = %.6g s\n", std::max(own.time(), measures.time()));
    int lines = 1, left_out = 0;
    for (const MeasureTail* tail : {&own, &measures})
      for (const auto& [name, course] : tail->courses()) {
        if (most > 0 && lines + 2 > most) {
          ++left_out;
          continue;
        }
        const std::string shown = tail == &own ? "run: " + name : name;
        std::printf("%s %12.5g  %s\n", in_columns(shown, 34).c_str(), course.last, course.picture().c_str());
        ++lines;
      }
    if (left_out > 0) {
      std::printf("and %d more; --measure NAME chooses\n", left_out);
      ++lines;
    }
    std::fflush(stdout);
    return lines;
  }
};

int terminal_lines() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 2 ? size.ws_row : 24;
}

/// How it ended, and the exit code.
int told_end(const fs::path& folder, const RunState& state, double time) {
  if (state.life == RunLife::over) {
    std::printf("%s\n", read_json(folder / "summary.json").text("status").c_str());
    return exit_done;
  }
  const bool resumable = fs::exists(folder / "checkpoint.h5");
  std::printf("the run was cut off after t = %.6g s: %s; %s\n", time, state.cause.c_str(),
              resumable ? ("`epafi resume " + folder.string() + "` goes on from its last checkpoint").c_str()
                        : "it has no checkpoint yet");
  return exit_failed;
}

void refuse_unknown(const std::vector<std::string>& wanted, const std::set<std::string>& known) {
  for (const std::string& name : wanted) {
    if (known.contains(name)) continue;
    std::string all;
    for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
    throw SceneError("--measure " + name + ": the run has " + (all.empty() ? "no measures" : all));
  }
}

}  // namespace

int command_watch(const std::string& directory, const std::vector<std::string>& chosen) {
  const fs::path folder(directory);
  if (!fs::exists(folder / "measures.csv")) throw FileError(no_run_text(folder, "watch"));
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  const SignalWatch signals;
  Watched watched{MeasureTail(folder / "progress.csv"), MeasureTail(folder / "measures.csv", chosen)};
  int lines = 0;
  for (int second = 0;; ++second) {
    const RunState state = run_state(folder);  // before the rows: those of a run that is over are all there
    const bool over = state.life != RunLife::running;
    watched.read();
    if (over || second == 2) refuse_unknown(chosen, watched.measures.known());
    const bool due = terminal || over || second % 10 == 0;
    if (due && terminal && lines > 0) std::printf("\033[%dA\033[J", lines);
    if (due) lines = watched.show(terminal ? terminal_lines() : 0);
    if (over) return told_end(folder, state, std::max(watched.own.time(), watched.measures.time()));
    if (SignalWatch::received() != 0) return exit_done;
    sleep(1);
  }
}

}  // namespace epafi
