/// What a body touches as one surface: walls that move as one, and a wall for all parts of a body.
#include <algorithm>
#include <span>
#include <type_traits>

#include "detection/narrow/few_points.h"
#include "detection/narrow/polyhedra/manifold.h"
#include "detection/narrow/seams.h"

namespace epafi {

namespace {

constexpr double top_cosine = 0.9987;  // sides are told apart by facing_sine

}  // namespace

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
  if (surface.size() == 1 && points_on_.size() < 2) return;
  const Group& first = groups_[surface.front()];
  const bool body_is_b = surface.size() > 1 && world.is_movable(first.b);
  const Slot body = first.of(body_is_b);
  // what a contact remembers goes on at another point
  const auto wall_of = [&](std::uint32_t k) { return groups_[k].of(groups_[k].a == body); };
  const auto join_all = [&] {
    for (const std::uint32_t k : surface)
      for (const std::uint32_t m : surface) contacts.joined.push_back({body, wall_of(k), wall_of(m)});
  };
  for (OutlineCorners& o : outlines_) o.corners.clear();
  if (!foreseen_) find_corners(world, body, Vec3::Zero(), outlines_[0]);
  if (springs_ && surface.size() == 1) find_corners(world, first.b, first.branch, outlines_[1]);
  outlines_[1].side = -1.0;
  if (surface.size() > 1 && !foreseen_) {
    join_all();
    if (parts_[body] == 0) rest_on_tops(world, contacts, surface, size);
  }
  const auto outlines = std::span(outlines_).first(springs_ ? outlines_.size() : 0);
  if (points_on_.size() > 1 && keep_few(points_on_, outlines, size, tolerance * size, contacts, hidden_)) join_all();
}

/// On level walls that are polyhedra a polyhedron rests on its own corners, as on one wall: each pair takes the normal
/// that gives the least depth, and few of its points, as if the other walls were not there.
void Seams::rest_on_tops(const World& world, ContactSet& contacts, std::span<const std::uint32_t> surface,
                         double size) {
  const Group& first = groups_[surface.front()];
  const Slot body = first.of(world.is_movable(first.b));
  for (std::size_t k = 0; k < points_on_.size() && !outlines_[0].corners.empty(); ++k) {
    find_tops(world, surface, body, points_on_[k].normal);
    if (tops_.empty()) continue;
    const Vec3 up = tops_.front().side.normal;
    const auto is_there = [&](const SurfacePoint& p) { return up.dot(p.normal) > top_cosine; };
    if (std::any_of(points_on_.begin(), points_on_.begin() + static_cast<std::ptrdiff_t>(k), is_there)) continue;
    double deepest = infinity;
    for (const SurfacePoint& p : points_on_)
      if (is_there(p)) deepest = std::min(deepest, contacts.gap[p.contact]);
    if (!stand_on_tops(contacts, body, deepest, size)) continue;
    for (const SurfacePoint& p : points_on_)
      if (is_there(p) || is_in_joint(p, contacts.gap[p.contact], size)) hidden_[p.contact] = 1;
  }
  std::erase_if(points_on_, [&](const SurfacePoint& p) { return hidden_[p.contact] != 0; });
}

void Seams::find_tops(const World& world, std::span<const std::uint32_t> surface, Slot body, const Vec3& normal) {
  tops_.clear();
  for (const std::uint32_t k : surface) {
    const Group& group = groups_[k];
    const bool wall_is_b = group.a == body;
    const Slot wall = group.of(wall_is_b);
    Top top{&group, {ShapeRef{world.shape[wall]}, world.pose(wall)}, {}};
    top.piece.pose.position = wall_is_b ? group.branch : Vec3(-group.branch);
    top.side = plane_side(shapes_, top.piece, normal);
    if (!std::isfinite(top.side.offset)) continue;
    const Top& one = tops_.empty() ? top : tops_.front();
    const Vec3 foot = -top.above(Vec3::Zero()) * top.side.normal;
    if (same_direction(top.side.normal, one.side.normal) && std::abs(one.above(foot)) <= near_of(wall, body))
      tops_.push_back(top);
  }
}

bool Seams::is_under(const Top& top, const Vec3& place, double near) const {
  return is_on(shapes_, top.piece, place - top.above(place) * top.side.normal, near);
}

const Seams::Top* Seams::top_under(const Vec3& place, double near) const {
  const auto found = std::ranges::find_if(tops_, [&](const Top& top) { return is_under(top, place, near); });
  return found == tops_.end() ? nullptr : &*found;
}

/// Where one of the tops begins below another one: what is not that deep on the tops does not meet it.
bool Seams::is_in_joint(const SurfacePoint& p, double gap, double size) const {
  const Vec3 on_wall = p.place - 0.5 * gap * p.normal;
  const auto own = std::ranges::find_if(
      tops_, [&](const Top& top) { return top.group->begin <= p.contact && p.contact < top.group->end; });
  if (own == tops_.end() || !(own->above(on_wall) < tolerance * size)) return false;
  return std::ranges::any_of(tops_,
                             [&](const Top& top) { return &top != &*own && is_under(top, on_wall, tolerance * size); });
}

/// All corners below the tops become contacts, if all are over one and none of the pairs is deeper. A corner belongs to
/// the wall a little further in: so it has gone over to the next one before the body leaves the last.
bool Seams::stand_on_tops(ContactSet& contacts, Slot body, double deepest, double size) {
  const double near = tolerance * size, further_in = 1e-3 * size;
  static thread_local std::vector<PatchPoint> points;
  static thread_local std::vector<const Top*> top_of;
  points.clear();
  top_of.assign(outlines_[0].corners.size(), nullptr);
  const Vec3& up = tops_.front().side.normal;
  double lowest = infinity;
  for (std::size_t v = 0; v < top_of.size(); ++v) {
    const Vec3 tip = outlines_[0].corners[v] - outlines_[0].sweep * up, out = tip - up.dot(tip) * up;
    if (!(tops_.front().above(tip) < reach_ + near)) continue;
    const Top* under = top_under(tip, near);
    if (!under && tops_.front().above(tip) < reach_ - near) return false;
    if (!under) continue;
    const Top* inner = top_under(tip - further_in * out.normalized(), near);
    top_of[v] = inner ? inner : under;
    const double gap = top_of[v]->above(tip);
    if (gap < reach_) points.push_back({tip - 0.5 * gap * up, gap, v});
    lowest = std::min(lowest, gap);
  }
  if (points.empty() || !(lowest <= deepest + near) || lowest < deepest - std::abs(deepest) - near) return false;
  Patch patch;
  keep_corners(points, up, size, springs_, patch);
  for (std::size_t k = 0; k < static_cast<std::size_t>(patch.count); ++k) {
    const PatchPoint& p = patch.point[k];
    const Top& top = *top_of[p.feature];
    const Group& g = *top.group;
    const auto v = static_cast<std::uint32_t>(p.feature);
    const bool of_a = g.a == body;
    const Feature name = of_a ? make_feature(FeatureKind::vertex_a, v, 0) : make_feature(FeatureKind::vertex_b, 0, v);
    contacts.append(
        g.a, g.b,
        {p.gap, of_a ? Vec3(-top.side.normal) : top.side.normal, of_a ? p.position : Vec3(p.position + g.branch),
         contacts.with_curvature ? contacts.effective_radius[g.begin] : 0.0,
         (contacts.feature[g.begin] >> 56 << 56) | name});
    hidden_.push_back(0);
  }
  return true;
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
