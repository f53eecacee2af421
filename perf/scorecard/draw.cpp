/// @file draw.cpp  Pictures of the scorecard by the drawing code of the atlas. Usage: perf_scorecard_draw PLOT.txt PATH
/// PLOT.txt: `title ...`, `x ...`, `y ...`, then `line LABEL` with rows `X Y` below it, `front` with rows, `end`.
/// Writes PATH.svg and PATH.png.
#include <fstream>
#include <iostream>
#include <sstream>

#include "viz_export/charts.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: perf_scorecard_draw PLOT.txt PATH\n";
    return 2;
  }
  epafi::ScatterPlot plot;
  plot.joined = false;
  std::vector<epafi::PlotPoint>* points = nullptr;
  std::ifstream in(argv[1]);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word, rest;
    words >> word;
    std::getline(words >> std::ws, rest);
    if (word == "title") {
      plot.title = rest;
    } else if (word == "x") {
      plot.x_label = rest;
    } else if (word == "y") {
      plot.y_label = rest;
    } else if (word == "line") {
      plot.lines.push_back({rest, {}, {}});
      points = &plot.lines.back().points;
    } else if (word == "front") {
      points = &plot.front;
    } else if (word == "marked") {
      std::istringstream numbers(rest);
      epafi::PlotPoint at{};
      numbers >> at[0] >> at[1];
      plot.marked = at;
    } else if (points != nullptr) {
      std::istringstream numbers(line);
      epafi::PlotPoint at{};
      numbers >> at[0] >> at[1];
      points->push_back(at);
    }
  }
  return epafi::draw(plot, argv[2]) ? 0 : 1;
}
