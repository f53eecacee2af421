/// @file watch.h  Follows a run in the terminal: last value and course of each of its measures, from measures.csv.
#pragma once
#include <string>

namespace epafi {

/// Prints once a second until the run is over (a terminal: in place, else a line per ten seconds); Ctrl-C ends.
int command_watch(const std::string& directory);

}  // namespace epafi
