/// @file program.h  The program, whoever starts it: alone (start.cpp) or as one of several processes (start_ranks.cpp).
#pragma once

namespace epafi {

/// Returns the exit code.
int program(int argc, char** argv);

}  // namespace epafi
