#include "laws/smooth/smooth_law.h"

#include "laws/smooth/passes/tile_passes.h"

namespace epafi {

Passes SmoothLaw::passes() const {
  const NormalEvaluation evaluation = normal();
  Passes out;
  out.law = this;
  out.one = evaluation.one;
  out.lanes = evaluation.tile;
  out.normal = out.lanes != nullptr && !locates ? out.lanes : pointwise_normal();
  out.needs = needs;
  if (needs.friction) out.tangential = friction.is_spring ? coulomb_pass() : pointwise_friction();
  if (needs.damps_slip()) out.rolling = rolling_pass();
  return out;
}

std::string without_tiles(const SmoothSetup& setup) {
  const SmoothParts parts = smooth_parts(setup);
  const auto left_out = [](const std::string& law) { return "no tiles of law '" + law + "'"; };
  if (!with_law(NormalLaws{}, parts.normal, [](auto n) { return fits_spheres<typename decltype(n)::type>; }))
    return left_out(parts.normal);
  const bool has_pass = with_law(TangentialLaws{}, parts.tangential, [](auto t) {
    using Law = typename decltype(t)::type;
    return !Law::is_present || std::same_as<Loop<Law>, CoulombSpring> || std::same_as<Loop<Law>, MindlinDeresiewicz>;
  });
  return has_pass ? "" : left_out(parts.tangential);
}

SmoothLaw smooth_law(const SmoothSetup& setup) {
  const SmoothParts parts = smooth_parts(setup);
  const MaterialTable& table = setup.materials;
  SmoothLaw law;
  law.materials = static_cast<std::uint32_t>(table.materials);
  law.rows.resize(table.pairs.size());
  law.locates = parts.locate;
  with_law(NormalLaws{}, parts.normal, [&](auto n) {
    using Law = typename decltype(n)::type;
    law.normal = normal_evaluation<Loop<Law>>;
    take_normal<Law>(table, law);
  });
  with_law(TangentialLaws{}, parts.tangential,
           [&](auto t) { take_tangential<typename decltype(t)::type>(table, law); });
  with_law(RollingLaws{}, parts.rolling, [&](auto r) { take_rolling<typename decltype(r)::type>(table, law); });
  law.damped = law.damped || law.needs.damps_slip() || law.locates;
  return law;
}

}  // namespace epafi
