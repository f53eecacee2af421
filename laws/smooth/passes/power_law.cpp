#include "laws/smooth/passes/normal_pass.h"

namespace epafi {
template NormalEvaluation normal_evaluation<PowerLaw>();
}  // namespace epafi
