#include "laws/springs/spring_links.h"

namespace epafi {

void append_spring_links(const std::vector<SpringElement>& springs, const World& world, double dt,
                         std::vector<StiffLink>& links) {
  for (const SpringElement& s : springs) {
    StiffLink link;
    link.b = world.slot_of(s.body);
    link.a = s.to ? world.slot_of(*s.to) : no_slot;
    if (link.b == no_slot || (s.to && link.a == no_slot)) continue;
    const Pose near = world.pose(link.b);
    link.arm_b = near.orientation * s.attachment;
    Mat3 axes = Mat3::Identity();
    if (s.to) {
      axes = world.pose(link.a).orientation.toRotationMatrix();
      link.arm_a = world.unwrapped(link.b) + link.arm_b - world.unwrapped(link.a);
    }
    for (int i = 0; i < 3; ++i) {
      link.normal = axes.col(i);
      link.along = 0.25 * dt * dt * s.stiffness[i] + dt * s.damping[i];
      if (link.along > 0.0) links.push_back(link);
    }
  }
}

}  // namespace epafi
