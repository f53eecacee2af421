// Detection alone: two unit cubes whose faces are 0.5 apart.
#include <cstdio>

#include "detection/narrow/gjk.h"
#include "detection/shapes/box.h"

int main() {
  const epafi::Box box(epafi::Vec3(0.5, 0.5, 0.5));
  std::printf("bounding radius %.17g\n", box.bounding_radius());
  return box.bounding_radius() > 0.86 ? 0 : 1;
}
