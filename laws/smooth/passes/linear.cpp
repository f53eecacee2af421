#include "laws/smooth/passes/normal_pass.h"

namespace epafi {
template NormalEvaluation normal_evaluation<Linear>();
}  // namespace epafi
