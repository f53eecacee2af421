/// @file all_laws.h  The lists of smooth law parts: include the header, add the name. A normal law with an evaluation
/// of its own also gets a line in laws/smooth/passes/normal_laws.cpp.
#pragma once
#include "laws/smooth/adhesion.h"
#include "laws/smooth/dashpot.h"
#include "laws/smooth/hertz.h"
#include "laws/smooth/hunt_crossley.h"
#include "laws/smooth/kuwabara_kono.h"
#include "laws/smooth/linear.h"
#include "laws/smooth/overlap_volume.h"
#include "laws/smooth/power_law.h"
#include "laws/smooth/rolling.h"
#include "laws/smooth/walton_braun.h"

namespace epafi {

template <class... L>
struct LawList {};

using NormalLaws =
    LawList<Linear, Hertz, HuntCrossley, HuntCrossley1975, HerbertMcWhannell, LeeWang, LankaraniNikravesh, Flores,
            Gonthier, PowerLaw, KuwabaraKono, WaltonBraun, Dmt, Jkr, OverlapVolume>;
using TangentialLaws = LawList<NoFriction, CoulombSpring, SpringDashpot, Mindlin, MindlinDashpot, MindlinDeresiewicz>;
using RollingLaws = LawList<NoRolling, RollingSpring, RollingConstant, RollingViscous>;

}  // namespace epafi
