#include "scenes/cli/program.h"

int main(int argc, char** argv) { return epafi::program(argc, argv); }
