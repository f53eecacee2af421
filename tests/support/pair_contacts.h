/// @file pair_contacts.h  The contacts of two bodies by themselves.
#pragma once
#include <algorithm>

#include "detection/narrow/pairs/convex_pairs.h"

namespace epafi::support {

inline Quat about(const Vec3& axis, double angle) { return Quat(Eigen::AngleAxisd(angle, axis.normalized())); }

template <class A, class B>
ContactSet contacts(const A& a, const Pose& pa, const B& b, const Pose& pb, double reach = 0.0) {
  ContactSet set;
  ContactSink sink(set);
  sink.begin(0, 1);
  collide(a, b, PairQuery{pa, pb, reach, false, nullptr}, sink);
  sink.end();
  return set;
}

inline double deepest(const ContactSet& c) { return *std::min_element(c.gap.begin(), c.gap.end()); }

template <class A, class B>
MinkowskiDifference difference(const A& a, const Pose& pa, const B& b, const Pose& pb) {
  return {ConvexRef::to(a), ConvexRef::to(b), pa, pb};
}

}  // namespace epafi::support
