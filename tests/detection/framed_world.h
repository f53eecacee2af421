/// @file framed_world.h  Bodies placed in a frame of their own, for tests that must not depend on axes and origin.
#pragma once
#include "detection/shape_store.h"
#include "engine/state/world.h"

namespace epafi::testing {

struct FramedWorld {
  ShapeStore shapes;
  World world{Columns{.rotation = true, .periodic = true}};
  Pose frame;

  /// local: in the frame. Without a mass it is fixed.
  template <class S>
  void add(const S& shape, const Pose& local, double mass = 0.0) {
    Body body;
    body.position = frame.to_world(local.position);
    body.orientation = frame.orientation * local.orientation;
    body.mass = mass;
    body.inertia = mass * Vec3::Ones();
    body.shape = shapes.add(shape).packed;
    world.add(body);
  }
};

}  // namespace epafi::testing
