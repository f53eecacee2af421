// Detection alone: gap, normal and contact points of two boxes, one of them turned.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/shapes/box.h"

int main() {
  using namespace epafi;
  const Box a(Vec3(0.5, 0.5, 0.5)), b(Vec3(0.5, 0.5, 0.5));  // half edges [m]
  // b stands on an edge: turned by 45 degrees about y, its lowest edge 0.1 m above a
  const double half_diagonal = std::sqrt(0.5);
  const Pose pose_a{Vec3(0, 0, 0), Quat(1, 0, 0, 0)};
  const Pose pose_b{Vec3(0, 0, 0.6 + half_diagonal), Quat(std::cos(M_PI / 8), 0, std::sin(M_PI / 8), 0)};
  ContactSet contacts;
  ContactSink sink(contacts);
  sink.begin(0, 1);
  collide(a, b, PairQuery{pose_a, pose_b, /*reach*/ 1.0}, sink);
  sink.end();
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3 n = contacts.normal[k], p = contacts.arm[k];
    std::printf("gap %.12f  normal (%g, %g, %g)  point (%g, %g, %g)\n", contacts.gap[k], n.x(), n.y(), n.z(), p.x(),
                p.y(), p.z());
  }
  if (contacts.size() == 0) return 1;
  const double nearest = *std::min_element(contacts.gap.begin(), contacts.gap.end());
  return std::abs(nearest - 0.1) < 1e-12 ? 0 : 1;
}
