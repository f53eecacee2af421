#include "laws/smooth/friction.h"
#include "engine/lanes/targets.h"
#include "laws/smooth/passes/tile_passes.h"

namespace epafi {

namespace {

/// Springs in fixed ratio to the normal stiffness.
struct CoulombPass {
  const TangentialCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<ContactTile<n>*>(call.tile);
    const double dt = call.dt;
    each_group<n>(t, call, &PairRow::tangential, [&](std::size_t g, const V(&numbers)[PairRow::most]) EPAFI_INLINED {
      const auto p = parameters_from<CoulombSpring::ParametersOf<V>>(numbers);
      typename ContactTile<n>::Group& c = t.group[g];
      c.stiffness = CoulombSpring::stiffness(p, c.normal_stiffness);
      c.limit = p.friction * c.grip;
      pull<n>(t, g, static_cast<const TileSpring*>(call.before), dt);
    });
    finish_pull<n>(t, dt);
    for (std::size_t g = 0; g < t.groups; ++g) settle_springs<n>(t, g, static_cast<TileSpring*>(call.now), dt);
  }
};

}  // namespace

void (*coulomb_pass())(const TangentialCall&) { return best_loop<CoulombPass, TangentialCall>(); }

}  // namespace epafi
