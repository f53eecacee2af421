#include "detection/narrow/gjk/gjk.h"

#include "detection/narrow/gjk/gjk_loop.h"

namespace epafi {

Vec3 closest_to_origin(Simplex& s, bool& contains_origin) { return gjk_detail::reduce_to_closest(s, contains_origin); }

GjkResult gjk(const MinkowskiDifference& difference, const GjkOptions& options) {
  return gjk_detail::run(difference, options);
}

}  // namespace epafi
