#include "viz_export/report/charts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

/// Text for gnuplot inside double quotes, in its plain (not enhanced) mode.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '`') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

/// A file name for gnuplot inside single quotes, where only the quote itself is special.
std::string single_quoted(const std::string& name) {
  std::string out;
  for (const char c : name) out += c == '\'' ? "''" : std::string(1, c);
  return out;
}

// eight colours that colour-blind people can distinguish (Okabe and Ito 2008)
constexpr const char* colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00",
                                   "#56B4E9", "#000000", "#8C6D31", "#6A51A3", "#7F7F7F"};

bool run_gnuplot(const fs::path& script) {
  const std::string name = script.filename().string(),
                    folder = script.parent_path().empty() ? "." : script.parent_path().string();
  const char* args[] = {"gnuplot", name.c_str(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "gnuplot.log", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t child = 0;
  const int error = posix_spawnp(&child, "gnuplot", &files, nullptr, const_cast<char**>(args), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) return false;
  int status = 0;
  waitpid(child, &status, 0);
  const bool drawn = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (drawn) fs::remove(fs::path(folder) / "gnuplot.log");
  return drawn;
}

/// Draws the same plot twice: as vector graphics and as a bitmap.
bool render(const fs::path& path, const std::string& data, const std::string& settings, const std::string& plot,
            const char* svg_size = "1000,680") {
  const std::string stem = single_quoted(path.filename().string());
  std::string script = "set encoding utf8\n" + settings;
  for (const auto& [terminal, ending] :
       {std::pair{fmt::format("svg size {} font 'Helvetica,14' background '#ffffff' noenhanced", svg_size), "svg"},
        std::pair{std::string("pngcairo size 1500,1020 font 'Helvetica,15' noenhanced"), "png"}})
    script += fmt::format("set terminal {}\nset output '{}.{}'\n{}\n", terminal, stem, ending, plot);
  write_whole_file(fs::path(path) += ".dat", {data});
  write_whole_file(fs::path(path) += ".gp", {script});
  return run_gnuplot(fs::path(path) += ".gp");
}

/// Tics at 1, 2 and 5 times powers of ten for a range of up to three decades; else "".
std::string written_tics(char axis, double from, double to) {
  if (!(to <= 2000 * from)) return "";
  std::string out;
  const double first = std::pow(10.0, std::floor(std::log10(from)));
  for (const double decade : {first, 10 * first, 100 * first, 1000 * first, 10000 * first})
    for (const double step : {1.0, 2.0, 5.0})
      if (const double x = step * decade; x >= from && x <= to)
        out += (out.empty() ? "" : ", ") + fmt::format("{:.6g}", x);
  return fmt::format("set format {0} '%.3g'\nset {0}tics ({1})\n", axis, out);
}

/// Settings of one axis: range with a margin, scale and tics.
std::string axis_settings(char axis, double low, double high, bool log, double below, double above) {
  if (!log) {
    const double room = 0.06 * (high > low ? high - low : std::max(std::abs(high), 1.0));
    return fmt::format("set {}range [{}:{}]\n", axis, low - room, high + room);
  }
  return fmt::format("set logscale {0}\nset format {0} '%.0e'\nset {0}range [{1}:{2}]\n", axis, below * low,
                     above * high) +
         written_tics(axis, below * low, above * high);
}

std::string block(const std::vector<PlotPoint>& points) {
  std::string out;
  for (const auto& p : points) out += fmt::format("{} {}\n", p[0], p[1]);
  return out + "\n\n";
}

std::string frame(const std::string& title, const std::string& x, const std::string& y) {
  return "set title " + quoted(title) + "\nset xlabel " + quoted(x) + "\nset ylabel " + quoted(y) +
         "\nset border 3 lc rgb '#444444'\nset tics nomirror out\nset grid back lc rgb '#dddddd' lt 1\nset key bottom "
         "center outside horizontal height 1 samplen 2 spacing 1.3\nset format '%g'\n";
}

/// Range of an axis.
struct PlotRange {
  double low = INFINITY, high = -INFINITY;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  PlotRange or_tenth_to_one(bool log) const {
    const bool known = log ? high > 0 : low <= high;
    return known ? *this : PlotRange{0.1, 1};
  }
};

std::array<PlotRange, 2> ranges_of(const ScatterPlot& plot) {
  PlotRange x, y;
  for (const auto& line : plot.lines) {
    for (const auto& p : line.points) {
      x.include(p[0]);
      y.include(p[1]);
    }
    for (const double failed : line.failed)
      if (failed > 0) x.include(failed);
  }
  for (const auto& [label, level] : plot.levels) y.include(level);
  return {x.or_tenth_to_one(plot.log_x), y.or_tenth_to_one(plot.log_y)};
}

}  // namespace

bool draw(const ScatterPlot& plot, const fs::path& path) {
  const auto [x, y] = ranges_of(plot);
  const std::string name = single_quoted(path.filename().string()) + ".dat";
  std::string data, parts;
  std::size_t index = 0, colour = 0;
  const auto add = [&](const std::string& text, const std::string& style) {
    data += text;
    parts += fmt::format("{}'{}' index {} {}", parts.empty() ? "plot " : ", \\\n  ", name, index++, style);
  };
  if (!plot.front.empty()) add(block(plot.front), "with lines lw 7 lc rgb '#cccccc' title 'Pareto front'");
  for (const auto& line : plot.lines) {
    const char* rgb = colours[colour % std::size(colours)];
    const std::size_t mark = 4 + (colour + 3 * (colour / std::size(colours))) % 10;  // ten colours, then other marks
    ++colour;
    if (!line.points.empty())
      add(block(line.points), fmt::format("with {} lw 2 pt {} ps 1.2 lc rgb '{}' title {}",
                                          plot.joined ? "linespoints" : "points", mark, rgb, quoted(line.label)));
    std::string bars;
    for (std::size_t k = 0; k < std::min(line.bars.size(), line.points.size()); ++k)
      if (line.bars[k][1] > 1.02 * line.bars[k][0])  // a smaller one hides behind its mark
        bars += fmt::format("{} {} {} {}\n", line.points[k][0], line.points[k][1], line.bars[k][0], line.bars[k][1]);
    if (!bars.empty()) add(bars + "\n\n", fmt::format("with xerrorbars pt 0 lw 1 lc rgb '{}' notitle", rgb));
    std::vector<PlotPoint> failed;
    for (const double at : line.failed) failed.push_back({at > 0 ? at : x.low, 2 * y.high});
    if (!failed.empty())
      add(block(failed), fmt::format("with points pt 2 ps 1.6 lw 2 lc rgb '{}' {}", rgb,
                                     line.points.empty() ? "title " + quoted(line.label + ", failed") : "notitle"));
  }
  const std::string ring = "with points pt 6 lw 2 ps ";
  if (!plot.ringed.empty()) add(block(plot.ringed), ring + "2.2 lc rgb '#444444' title " + quoted(plot.ringed_label));
  if (plot.marked) add(block({*plot.marked}), ring + "3 lc rgb '#d00000' title " + quoted(plot.marked_label));
  std::string settings = frame(plot.title, plot.x_label, plot.y_label) +
                         axis_settings('x', x.low, x.high, plot.log_x, 0.7, 1.5) +
                         axis_settings('y', y.low, y.high, plot.log_y, 0.5, 4.0);
  for (const auto& [label, level] : plot.levels) {
    settings +=
        fmt::format("set arrow from graph 0, first {0} to graph 1, first {0} nohead dt 2 lc rgb '#888888'\n", level);
    settings +=
        fmt::format("set label {} at graph 0.01, first {} offset 0,0.5 tc rgb '#666666'\n", quoted(label), level);
  }
  return render(path, data, settings, parts.empty() ? "plot NaN notitle" : parts, plot.size);
}

namespace {
/// Integer tics for small counts.
std::string steps_of_counts(const LinePlot& plot) {
  PlotRange y;
  bool whole = true;
  for (const PlotLine& line : plot.lines)
    for (const PlotPoint& p : line.points) {
      whole = whole && p[1] == std::round(p[1]);
      y.include(p[1]);
    }
  return whole && y.high - y.low <= 6 ? "set ytics 1\n" : "";
}

constexpr double line_plot_width = 620;  // pixels
constexpr double letter_width = 9;       // a wide letter of 14 pixels, whatever font the browser has
constexpr double sample_width = 60;      // of a line beside its name, with the gaps around

/// A name that the picture holds beside its line; of a longer one, which would be cut, its end: it tells names apart.
std::string fitting(const std::string& name) {
  constexpr auto most = static_cast<std::size_t>((line_plot_width - sample_width) / letter_width);
  if (name.size() <= most) return name;
  std::size_t from = name.size() - most;
  while (from < name.size() && (static_cast<unsigned char>(name[from]) & 0xC0) == 0x80) ++from;  // inside a letter
  return "..." + name.substr(from);
}
}  // namespace

bool draw(const LinePlot& plot, const fs::path& path) {
  const std::string name = single_quoted(path.filename().string()) + ".dat";
  std::string data, parts;
  for (std::size_t k = 0; k < plot.lines.size(); ++k) {
    data += block(plot.lines[k].points);
    parts += fmt::format("{}'{}' index {} with lines lw 2 lc rgb '{}' title {}", k == 0 ? "plot " : ", \\\n  ", name, k,
                         colours[k % std::size(colours)], quoted(fitting(plot.lines[k].label)));
  }
  return render(path, data,
                frame(plot.title, plot.x_label, plot.y_label) + "set autoscale xfix\n" + steps_of_counts(plot),
                parts.empty() ? "plot NaN notitle" : parts, fmt::format("{:.0f},420", line_plot_width).c_str());
}

bool draw(const KindMap& map, const fs::path& path) {
  const std::string name = single_quoted(path.filename().string()) + ".dat";
  std::string data, parts;
  std::size_t index = 0;
  for (std::size_t kind = 0; kind < map.kinds.size(); ++kind) {
    std::string text;
    for (const auto& c : map.cells)
      if (c.kind == kind) text += fmt::format("{} {}\n", c.x, c.y);
    if (text.empty()) continue;
    data += text + "\n\n";
    // green, vermilion, blue, then the rest in order
    const char* rgb = colours[kind == 0 ? 2 : kind == 1 ? 1 : kind == 2 ? 0 : kind % std::size(colours)];
    parts +=
        fmt::format("{}'{}' index {} with points pt {} ps 2 lc rgb '{}' title {}", parts.empty() ? "plot " : ", \\\n  ",
                    name, index++, kind == 0 ? 7 : 5, rgb, quoted(map.kinds[kind]));
  }
  if (!map.curve.empty()) {
    data += block(map.curve);
    parts += fmt::format("{}'{}' index {} with lines lw 3 dt 2 lc rgb '#000000' title {}",
                         parts.empty() ? "plot " : ", \\\n  ", name, index++, quoted(map.curve_label));
  }
  std::string settings = frame(map.title, map.x_label, map.y_label);
  for (const std::size_t axis : {0, 1}) {  // a little beyond the outermost cells: gnuplot's own range ends at decades
    double low = INFINITY, high = -INFINITY;
    for (const auto& c : map.cells) {
      low = std::min(low, axis == 0 ? c.x : c.y);
      high = std::max(high, axis == 0 ? c.x : c.y);
    }
    for (const auto& p : map.curve) {
      low = std::min(low, p[axis]);
      high = std::max(high, p[axis]);
    }
    if (!(high > low)) continue;
    const bool log = axis == 0 ? map.log_x : map.log_y;
    const double room = log ? std::pow(high / low, 0.06) : 1.0;
    settings += axis_settings(axis == 0 ? 'x' : 'y', low, high, log, 1.0 / room, room);
  }
  if (!map.y_names.empty()) {
    settings += "set ytics (";
    for (std::size_t k = 0; k < map.y_names.size(); ++k)
      settings += (k > 0 ? ", " : "") + quoted(map.y_names[k]) + " " + std::to_string(k);
    settings += fmt::format(")\nset yrange [-0.7:{}]\n", static_cast<double>(map.y_names.size()) - 0.3);
  }
  return render(path, data, settings, parts.empty() ? "plot NaN notitle" : parts);
}

}  // namespace epafi
