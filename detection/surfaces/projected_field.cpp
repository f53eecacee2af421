#include "detection/surfaces/projected_field.h"

namespace epafi {

void project_gaps(std::span<const Vec3> nodes, std::span<const Triangle> first, std::span<const Triangle> second,
                  double band, GapField& field) {
  const ProjectionSurface on_first(nodes, first), on_second(nodes, second);
  field.gap.clear();
  for (std::size_t iy = 0; iy < field.ny; ++iy)
    for (std::size_t ix = 0; ix < field.nx; ++ix) {
      const Vec3 x = field.origin + field.x(ix) * field.frame.tangent1 + field.y(iy) * field.frame.tangent2;
      const auto one = on_first.project(nodes, x, band), other = on_second.project(nodes, x, band);
      const bool both = one.triangle != NearestOnSurface::none && other.triangle != NearestOnSurface::none;
      field.gap.push_back(both ? one.gap + other.gap : std::numeric_limits<double>::quiet_NaN());
    }
}

}  // namespace epafi
