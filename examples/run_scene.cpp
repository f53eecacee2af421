// A scene file, a number of steps, the state hash: the same as `epafi run SCENE --steps N` prints.
//   ./run_scene scene.toml 100
#include <epafi/epafi.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::puts("usage: run_scene SCENE.toml [steps]");
    return 2;
  }
  const int steps = argc > 2 ? std::atoi(argv[2]) : 100;
  try {
    auto assembly = epafi::load(argv[1]);
    for (int k = 0; k < steps; ++k)
      if (const auto failure = assembly->simulation->advance()) {
        std::puts(failure->text.c_str());
        return 4;
      }
    std::puts(epafi::state_hash(assembly->simulation->world).c_str());
  } catch (const epafi::SceneError& error) {
    std::puts(error.what());  // every problem of the file, with line and column
    return 2;
  }
}
