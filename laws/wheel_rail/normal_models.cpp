#include "laws/wheel_rail/normal_models.h"

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
      {{"half-space", "boundary elements on the whole gap", {}, {}, "Polonsky, Keer 1999; Kalker 1990"},
       solve_half_space}};
  return all;
}

}  // namespace epafi
