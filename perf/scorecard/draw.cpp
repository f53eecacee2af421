/// @file draw.cpp  Pictures of the scorecard by the drawing code of the atlas. Usage: perf_scorecard_draw PLOT.txt PATH
/// PLOT.txt, line by line: `title TEXT`, `x TEXT`, `y TEXT`, `line LABEL`, `front`, `default` (those of all engines) or
/// `ours` (our default), the last four with a row `X Y` for each point below. Writes PATH.svg and PATH.png.
#include <fstream>
#include <iostream>
#include <sstream>

#include "viz_export/report/charts.h"

namespace {

/// The list that rows below this word belong to, or null where the word begins no list.
std::vector<epafi::PlotPoint>* list_of(epafi::ScatterPlot& plot, const std::string& word, const std::string& rest) {
  if (word == "front") return &plot.front;
  if (word == "default") return &plot.ringed;
  if (word != "line") return nullptr;
  plot.lines.push_back({rest, {}, {}});
  return &plot.lines.back().points;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: perf_scorecard_draw PLOT.txt PATH\n";
    return 2;
  }
  epafi::ScatterPlot plot;
  plot.joined = false;
  plot.marked_label = "default of Epafi";
  std::vector<epafi::PlotPoint> ours;
  std::vector<epafi::PlotPoint>* points = &ours;
  std::ifstream in(argv[1]);
  for (std::string line; std::getline(in, line);) {
    const std::string word = line.substr(0, line.find(' '));
    const std::string rest = word.size() < line.size() ? line.substr(word.size() + 1) : "";
    if (word == "title") {
      plot.title = rest;
    } else if (word == "x") {
      plot.x_label = rest;
    } else if (word == "y") {
      plot.y_label = rest;
    } else if (word == "ours") {
      points = &ours;
    } else if (auto* list = list_of(plot, word, rest)) {
      points = list;
    } else {
      std::istringstream numbers(line);
      epafi::PlotPoint at{};
      numbers >> at[0] >> at[1];
      points->push_back(at);
    }
  }
  if (!ours.empty()) plot.marked = ours.front();
  return epafi::draw(plot, argv[2]) ? 0 : 1;
}
