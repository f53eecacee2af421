#include "laws/smooth/fused/fused_spheres.h"

#include "laws/smooth/fused/fused_model.h"

namespace epafi {

bool has_fused_spheres(const SmoothSetup& setup) {
  bool found = false;
  with_lanes(smooth_parts(setup), [&](auto, auto) { found = true; });
  return found;
}

std::unique_ptr<FusedSpheres> make_fused_spheres(const SmoothSetup& setup, std::size_t material,
                                                 std::size_t block_size) {
  if (needs_rolling_loop(setup)) return make_fused_rolling(setup, material, block_size);
  std::unique_ptr<FusedSpheres> model;
  with_lanes(smooth_parts(setup), [&](auto n, auto t) {
    model = fused_model<typename decltype(n)::type, typename decltype(t)::type, NoRolling>(setup, material, block_size);
  });
  return model;
}

}  // namespace epafi
