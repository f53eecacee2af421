#include "laws/smooth/passes/normal_pass.h"

namespace epafi {
template NormalEvaluation normal_evaluation<Dmt>();
template NormalEvaluation normal_evaluation<Hertz>();
template NormalEvaluation normal_evaluation<HuntCrossley>();
template NormalEvaluation normal_evaluation<Jkr>();
template NormalEvaluation normal_evaluation<KuwabaraKono>();
template NormalEvaluation normal_evaluation<Linear>();
template NormalEvaluation normal_evaluation<OverlapVolume>();
template NormalEvaluation normal_evaluation<PowerLaw>();
template NormalEvaluation normal_evaluation<WaltonBraun>();
}  // namespace epafi
