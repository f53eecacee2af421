#include "scenes/cli/watch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <vector>

#include "engine/units/error.h"
#include "scenes/cli/commands.h"
#include "scenes/stop.h"
#include "viz_export/files/json_reader.h"

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

/// The rows that measures.csv has got since the last look.
class MeasureTail {
 public:
  explicit MeasureTail(fs::path path) : path_(std::move(path)) {}

  void read() {
    std::ifstream in(path_, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(at_));
    for (std::string line; std::getline(in, line) && !in.eof();) {  // at eof the line is not whole yet
      at_ += line.size() + 1;
      take(line);
    }
  }
  double time() const { return time_; }
  const std::map<std::string, Course>& courses() const { return courses_; }

 private:
  void take(const std::string& line) {
    const std::size_t first = line.find(','), last = line.rfind(',');
    if (first == line.npos || last <= first) return;
    double time = 0, value = 0;
    if (!number(line, 0, first, time) || !number(line, last + 1, line.size(), value)) return;  // the header too
    time_ = time;
    std::string name = line.substr(first + 1, last - first - 1);
    courses_[name].add(value);
  }
  static bool number(const std::string& line, std::size_t begin, std::size_t end, double& out) {
    const auto result = std::from_chars(line.data() + begin, line.data() + end, out);
    return result.ec == std::errc() && result.ptr == line.data() + end;
  }
  fs::path path_;
  std::size_t at_ = 0;
  double time_ = 0;
  std::map<std::string, Course> courses_;
};

/// Lines printed.
int show(const MeasureTail& tail) {
  std::printf("t = %.6g s\n", tail.time());
  int lines = 1;
  for (const auto& [name, course] : tail.courses()) {
    std::printf("%-34s %12.5g  %s\n", name.c_str(), course.last, course.picture().c_str());
    ++lines;
  }
  std::fflush(stdout);
  return lines;
}

}  // namespace

int command_watch(const std::string& directory) {
  const fs::path folder(directory);
  if (!fs::exists(folder / "measures.csv"))
    throw FileError("no run in '" + directory + "': measures.csv is missing; `epafi run` writes it");
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  const SignalWatch signals;
  MeasureTail tail(folder / "measures.csv");
  int lines = 0;
  for (int second = 0;; ++second) {
    const bool over = fs::exists(folder / "summary.json");
    tail.read();
    const bool due = terminal || over || second % 10 == 0;
    if (due && terminal && lines > 0) std::printf("\033[%dA\033[J", lines);
    if (due) lines = show(tail);
    if (over) break;
    if (SignalWatch::received() != 0) return exit_done;
    sleep(1);
  }
  std::printf("%s\n", read_json(folder / "summary.json").text("status").c_str());
  return exit_done;
}

}  // namespace epafi
