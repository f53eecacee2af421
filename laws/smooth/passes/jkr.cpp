#include "laws/smooth/passes/normal_pass.h"

namespace epafi {
template NormalEvaluation normal_evaluation<Jkr>();
}  // namespace epafi
