#include <algorithm>

#include "laws/smooth/fused/fused_model.h"

namespace epafi {

bool needs_rolling_loop(const SmoothSetup& setup) {
  const SmoothParts parts = smooth_parts(setup);
  if (parts.rolling != NoRolling::name) return true;
  return with_law(TangentialLaws{}, parts.tangential, [&](auto t) {
    using T = typename decltype(t)::type;
    if constexpr (WithDashpot<T>)
      return std::any_of(setup.materials.pairs.begin(), setup.materials.pairs.end(),
                         [](const MaterialPair& pair) { return pair.occurs && T::parameters(pair).damping > 0.0; });
    else
      return false;
  });
}

std::unique_ptr<FusedSpheres> make_fused_rolling(const SmoothSetup& setup, std::size_t material,
                                                 std::size_t block_size) {
  const SmoothParts parts = smooth_parts(setup);
  std::unique_ptr<FusedSpheres> model;
  with_lanes(parts, [&](auto n, auto t) {
    using N = typename decltype(n)::type;
    using T = typename decltype(t)::type;
    if constexpr (T::is_present) {
      if (parts.rolling == NoRolling::name)
        model = fused_model<N, T, AnyRolling>(setup, material, block_size);
      else
        with_law(RollingLaws{}, parts.rolling, [&](auto r) {
          using R = typename decltype(r)::type;
          if constexpr (R::is_present) model = fused_model<N, T, R>(setup, material, block_size);
        });
    }
  });
  return model;
}

}  // namespace epafi
