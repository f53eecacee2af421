/// @file stage_check.h  Checks the later stages of a scene before the first one begins.
#pragma once
#include <string>
#include <vector>

#include "scenes/assemble.h"

namespace epafi {

struct StageCheck {
  std::string text;       ///< for `epafi check`
  std::string explained;  ///< for `epafi explain`
  double steps = 0.0;     ///< at most, where the stage ends by a condition; 0: it is the first
  double outputs = 0.0;   ///< frames and snapshots
  std::vector<Problem> warnings{};
};

/// Makes every stage behind the present one ready once, with the bodies where the scene begins, and the conditions of
/// all. Throws SceneError for what would otherwise show hours later; a time step above its limit shows with the stage.
std::vector<StageCheck> check_stages(const Scene& scene);

/// The conditions of the assembly's own stage and its bounds on measures speak of components that there are.
void check_conditions(const Assembly& assembly);

/// A component of a measure that a condition asks for; throws SceneError with those that there are.
void check_component(const Assembly& assembly, const Condition& condition, const Place& place);

}  // namespace epafi
