/// What a body touches as one surface: fixed and driven walls, and a wall for all parts of a body.
#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "detection/narrow/few_points.h"
#include "detection/narrow/mesh/mesh_contact.h"
#include "detection/narrow/pairs/pair_table.h"
#include "detection/narrow/seams.h"

namespace epafi {

namespace {

constexpr double top_cosine = 0.9987;  // sides are told apart by facing_sine

/// Contact points lie half way between the surfaces.
Vec3 on_wall(const SurfacePoint& p, double gap) { return p.place - 0.5 * gap * p.normal; }

/// The name that a point has where the two bodies are exchanged.
Feature exchanged_feature(Feature f) {
  FeatureKind kind = feature_kind(f);
  if (kind == FeatureKind::vertex_a || kind == FeatureKind::vertex_b)
    kind = kind == FeatureKind::vertex_a ? FeatureKind::vertex_b : FeatureKind::vertex_a;
  return (f >> 48 << 48) | make_feature(kind, feature_vertex_b(f), feature_vertex_a(f));
}

/// The name that a body's point on a plate has on a mesh.
Feature feature_on_mesh(Feature f) { return (f >> 48 << 48) | mesh_feature(0, local_name(f)); }

}  // namespace

void Seams::join(const Group& first, const Group& second) {
  const std::uint32_t p = surface_of(static_cast<std::uint32_t>(&first - groups_.data())),
                      q = surface_of(static_cast<std::uint32_t>(&second - groups_.data()));
  surface_[std::max(p, q)] = std::min(p, q);
}

std::uint32_t Seams::surface_of(std::uint32_t group) const {
  while (surface_[group] != group) group = surface_[group];
  return group;
}

/// Contact i of the group as the body sees it.
SurfacePoint Seams::seen(const ContactSet& contacts, std::size_t i, const Group& group, bool wall_is_b) {
  const Vec3 &arm = contacts.arm[i], &normal = contacts.normal[i];
  return {i, wall_is_b ? arm : Vec3(arm - group.branch), wall_is_b ? Vec3(-normal) : normal};
}

/// Level walls are one surface to a body that is on both, wherever it touches them. A ball does that at one place.
void Seams::join_level(const World& world, const ContactSet& contacts) {
  for (std::uint32_t k = 0; k < groups_.size(); ++k)
    for (const bool body_is_b : {false, true}) {
      const Slot body = groups_[k].of(body_is_b);
      if ((flat_[body] == 0 && convex_[body] == 0) || !world.is_movable(body) ||
          world.is_movable(groups_[k].of(!body_is_b)))
        continue;
      for (const std::uint32_t m : of_body_.at(body)) {
        if (m >= k) break;
        if (world.is_movable(groups_[m].of(groups_[m].a == body))) continue;
        if (surface_of(k) != surface_of(m) && are_level(world, contacts, k, m, body)) join(groups_[k], groups_[m]);
      }
    }
}

/// Either wall may have the contact that shows the plane: near its edge the other one's own may be that of its side.
bool Seams::are_level(const World& world, const ContactSet& contacts, std::uint32_t k, std::uint32_t m, Slot body) {
  for (const std::uint32_t shown : {k, m}) {
    const Group& group = groups_[shown];
    for (std::size_t i = group.begin; i < group.end; ++i) {
      if (i > group.begin && same_direction(contacts.normal[i], contacts.normal[i - 1])) continue;
      const SurfacePoint p = seen(contacts, i, group, group.a == body);
      find_tops(world, std::array{shown, shown == k ? m : k}, body, p.normal, on_wall(p, contacts.gap[i]));
      if (tops_.size() == 2) return true;
    }
  }
  return false;
}

/// Contacts of one surface come in the order of the ids of its walls: slots change.
void Seams::rest_on_few(const World& world, ContactSet& contacts) {
  if (joins_) join_level(world, contacts);
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

/// Of two free bodies the second is the wall; else the fixed or driven one is.
void Seams::rest_on_few(const World& world, ContactSet& contacts, std::span<const std::uint32_t> surface) {
  points_on_.clear();
  double size = infinity;
  for (const std::uint32_t k : surface) {
    const Group& group = groups_[k];
    const bool wall_is_b = world.is_movable(group.a);
    for (std::size_t i = group.begin; i < group.end; ++i)
      if (hidden_[i] == 0) points_on_.push_back(seen(contacts, i, group, wall_is_b));
    size = std::min({size, radius_[group.a], radius_[group.b]});
  }
  if (surface.size() == 1 && points_on_.size() < 2) return;
  const Group& first = groups_[surface.front()];
  const bool body_is_b = !world.is_movable(first.a);
  const Slot body = first.of(body_is_b), wall = first.of(!body_is_b);
  // the memory of a contact continues at another point
  const auto wall_of = [&](std::uint32_t k) { return groups_[k].of(groups_[k].a == body); };
  const auto join_all = [&] {
    for (const std::uint32_t k : surface)
      for (const std::uint32_t m : surface) contacts.joined.push_back({body, wall_of(k), wall_of(m)});
  };
  for (OutlineCorners& o : outlines_) o.corners.clear();
  if (!predicted_) find_corners(world, body, Vec3::Zero(), outlines_[0]);
  if (springs_ && surface.size() == 1)
    find_corners(world, wall, body_is_b ? Vec3(-first.branch) : first.branch, outlines_[1]);
  outlines_[1].side = -1.0;
  if (!predicted_ && (surface.size() > 1 || (parts_[wall] != 0 && !world.is_movable(wall)))) {
    join_all();
    rest_on_tops(world, contacts, surface, size);
  }
  const auto outlines = std::span(outlines_).first(springs_ ? outlines_.size() : 0);
  if (points_on_.size() > 1 && keep_few(points_on_, outlines, size, tolerance * size, contacts, hidden_)) join_all();
}

/// On level walls a body has the contacts with one plate. Single pairs would have the normal of least depth, and points
/// at the ends of each wall, as if the other walls did not exist.
void Seams::rest_on_tops(const World& world, ContactSet& contacts, std::span<const std::uint32_t> surface,
                         double size) {
  const Group& first = groups_[surface.front()];
  const Slot body = first.of(!world.is_movable(first.a));
  if (flat_[body] == 0 && convex_[body] == 0) return;
  const std::size_t before = points_on_.size();
  // the plane of most walls first: what others have in the joints beneath it is hidden
  for (std::size_t most = surface.size(); most > 0; --most)
    for (std::size_t k = 0; k < before; ++k) {
      const SurfacePoint shown = points_on_[k];
      if (hidden_[shown.contact] != 0) continue;
      find_tops(world, surface, body, shown.normal, on_wall(shown, contacts.gap[shown.contact]));
      if (tops_.size() != most) continue;
      const Vec3 up = tops_.front().side.normal;
      const auto is_there = [&](const SurfacePoint& p) { return up.dot(p.normal) > top_cosine; };
      if (std::any_of(points_on_.begin(), points_on_.begin() + static_cast<std::ptrdiff_t>(k), is_there)) continue;
      double deepest = infinity;
      for (const SurfacePoint& p : points_on_)
        if (is_there(p)) deepest = std::min(deepest, contacts.gap[p.contact]);
      if (!stand_on_tops(world, contacts, body, deepest, size)) continue;
      for (const SurfacePoint& p : std::span(points_on_).first(before))
        if (is_there(p) || is_in_joint(p, contacts.gap[p.contact], size)) hidden_[p.contact] = 1;
    }
  std::erase_if(points_on_, [&](const SurfacePoint& p) { return hidden_[p.contact] != 0; });
}

/// on_wall: a place in the plane.
void Seams::find_tops(const World& world, std::span<const std::uint32_t> surface, Slot body, const Vec3& normal,
                      const Vec3& on_wall) {
  tops_.clear();
  for (const std::uint32_t k : surface) {
    const Group& group = groups_[k];
    const bool wall_is_b = group.a == body;
    const Slot wall = group.of(wall_is_b);
    Top top{&group, {ShapeRef{world.shape[wall]}, world.pose(wall)}, {}};
    top.piece.pose.position = wall_is_b ? group.branch : Vec3(-group.branch);
    top.side = plane_side(shapes_, top.piece, normal, on_wall, Vec3::Zero(), radius_[body]);
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

/// Depth at which one of the tops begins below another; bodies less deep do not reach it.
bool Seams::is_in_joint(const SurfacePoint& p, double gap, double size) const {
  const Vec3 at = on_wall(p, gap);
  const auto own = std::ranges::find_if(
      tops_, [&](const Top& top) { return top.group->begin <= p.contact && p.contact < top.group->end; });
  if (own == tops_.end() || !(own->above(at) < tolerance * size)) return false;
  return std::ranges::any_of(tops_,
                             [&](const Top& top) { return &top != &*own && is_under(top, at, tolerance * size); });
}

/// Replaces the contacts by those with a plate at the tops, if all are over one of them and none of the pairs is
/// deeper. A point belongs to the wall slightly further in, so that it has moved to the next wall before the body
/// leaves the last.
bool Seams::stand_on_tops(const World& world, ContactSet& contacts, Slot body, double deepest, double size) {
  const double near = tolerance * size, further_in = 1e-3 * size;
  const Vec3 up = tops_.front().side.normal;
  ContactSet& on_plate = meet_plate(world, body, contacts.with_curvature);
  static thread_local std::vector<const Top*> top_of;  // keeps its size
  top_of.clear();
  double lowest = infinity;
  for (std::size_t i = 0; i < on_plate.size(); ++i) {
    const Vec3 tip = on_plate.arm[i] - 0.5 * on_plate.gap[i] * on_plate.normal[i], out = tip - up.dot(tip) * up;
    const Top* under = top_under(tip, near);
    if (!under || !(up.dot(on_plate.normal[i]) < -top_cosine)) return false;
    const Top* inner = top_under(tip - further_in * out.normalized(), near);
    top_of.push_back(inner ? inner : under);
    on_plate.gap[i] += top_of[i]->above(tip) - tops_.front().above(tip);
    lowest = std::min(lowest, on_plate.gap[i]);
  }
  if (!(lowest <= deepest + near) || lowest < deepest - std::abs(deepest) - near) return false;
  // a cylinder's points have one name whichever of the two comes first (collide_flat_core)
  const bool keeps_names = shapes_.with(ShapeRef{world.shape[body]}, []<class S>(const S&) { return HasFlatSides<S>; });
  for (std::size_t i = 0; i < on_plate.size(); ++i) {
    const Group& g = *top_of[i]->group;
    const bool of_a = g.a == body;
    const bool on_mesh = std::ranges::binary_search(contacts.meshes, g.of(of_a));
    const Vec3 &n = on_plate.normal[i], &place = on_plate.arm[i];
    const Feature f = on_plate.feature[i];
    if (parts_[body] != 0) points_on_.push_back({contacts.size(), place, -n});
    contacts.append(g.a, g.b,
                    {on_plate.gap[i], of_a ? n : Vec3(-n), of_a ? place : Vec3(place + g.branch),
                     contacts.with_curvature ? on_plate.effective_radius[i] : 0.0,
                     (contacts.feature[g.begin] >> 56 << 56) | (on_mesh               ? feature_on_mesh(f)
                                                                : of_a || keeps_names ? f
                                                                                      : exchanged_feature(f))});
    hidden_.push_back(0);
  }
  return !top_of.empty();
}

/// The contacts of the body with one wide plate under it where the first of the tops is, from the body's centre.
ContactSet& Seams::meet_plate(const World& world, Slot body, bool curvature) const {
  static thread_local Box plate;
  static thread_local ContactSet on_plate;
  const Top& top = tops_.front();
  const Vec3& up = top.side.normal;
  const double half = std::exp2(std::ceil(std::log2(4.0 * radius_[body])));  // the same whatever was asked before
  if (plate.half.z() != half) plate = Box(Vec3::Constant(half));
  PairQuery q{{Vec3::Zero(), world.orientation[body]},
              {-(top.above(Vec3::Zero()) + half) * up, Quat::FromTwoVectors(Vec3::UnitZ(), up)},
              reach_,
              curvature};
  q.wall_b = true;
  on_plate.clear();
  on_plate.with_curvature = curvature;
  ContactSink sink(on_plate);
  sink.begin(0, 1);
  shapes_.with(ShapeRef{world.shape[body]}, [&]<class S>(const S& s) {
    if constexpr (PolyhedralShape<PartOf<S>> || HasFlatSides<PartOf<S>>) {
      pair_table_detail::meet(s, plate, q, sink, {});
    } else if constexpr (ConvexShape<S>) {  // the plane has a closed form
      q.b.position += half * up;
      pair_table_detail::meet(s, HalfSpace{}, q, sink, {});
    }
  });
  sink.end();
  return on_plate;
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
