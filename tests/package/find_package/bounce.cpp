// A program that uses the installed library: the scene of its first argument, 100 steps, the hash.
#include <epafi/epafi.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  auto assembly = epafi::load(argv[1]);
  for (int k = 0; k < 100; ++k)
    if (assembly->simulation->advance()) return 1;
  std::puts(epafi::state_hash(assembly->simulation->world).c_str());
}
