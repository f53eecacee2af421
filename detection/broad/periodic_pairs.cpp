#include "detection/broad/periodic_pairs.h"

#include <algorithm>

#include "detection/broad/fat_bodies.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {

struct FatRegion {
  Aabb box;
  FatRegion& operator+=(const FatRegion& o) {
    box.include(o.box);
    return *this;
  }
};

/// Selects one of two opposite directions.
bool is_first(int x, int y, int z) { return x != 0 ? x > 0 : y != 0 ? y > 0 : z > 0; }

/// f(x, y, z) of all images of a box that meet the region.
template <class F>
void each_image(const PeriodicCell& cell, const Aabb& box, const Aabb& region, const F& f) {
  std::array<int, 3> from{}, to{};
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (!cell.repeats[axis]) continue;
    if (box.max[k] - cell.size[k] >= region.min[k]) from[axis] = -1;
    if (box.min[k] + cell.size[k] <= region.max[k]) to[axis] = 1;
  }
  if (from == to) return;
  for (int x = from[0]; x <= to[0]; ++x)
    for (int y = from[1]; y <= to[1]; ++y)
      for (int z = from[2]; z <= to[2]; ++z)
        if (x != 0 || y != 0 || z != 0) f(x, y, z);
}

}  // namespace

/// Behind the bodies, whose fat boxes are known.
void FatBodies::add_images(const World& world) {
  const PeriodicCell& cell = *world.cell;
  const std::size_t n = bodies();
  const auto has_images = [&](std::size_t i) {
    return !is_half_space(i) && position(i).allFinite() && half_of(i) >= 0.0;
  };
  const Aabb region =
      block_sum<FatRegion>(n, [&](std::size_t i) { return has_images(i) ? FatRegion{box(i)} : FatRegion{}; }).box;
  constexpr std::size_t block = 1024;
  auto& parts = block_results<std::vector<CellImage>>((n + block - 1) / block, {});
  parallel_blocks(n, block, [&](std::size_t begin, std::size_t end, std::size_t b) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!has_images(i)) continue;
      each_image(cell, box(i), region, [&](int x, int y, int z) {
        if (!immovable[i] && !is_first(x, y, z)) return;
        parts[b].push_back({static_cast<Slot>(i), static_cast<std::int8_t>(x), static_cast<std::int8_t>(y),
                            static_cast<std::int8_t>(z)});
      });
    }
  });
  for (const auto& part : parts) images.insert(images.end(), part.begin(), part.end());
  const std::size_t all = size();
  ball.resize(all);
  id.resize(all);
  type.resize(all);
  immovable.resize(all);
  if (!boxes.empty()) {
    boxes.resize(all);
    half.resize(all);
  }
  parallel_for(images.size(), [&](std::size_t k) {
    const CellImage& image = images[k];
    const std::size_t at = n + k;
    const Vec3 shift = cell.shift(image_code(image.step()));
    const double rounded = 0x1p-50 * (shift.cwiseAbs() + position(image.of).cwiseAbs()).maxCoeff();
    const Ball& b = ball[image.of];
    ball[at] = {b.x + shift.x(), b.y + shift.y(), b.z + shift.z(), b.r + rounded};
    id[at] = static_cast<std::uint32_t>(world.ids_given() + k);
    type[at] = type[image.of];
    immovable[at] = 1;
    if (boxes.empty()) return;
    const Aabb& box = boxes[image.of];
    boxes[at] = Aabb{box.min + shift, box.max + shift}.fattened(rounded);
    half[at] = half[image.of] + 2.0 * rounded;
  });
  for (std::size_t k = 0; k < images.size(); ++k) {
    const bool is_apart = std::ranges::binary_search(apart, images[k].of);
    (is_apart ? apart : ordinary).push_back(static_cast<Slot>(n + k));
    if (is_apart) plane.emplace_back();
  }
}

void name_images(const World& world, const std::vector<CellImage>& images, const PairColumn& found, PairColumn& pairs) {
  const std::size_t n = world.size();
  const auto named = [&](const Pair& p) {
    if (p.a < n && p.b < n) {
      const std::uint32_t key = image_code(world.wraps[p.a] - world.wraps[p.b]);
      return Pair{p.a, p.b, key << 8};
    }
    const CellImage& image = images[(p.a < n ? p.b : p.a) - n];  // an image never meets an image
    const Slot real = p.a < n ? p.a : p.b;
    const bool in_order = world.id[real] < world.id[image.of];
    const Slot a = in_order ? real : image.of, b = in_order ? image.of : real;
    const Wraps step = in_order ? image.step() : Wraps(-image.step());
    return Pair{a, b, image_code(step) | image_code(step + world.wraps[a] - world.wraps[b]) << 8};
  };
  std::vector<std::uint32_t> first;
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k) {
      const Pair p = named(found[k]);
      f(p.a, p);
    }
  };
  parallel_group(
      found.size(), n, first, each, [&](std::size_t count) { renew(pairs, count); },
      [&](std::uint32_t place, const Pair& p) { pairs[place] = p; });
  const auto before = [](const Pair& p, const Pair& q) { return p.b != q.b ? p.b < q.b : p.image >> 8 < q.image >> 8; };
  parallel_for(n, [&](std::size_t s) { std::sort(pairs.begin() + first[s], pairs.begin() + first[s + 1], before); });
}

}  // namespace epafi
