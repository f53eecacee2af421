/// @file charts.h  Pictures of numbers: points on two axes, and maps of what failed. Drawn by gnuplot,
/// which runs as a program; where it is not installed the data and the script are left beside the place of the picture.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace epafi {

using PlotPoint = std::array<double, 2>;

struct PlotLine {
  std::string label;
  std::vector<PlotPoint> points;
  std::vector<double>
      failed;  ///< x of points without a y, drawn as crosses at the upper edge; named in the legend if alone
  std::vector<PlotPoint> bars = {};  ///< least and largest x of each point; may be empty
};

/// Points and lines; coordinates on logarithmic axes are > 0.
struct ScatterPlot {
  std::string title, x_label, y_label;
  std::vector<PlotLine> lines;
  std::vector<PlotPoint> front;                        ///< drawn bold
  std::vector<std::pair<std::string, double>> levels;  ///< horizontal lines with labels
  std::optional<PlotPoint> marked;                     ///< circled
  bool joined = true;                                  ///< the points of a line by lines
  bool log_x = true, log_y = true;
  std::string marked_label = "recommended";
  std::vector<PlotPoint> ringed;  ///< a thin ring about each
  std::string ringed_label = "default settings";
  const char* size = "1000,680";  ///< of the vector picture
};

/// Curves on plain axes.
struct LinePlot {
  std::string title, x_label, y_label;
  std::vector<PlotLine> lines;
};

/// Cells of a map: x, y, and the number of a kind.
struct KindMap {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<std::string> kinds;  ///< legend; 0 is drawn green
  struct Cell {
    double x, y;
    std::size_t kind;
  };
  std::vector<Cell> cells;
  std::vector<std::string> y_names;  ///< at 0, 1, 2 ... instead of numbers; may be empty
  std::string curve_label;
  std::vector<PlotPoint> curve;  ///< theoretical limit
};

/// Writes path.svg and path.png (and path.gp, path.dat, from which they were drawn). Returns false where gnuplot is
/// absent or fails.
bool draw(const ScatterPlot& plot, const std::filesystem::path& path);
bool draw(const LinePlot& plot, const std::filesystem::path& path);
bool draw(const KindMap& map, const std::filesystem::path& path);

}  // namespace epafi
