// A scene written by the program instead of by hand: a column of n boxes, solved twice, no file on the disk.
#include <epafi/epafi.h>

#include <cstdio>
#include <string>

namespace {

std::string column(int boxes) {
  std::string scene = R"(
    run = { duration = 0.5, time_step = 0.004 }
    world = { gravity = [0, 0, -9.81] }
    material.stone = { density = 1000.0 }
    contact = { method = "nonsmooth", restitution = 0.0, friction = 0.5 }
    [[body]]
    name = "floor"
    shape = { half_space = { normal = [0, 0, 1] } }
    material = "stone"
    fixed = true
  )";
  for (int k = 0; k < boxes; ++k)
    scene += "[[body]]\nshape = { box = { size = [1, 1, 1] } }\nmaterial = \"stone\"\nposition = [0, 0, " +
             std::to_string(k + 0.5) + "]\n";
  return scene;
}

}  // namespace

int main() {
  const int boxes = 20;
  double sag[2];
  const char* solvers[] = {"pgs", "newton"};
  for (int i = 0; i < 2; ++i) {
    auto assembly = epafi::load_text(
        column(boxes), {"contact.nonsmooth.iterations=100", "contact.nonsmooth.solver=" + std::string(solvers[i])});
    epafi::Simulation& simulation = *assembly->simulation;
    while (simulation.steps() < assembly->steps)
      if (simulation.advance()) return 4;
    sag[i] = boxes - 0.5 - simulation.world.position[simulation.world.slot_of(epafi::BodyId(boxes))].z();
    std::printf("%-7s top box sinks by %.3g m\n", solvers[i], sag[i]);
  }
  return sag[1] < 1e-3 && sag[1] < sag[0] ? 0 : 1;
}
