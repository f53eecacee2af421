#include "scenes/cli/watch.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

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
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/measures/measure_rows.h"
#include "viz_export/measures/measure_units.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t file_width = 112;  // of lines that go to no terminal

/// Characters of a line: the name with its unit, the last value, the course, its ends.
struct LineWidths {
  std::size_t name = 34, value = 12, course = 40, ends = 24;
  /// Widths for a terminal of this width.
  explicit LineWidths(std::size_t width) {
    if (width < 100) name = 28;
    const std::size_t others = name + value + ends + 3;
    course = width > others + 8 ? std::min<std::size_t>(course, width - others) : 8;
  }
};

/// Values of one component; thinned by half where there are too many, so that the whole run is shown.
struct Course {
  std::vector<double> values;
  std::size_t stride = 1, seen = 0;
  double last = 0, low = INFINITY, high = -INFINITY;

  void add(double value) {
    constexpr std::size_t most = 400;
    last = value;
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (seen++ % stride != 0) return;
    values.push_back(value);
    if (values.size() < most) return;
    std::vector<double> half;
    for (std::size_t k = 0; k < values.size(); k += 2) half.push_back(values[k]);
    values = std::move(half);
    stride *= 2;
  }

  /// Bars from first to last value, scaled from lowest to highest.
  std::string picture(std::size_t columns) const {
    static constexpr const char* bars[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    const std::size_t n = values.size(), shown = std::min(columns, n);
    std::string out;
    for (std::size_t k = 0; k < shown; ++k) {
      const double v = values[shown > 1 ? k * (n - 1) / (shown - 1) : 0];
      const double share = high > low ? (v - low) / (high - low) : std::isfinite(v) ? 0.0 : NAN;
      out += std::isfinite(share) ? bars[static_cast<std::size_t>(std::lround(7 * share))] : " ";
    }
    return out + std::string(columns - shown, ' ');
  }
  std::string ends() const {
    if (!(low <= high)) return "no number yet";
    return high > low ? fmt::format("{:.4g} to {:.4g}", low, high) : fmt::format("always {:.4g}", low);
  }
};

/// Reads the rows added to a file since the last call.
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
      first_time_ = std::min(first_time_, time_);
      known_.insert(row->measure);
      if (only_.empty() || std::ranges::count(only_, row->measure) > 0)
        courses_[row->measure + "," + row->component].add(row->value);
    }
  }
  double time() const { return time_; }
  double first_time() const { return first_time_; }
  const std::map<std::string, Course>& courses() const { return courses_; }
  const std::set<std::string>& known() const { return known_; }

 private:
  fs::path path_;
  std::vector<std::string> only_;
  std::uintmax_t at_ = 0;
  double time_ = 0, first_time_ = INFINITY;
  std::map<std::string, Course> courses_;
  std::set<std::string> known_;  ///< measures
};

/// The name in at most `columns` characters, then its unit; a long name keeps its beginning and its component.
std::string in_columns(std::string name, std::size_t columns, const std::string& unit) {
  if (name.size() > columns) {
    const std::size_t comma = std::min(name.rfind(','), name.size() - 1);
    const std::string end = name.substr(std::max(comma, name.size() - columns / 2));
    std::size_t kept = columns - end.size() - 2;
    while (kept > 0 && (static_cast<unsigned char>(name[kept]) & 0xC0) == 0x80) --kept;  // of UTF-8
    name = name.substr(0, kept) + ".." + end;
  }
  return name + unit + std::string(columns - std::min(columns, name.size()), ' ');
}

/// Kinds of the scene's measures from run.h5, for their units; read again while a name has none.
class MeasureKinds {
 public:
  explicit MeasureKinds(fs::path file) : file_(std::move(file)) {}
  void learn(const std::set<std::string>& names) {
    const auto is_new = [&](const std::string& name) { return !kinds_.contains(name); };
    if (tries_ == 0 || std::none_of(names.begin(), names.end(), is_new)) return;
    --tries_;
    try {
      for (const StoredMeasure& m : StoredRun(file_).measures()) kinds_[m.name] = m.kind;
    } catch (const FileError&) {  // it is not there yet, or is just being written
      return;
    }
  }
  std::string of(const std::string& measure) const {
    const auto at = kinds_.find(measure);
    return at == kinds_.end() ? "" : at->second;
  }

