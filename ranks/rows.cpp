#include "ranks/rows.h"

#include <algorithm>

#include "ranks/communicator.h"

namespace epafi {

ContactRow row_of(const ContactSet& c, std::size_t k, const World& world, bool own) {
  ContactRow row{static_cast<std::uint32_t>(world.id[c.a[k]]),
                 static_cast<std::uint32_t>(world.id[c.b[k]]),
                 own ? 1u : 0u,
                 c.feature[k],
                 c.gap[k],
                 c.effective_radius.empty() ? 0.0 : c.effective_radius[k],
                 c.area.empty() ? 0.0 : c.area[k],
                 {},
                 {},
                 {},
                 {}};
  const auto copy = [k](const std::vector<Vec3>& from, double* to) {
    if (k < from.size()) std::copy_n(from[k].data(), 3, to);
  };
  copy(c.normal, row.normal);
  copy(c.arm, row.arm);
  copy(c.force, row.force);
  copy(c.moment, row.moment);
  return row;
}

void put_row(ContactSet& set, std::size_t k, const ContactRow& row, const World& world) {
  const auto vector = [](const double* x) { return Vec3(x[0], x[1], x[2]); };
  const ContactPoint point{row.gap, vector(row.normal), vector(row.arm), row.radius, row.feature, row.area};
  set.put(k, world.slot_of(static_cast<BodyId>(row.a)), world.slot_of(static_cast<BodyId>(row.b)), point,
          vector(row.force), vector(row.moment));
}

bool tells_of(const World& world, Slot a, Slot b) {
  if (world.owner[a] == World::everywhere && world.owner[b] == World::everywhere) return rank_number() == 0;
  return world.counts(a, b);
}

}  // namespace epafi
