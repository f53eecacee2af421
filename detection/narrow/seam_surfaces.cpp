/// What a body touches as one surface: walls that move as one, and a wall for all parts of a body.
#include <algorithm>
#include <span>
#include <type_traits>

#include "detection/narrow/few_points.h"
#include "detection/narrow/seams.h"

namespace epafi {

/// Two walls that move as one are one surface.
void Seams::join(const World& world, const Candidate& c, const Other& other) {
  const bool as_one = !world.is_movable(c.wall) && !world.is_movable(other.wall) &&
                      world.velocity[c.wall] == world.velocity[other.wall] &&
                      (!world.rotates() || world.angular_velocity[c.wall] == world.angular_velocity[other.wall]);
  if (!as_one) return;
  const std::uint32_t p = surface_of(static_cast<std::uint32_t>(c.group - groups_.data())),
                      q = surface_of(static_cast<std::uint32_t>(other.held - groups_.data()));
  surface_[std::max(p, q)] = std::min(p, q);
}

std::uint32_t Seams::surface_of(std::uint32_t group) const {
  while (surface_[group] != group) group = surface_[group];
  return group;
}

/// Contacts of one surface come in the order of the ids of its walls: slots change.
void Seams::rest_on_few(const World& world, ContactSet& contacts) {
  ordered_.clear();
  for (std::uint32_t k = 0; k < groups_.size(); ++k) {
    const std::uint32_t surface = surface_of(k);
    if (surface != k)
      ordered_.insert(ordered_.end(), {surface, k});
    else if (parts_[groups_[k].a] != 0 || parts_[groups_[k].b] != 0)
      ordered_.push_back(k);
  }
  const auto key = [&](std::uint32_t k) {
    return std::tuple(surface_of(k), world.id[groups_[k].of(world.is_movable(groups_[k].a))], k);
  };
  std::ranges::sort(ordered_, {}, key);
  ordered_.erase(std::unique(ordered_.begin(), ordered_.end()), ordered_.end());
  for (std::size_t begin = 0, end = 0; begin < ordered_.size(); begin = end) {
    while (end < ordered_.size() && surface_of(ordered_[end]) == surface_of(ordered_[begin])) ++end;
    rest_on_few(world, contacts, std::span(ordered_).subspan(begin, end - begin));
  }
}

/// Of two bodies either is the wall of the other; else it is what does not move freely.
void Seams::rest_on_few(const World& world, ContactSet& contacts, std::span<const std::uint32_t> surface) {
  points_on_.clear();
  double size = infinity;
  for (const std::uint32_t k : surface) {
    const Group& group = groups_[k];
    const bool wall_is_b = surface.size() == 1 || world.is_movable(group.a);
    for (std::size_t i = group.begin; i < group.end; ++i)
      if (hidden_[i] == 0)
        points_on_.push_back({i, wall_is_b ? contacts.arm[i] : Vec3(contacts.arm[i] - group.branch),
                              wall_is_b ? Vec3(-contacts.normal[i]) : contacts.normal[i]});
    size = std::min({size, radius_[group.a], radius_[group.b]});
  }
  if (points_on_.size() < 2) return;
  const Group& first = groups_[surface.front()];
  const bool body_is_b = surface.size() > 1 && world.is_movable(first.b);
  for (OutlineCorners& o : outlines_) o.corners.clear();
  if (springs_) find_corners(world, first.of(body_is_b), Vec3::Zero(), outlines_[0]);
  if (springs_ && surface.size() == 1) find_corners(world, first.b, first.branch, outlines_[1]);
  outlines_[1].side = -1.0;
  if (!keep_few(points_on_, outlines_, size, tolerance * size, contacts, hidden_)) return;
  // what a contact remembers goes on at another point
  const Slot body = first.of(body_is_b);
  const auto wall_of = [&](std::uint32_t k) { return groups_[k].of(groups_[k].a == body); };
  for (const std::uint32_t k : surface)
    for (const std::uint32_t m : surface) contacts.joined.push_back({body, wall_of(k), wall_of(m)});
}

/// Of bodies with flat faces; centre: of the body from that of the points.
void Seams::find_corners(const World& world, Slot body, const Vec3& centre, OutlineCorners& out) const {
  const Mat3 turn = world.pose(body).orientation.toRotationMatrix();
  const auto take = [&](std::span<const Vec3> corners, double sweep) {
    out.sweep = sweep;
    for (const Vec3& corner : corners) out.corners.push_back(centre + turn * corner);
  };
  shapes_.with(ShapeRef{world.shape[body]}, [&]<class S>(const S& s) {
    if constexpr (PolyhedralShape<S>) take(s.view().vertices, s.rounding());
    if constexpr (std::is_same_v<S, SolidParts>) take(s.outline.vertices, 0.0);
  });
}

}  // namespace epafi
