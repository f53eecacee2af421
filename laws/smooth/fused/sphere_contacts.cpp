#include "laws/smooth/fused/sphere_contacts.h"

#include <tuple>

#include "engine/parallel_order.h"

namespace epafi {

namespace {
constexpr std::uint32_t no_block = 0xffffffffu;  ///< a contact of others
constexpr std::size_t others_at_once = 1024;

struct Key {
  Slot a, b;
  Feature feature;
  bool turned;  ///< A is the second body
};

Key key_of(const World& world, const SphereContacts& all, const SphereContact& c) {
  const Slot first = all.first(c), second = all.second(c);
  const std::uint32_t image = all.image(c);
  if (world.id[first] < world.id[second]) return {first, second, Feature{image} << 56, false};
  return {second, first, Feature{opposite_image(image << 8) >> 8} << 56, true};
}
}  // namespace

std::uint32_t SphereContacts::image(const SphereContact& c) const {
  if (!world_.cell) return 0;
  // that of a plane follows the cells the sphere has passed: it is with the plane itself
  return c.plane >= 0 ? image_code(world_.wraps[first(c)] - world_.wraps[second(c)])
                      : blocks_.blocks()[c.block].images[c.pair].key;
}

/// From the first body to the second, or from the plane to the first one [m].
Vec3 SphereContacts::branch(const SphereContact& c) const {
  if (c.plane >= 0) return world_.position[first(c)] - plane(c).point;
  return world_.branch(first(c), second(c), Feature{image(c)} << 56);
}

double SphereContacts::gap(const SphereContact& c) const {
  const Vec3 d = branch(c);
  if (c.plane >= 0) return plane(c).normal.dot(d) - radius(first(c));
  return d.norm() - (radius(first(c)) + radius(second(c)));
}

ContactPoint SphereContacts::point(const SphereContact& c) const {
  const double radius_a = radius(first(c));
  ContactPoint p;
  p.gap = gap(c);
  if (c.plane >= 0) {
    p.normal = -plane(c).normal;
    p.effective_radius = radius_a, p.arm = radius_a * p.normal;
    return p;
  }
  const Vec3 d = branch(c);
  const double radius_b = radius(second(c)), distance = d.norm(), sum = radius_a + radius_b;
  p.normal = distance > 0.0 ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
  p.effective_radius = radius_a * radius_b / sum, p.arm = radius_a / sum * distance * p.normal;
  return p;
}

/// Items by A, those of one A by (b, feature).
void SpherePublisher::order(const World& world, const SphereBlocks& blocks, const ContactSet& others) {
  const SphereContacts all(world, blocks);
  const std::size_t count = blocks.blocks().size();
  const auto each = [&](std::size_t from, std::size_t to, const auto& f) {
    for (std::size_t i = from; i < std::min(to, count); ++i)
      all.each(static_cast<std::uint32_t>(i), [&](const SphereContact& c) {
        const Key key = key_of(world, all, c);
        f(key.a, Item{key.feature, key.b, c});
      });
    const auto place = [&](std::size_t i) { return i <= count ? 0 : (i - count) * others_at_once; };
    for (std::size_t k = place(from); k < std::min(place(to), others.size()); ++k)
      f(others.a[k], Item{others.feature[k], others.b[k], {no_block, static_cast<std::uint32_t>(k), 0, -1}});
  };
  const std::size_t parts = count + (others.size() + others_at_once - 1) / others_at_once;
  parallel_group(
      parts, world.size(), begin_, each, [&](std::size_t size) { renew(items_, size); },
      [&](std::size_t at, const Item& item) { items_[at] = item; }, 8);
  parallel_for(
      world.size(),
      [&](std::size_t a) {
        std::sort(items_.begin() + begin_[a], items_.begin() + begin_[a + 1], [](const Item& p, const Item& q) {
          return std::tuple(p.b, p.feature) < std::tuple(q.b, q.feature);
        });
      },
      256);
}

void SpherePublisher::add(const World& world, const SphereBlocks& blocks, const LoadOf& load, ContactSet& contacts) {
  ContactSet others = contacts;
  others.force.resize(others.size(), Vec3::Zero());  // nobody may have evaluated them yet
  others.moment.resize(others.with_moment ? others.size() : 0, Vec3::Zero());
  order(world, blocks, others);
  contacts.renew(items_.size());
  const SphereContacts all(world, blocks);
  parallel_for(
      items_.size(),
      [&](std::size_t at) {
        const SphereContact& c = items_[at].contact;
        if (c.block == no_block) return contacts.put(at, others, c.pair);
        const Key key = key_of(world, all, c);
        ContactPoint p = all.point(c);
        SphereLoad on_a = load(c, p.normal);
        p.feature = key.feature;
        if (key.turned) {
          p.arm -= world.branch(all.first(c), all.second(c), Feature{all.image(c)} << 56), p.normal = -p.normal;
          on_a = {-on_a.force, -on_a.moment};
        }
        contacts.put(at, key.a, key.b, p, on_a.force, on_a.moment);
      },
      256);
}

}  // namespace epafi
