#include "laws/smooth/passes/normal_pass.h"

namespace epafi {
template NormalEvaluation normal_evaluation<OverlapVolume>();
}  // namespace epafi
