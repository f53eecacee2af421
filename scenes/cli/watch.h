/// @file watch.h  Follows a run in the terminal: last value and course of its energies, contacts and residual
/// (progress.csv) and of its measures (measures.csv).
#pragma once
#include <string>
#include <vector>

namespace epafi {

/// Prints once a second until the run is over (a terminal: in place, else every ten seconds); Ctrl-C ends. A run that
/// was killed is reported: exit code 4. chosen: measures that are shown; empty: all.
int command_watch(const std::string& directory, const std::vector<std::string>& chosen = {});

}  // namespace epafi
