#include "detection/broad/sphere_roles.h"

#include <algorithm>
#include <utility>

#include "engine/threads/parallel_order.h"

namespace epafi {

void sort_partners(Slot* partner, std::uint32_t* image, std::size_t n) {
  const auto key = [](Slot b, std::uint32_t i) { return std::pair(b, i >> 8); };
  for (std::size_t k = 1; k < n; ++k)
    for (std::size_t l = k; l > 0 && key(partner[l], image[l]) < key(partner[l - 1], image[l - 1]); --l) {
      std::swap(partner[l], partner[l - 1]);
      std::swap(image[l], image[l - 1]);
    }
}

void take_spheres(const World& world, const SphereRoles& roles, PairList& pairs) {
  const std::size_t n = world.size();
  SpherePairs& out = pairs.spheres;
  const auto slot = [](std::size_t s) { return static_cast<Slot>(s); };
  std::vector<SphereRole> role_of(n);
  parallel_for(n, [&](std::size_t s) { role_of[s] = roles.of(world, slot(s)); });
  const auto is = [&](std::size_t s, SphereRole role) { return role_of[s] == role; };
  parallel_select(
      n, [&](std::size_t s) { return is(s, SphereRole::plane); }, slot, out.planes);
  const auto takes = [&](const Pair& p) {
    const bool a = is(p.a, SphereRole::sphere), b = is(p.b, SphereRole::sphere);
    return (a && (b || is(p.b, SphereRole::plane))) || (b && is(p.a, SphereRole::plane));
  };
  const auto place_of = [&](Slot plane) {
    const auto at = std::lower_bound(out.planes.begin(), out.planes.end(), plane);
    return SpherePairs::plane | static_cast<Slot>(at - out.planes.begin());
  };
  struct Partner {
    Slot slot;
    std::uint32_t image;  // 0 with planes, which repeat in themselves
  };
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k) {
      const Pair& p = pairs.pairs[k];
      if (!takes(p)) continue;
      if (is(p.b, SphereRole::plane))
        f(p.a, Partner{place_of(p.b), 0});
      else if (is(p.a, SphereRole::plane))
        f(p.b, Partner{place_of(p.a), 0});
      else
        p.a < p.b ? f(p.a, Partner{p.b, p.image}) : f(p.b, Partner{p.a, opposite_image(p.image)});
    }
  };
  parallel_group(
      pairs.pairs.size(), n, out.first, each,
      [&](std::size_t count) {
        renew(out.partner, count);
        renew(out.image, count);
      },
      [&](std::uint32_t place, const Partner& p) {
        out.partner[place] = p.slot;
        out.image[place] = p.image;
      });
  parallel_for(n, [&](std::size_t s) {
    sort_partners(out.partner.data() + out.first[s], out.image.data() + out.first[s], out.first[s + 1] - out.first[s]);
  });
  PairColumn rest;
  parallel_select(
      pairs.pairs.size(), [&](std::size_t k) { return !takes(pairs.pairs[k]); },
      [&](std::size_t k) { return pairs.pairs[k]; }, rest);
  pairs.pairs.swap(rest);
}

}  // namespace epafi
