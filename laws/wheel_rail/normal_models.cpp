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
       solve_kik_piotrowski},
      {{"stripes",
        "strips of local curvature, share of the approach by Hertz at the rigid point",
        {},
        {},
        "Ayasse, Chollet 2005"},
       solve_stripes},
      {{"analyn", "every strip from the Hertz contact of its mean curvature", {}, {}, "Sichani, Enblom, Berg 2014"},
       solve_analyn},
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
  // of the overlap that holds the region's point: another one beside it would draw the plane to where nothing touches
  std::size_t first = g.size(), last = 0;
  if (g.size() > 0) {
    first = last =
        static_cast<std::size_t>(std::clamp(-g.start / g.step + 0.5, 0.0, static_cast<double>(g.size() - 1)));
    while (first > 0 && g.gap[first - 1] < approach) --first;
    while (last + 1 < g.size() && g.gap[last + 1] < approach) ++last;
  }
  for (std::size_t k = first; k <= last && k < g.size(); ++k) {
    const double depth = (approach - g.gap[k]) / approach;
    if (depth <= 0.0) continue;
    const double one = depth * depth * std::sqrt(depth / g.curvature_x[k]);  // depth^2 over the strip's length
    w += one, wy += one * g.y(k), wa += one * source.angle_at(region, g.y(k));
  }
  if (w > 0.0) out.y = wy / w, out.angle = wa / w;
  return out;
}

}  // namespace epafi
