#include "laws/wheel_rail/normal_models.h"

#include <algorithm>
#include <cmath>

#include "laws/wheel_rail/normal/models.h"

namespace epafi {

const std::vector<NormalModel>& all_normal_models() {
  static const std::vector<NormalModel> all{
      {{"hertz", "one ellipse of the curvatures at the rigid contact point", {}, {}, "Hertz 1882"}, solve_hertz},
      {{"multi-hertz",
        "an ellipse for every region that touches, one approach for all",
        {},
        {},
        "Hertz 1882; Pascal, Sauvage 1993"},
       solve_multi_hertz},
      {{"kik-piotrowski",
        "virtual penetration at 0.55 of the approach, no iteration over the patch",
        {},
        {},
        "Kik, Piotrowski 1996"},
       solve_kik_piotrowski,
       false,
       true},
      {{"stripes",
        "strips of local curvature, share of the approach by Hertz at the rigid point",
        {},
        {},
        "Ayasse, Chollet 2005"},
       solve_stripes,
       false,
       true},
      {{"analyn", "every strip from the Hertz contact of its mean curvature", {}, {}, "Sichani, Enblom, Berg 2014"},
       solve_analyn,
       false,
       true},
      {{"semi-hertz",
        "strips: Hertz along the track, exact influence of strip on strip across it",
        {},
        {},
        "Kik, Piotrowski 1996; Ayasse, Chollet 2005"},
       solve_semi_hertz,
       true},
      {{"half-space", "boundary elements on the whole gap", {}, {}, "Polonsky, Keer 1999; Kalker 1990"},
       solve_half_space,
       true},
      {{"fem", "hexahedra, Lagrange multipliers, node-to-surface", {}, {}, "Wriggers 2006"}, solve_fem, true},
      {{"fem-penalty", "hexahedra, penalty, node-to-surface", {}, {}, "Wriggers 2006"}, solve_fem_penalty, true},
      {{"fem-augmented", "hexahedra, augmented Lagrangian, node-to-surface", {}, {}, "Simo, Laursen 1992"},
       solve_fem_augmented,
       true},
      {{"fem-surface", "hexahedra, augmented Lagrangian, surface-to-surface", {}, {}, "Simo, Laursen 1992"},
       solve_fem_surface,
       true}};
  return all;
}

PatchPlace place_of_patch(const GapSource& source, const ContactRegion& region, double approach) {
  PatchPlace out{0.0, region.angle};
  const GapProfile& g = region.profile;
  double w = 0.0, wy = 0.0, wa = 0.0;
  const double lean = std::tan(region.point.y() < 0.0 ? -region.angle : region.angle);
  for (std::size_t k = 0; k < g.size(); ++k) {
    const double depth = (approach - g.gap[k]) / approach;
    if (depth <= 0.0) continue;
    // the rail's point at this point of the wheel: on a flank of 0.8 rad it lies 0.03 mm beside it, 1/6 of a cell
    const std::size_t before = k > 0 ? k - 1 : k, after = k + 1 < g.size() ? k + 1 : k;
    const double opening = (g.gap[after] - g.gap[before]) / (g.y(after) - g.y(before));
    const double y = g.y(k) - lean * (approach - g.gap[k]);
    // depths are along the plane's normal; along z they are steeper by `rise`; sums go over the track's width
    const double angle = source.angle_at(region, y), rise = std::cos(angle - region.angle) / std::cos(angle);
    const double along_z = depth * rise, width = (1.0 + lean * opening) / rise;
    const double one = along_z * along_z * std::sqrt(along_z / g.curvature_x[k]) * width;
    w += one;
    wy += one * y;
    wa += one * angle;
  }
  if (w > 0.0) {
    out.y = wy / w;
    out.angle = wa / w;
  }
  return out;
}

}  // namespace epafi
