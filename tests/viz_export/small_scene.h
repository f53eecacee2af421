/// @file small_scene.h  A world with a floor, spheres and contacts for tests of output: no physics, known numbers.
#pragma once
#include "detection/shape_store.h"
#include "engine/state/contacts.h"
#include "engine/state/world.h"

namespace epafi {

struct SmallScene {
  ShapeStore shapes;
  World world{Columns{.rotation = true}};
  ContactSet contacts;

  /// Sphere k has radius 0.1 + 0.01 k, mass k + 1, and rests at (k, 2k, 0.5) with velocity (1, k, -1).
  explicit SmallScene(std::size_t spheres) {
    Body floor;
    floor.shape = shapes.add(HalfSpace{}).packed;
    floor.material = 1;
    world.add(floor);
    for (std::size_t i = 0; i < spheres; ++i) add_sphere();
    if (spheres < 2) return;
    contacts.append(0, 1, {.gap = -0.01, .normal = Vec3::UnitZ(), .arm = Vec3(0, 0, 0), .feature = 0});
    contacts.append(1, 2, {.gap = 0.02, .normal = Vec3::UnitX(), .arm = Vec3(0.1, 0, 0), .feature = 0});  // apart
    contacts.append(1, 2, {.gap = -0.03, .normal = Vec3::UnitX(), .arm = Vec3(0.1, 0, 0), .feature = 1});
    contacts.force = {Vec3(0, 0, -7), Vec3::Zero(), Vec3(-3, 4, 0)};
  }

  void add_sphere() {
    const double k = static_cast<double>(world.ids_given()) - 1;
    const Sphere sphere{0.1 + 0.01 * k};
    Body body;
    body.shape = shapes.add(sphere).packed;
    body.position = {k, 2 * k, 0.5};
    body.velocity = {1, k, -1};
    body.angular_velocity = {0, 0, k};
    body.mass = k + 1;
    body.inertia = Vec3::Constant(0.5);
    world.add(body);
  }
  /// Other places, as after a step.
  void move(double by) {
    for (Slot s = 1; s < world.size(); ++s) world.position[s] += Vec3(by, 0, 0);
    world.time += by;
  }
};

}  // namespace epafi