 private:
  fs::path file_;
  std::map<std::string, std::string> kinds_;
  int tries_ = 100;
};

/// The watched values: those of the run, then its measures.
struct Watched {
  MeasureTail own, measures;
  MeasureKinds kinds;

  void read() {
    own.read();
    measures.read();
    kinds.learn(measures.known());
  }
  /// "[N]"; empty where there is no unit.
  std::string unit_of(const std::string& name, bool is_own) const {
    const std::size_t comma = name.rfind(',');
    const std::string measure = name.substr(0, comma), component = name.substr(comma + 1);
    const std::string own_kind = measure == "energy" ? "energy" : "run";
    const std::string unit = measure_unit(is_own ? own_kind : kinds.of(measure), component).unit;
    return unit.empty() ? "" : " [" + unit + "]";
  }
  /// Prints lines; returns their number. most: height of the terminal; 0: all.
  int show(int most, const LineWidths& widths) const {
    const double now = std::max(own.time(), measures.time());
    const std::string since =
        std::isfinite(first_time()) ? fmt::format("; courses from {:.6g} s on", first_time()) : "";
    std::printf("t = %.6g s%s\n", now, since.c_str());
    int lines = 1, left_out = 0;
    for (const MeasureTail* tail : {&own, &measures})
      for (const auto& [name, course] : tail->courses()) {
        if (most > 0 && lines + 2 > most) {
          ++left_out;
          continue;
        }
        const std::string unit = unit_of(name, tail == &own), shown = tail == &own ? "run: " + name : name;
        const std::string label = in_columns(shown, widths.name - unit.size(), unit);
        std::printf("%s %*.5g %s  %s\n", label.c_str(), static_cast<int>(widths.value - 1), course.last,
                    course.picture(widths.course).c_str(), course.ends().c_str());
        ++lines;
      }
    if (left_out > 0) {
      std::printf("and %d more; --measure NAME chooses\n", left_out);
      ++lines;
    }
    std::fflush(stdout);
    return lines;
  }
  double first_time() const { return std::min(own.first_time(), measures.first_time()); }
};

winsize terminal_size() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) size = {};
  if (size.ws_row <= 2) size.ws_row = 24;
  if (size.ws_col == 0) size.ws_col = 80;
  return size;
}

/// Prints how the run ended; returns the exit code.
int told_end(const fs::path& folder, const RunState& state, double time) {
  if (state.life == RunLife::over) {
    std::string status, trouble;
    try {
      status = read_json(folder / "summary.json").text("status");
    } catch (const FileError& e) {
      trouble = e.what();
    }
    if (!status.empty()) {
      std::printf("%s\n", status.c_str());
      return exit_done;
    }
    if (trouble.empty()) trouble = "'" + (folder / "summary.json").string() + "' names no status of a run";
    std::printf("the run is over, its last row is of t = %.6g s; how it ended is not known: %s\n", time,
                trouble.c_str());
    return exit_failed;
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
  if (!fs::exists(folder / "measures.csv")) throw FileError(no_run_text(folder, "watch", "measures.csv"));
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  const SignalWatch signals;
  Watched watched{MeasureTail(folder / "progress.csv"), MeasureTail(folder / "measures.csv", chosen),
                  MeasureKinds(folder / "run.h5")};
  int lines = 0;
  for (int second = 0;; ++second) {
    const RunState state = run_state(folder);  // before the rows: those of a run that is over are all there
    const bool over = state.life != RunLife::running;
    watched.read();
    if (over || second == 2) refuse_unknown(chosen, watched.measures.known());
    const bool due = terminal || over || second % 10 == 0;
    if (due && terminal && lines > 0) std::printf("\033[%dA\033[J", lines);
    const winsize size = terminal_size();
    if (due) lines = watched.show(terminal ? size.ws_row : 0, LineWidths(terminal ? size.ws_col : file_width));
    if (over) return told_end(folder, state, std::max(watched.own.time(), watched.measures.time()));
    if (SignalWatch::received() != 0) return exit_done;
    sleep(1);
  }
}

}  // namespace epafi
