#include "detection/narrow/pairs/wheel_rail_pairs.h"

#include "detection/profiles/wheelset_on_track.h"

namespace epafi {

void collide_closed(const WheelProfile& a, const RailProfile& b, const PairQuery& q, ContactSink& sink) {
  std::vector<RollingRegion> regions;
  WheelsetOnTrack(*a.wheelset, *b.track).find(q.a, q.b, q.reach, false, regions);
  for (const RollingRegion& r : regions) {
    const double curvature = r.region.curvature_x + std::max(0.0, r.region.curvature_y);
    sink.add({-r.approach, r.axes.col(2), r.point - q.a.position, q.curvature ? 2.0 / curvature : 0.0, r.name});
  }
}

}  // namespace epafi
