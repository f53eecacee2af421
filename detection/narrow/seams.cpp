#include "detection/narrow/seams.h"

#include <bit>
#include <cmath>
#include <utility>

namespace epafi {

namespace {

constexpr std::size_t most_of_free = 64;     // a bit each; all pairs of them are looked at
constexpr double level_cosine = 1.0 - 5e-9;  // stones that settle turn by 1e-6, a joint of 1e-4 stops nothing
constexpr double most_pressed = 0.1;         // of half the least width: deeper, free bodies are in each other
constexpr double leaning = 0.01;             // of the body's radius: far more than what counts as level

ShapeRef shape_of(const World& world, Slot s) { return ShapeRef{world.shape[s]}; }

bool same_bodies(const ContactSet& contacts, std::size_t i, std::size_t k) {
  return contacts.a[i] == contacts.a[k] && contacts.b[i] == contacts.b[k];
}

/// Of the same bodies, image and part.
bool same_pair(const ContactSet& contacts, std::size_t i, std::size_t k) {
  return same_bodies(contacts, i, k) && contacts.feature[i] >> 48 == contacts.feature[k] >> 48;
}

void take_out(ContactSet& contacts, const std::vector<std::uint8_t>& gone) {
  const auto shorten = [&](auto& column) {
    if (column.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < gone.size(); ++i)
      if (gone[i] == 0) column[kept++] = column[i];
    column.resize(kept);
  };
  shorten(contacts.a);
  shorten(contacts.b);
  shorten(contacts.feature);
  shorten(contacts.gap);
  shorten(contacts.normal);
  shorten(contacts.arm);
  shorten(contacts.effective_radius);
}

/// Of the same bodies and image.
bool same_group(const ContactSet& contacts, std::size_t i, std::size_t k) {
  return same_bodies(contacts, i, k) && contacts.feature[i] >> 56 == contacts.feature[k] >> 56;
}

std::size_t end_of_group(const ContactSet& contacts, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < contacts.size() && same_group(contacts, begin, end)) ++end;
  return end;
}

Vec3 velocity_at(const World& world, Slot s, const Vec3& arm) {
  return world.rotates() ? Vec3(world.velocity[s] + world.angular_velocity[s].cross(arm)) : world.velocity[s];
}

/// Of contact i, beside the wall where that is itself, not at an image.
Vec3 point_on(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) {
  return wall_is_b ? Vec3(world.position[contacts.b[i]] + contacts.arm_b(i, world)) : contacts.point(i, world);
}

}  // namespace

void Seams::find(const World& world, bool predicted) {
  predicted_ = predicted;
  flat_.resize(world.size());
  convex_.resize(world.size());
  radius_.resize(world.size());
  thin_.resize(world.size());
  parts_.resize(world.size());
  touching_.assign(world.size(), 0);
  for (Slot s = 0; s < world.size(); ++s) {
    const ShapeRef shape = shape_of(world, s);
    if (shape.type() == ShapeStore::type_of<Sphere>()) {
      flat_[s] = convex_[s] = parts_[s] = 0;
      radius_[s] = thin_[s] = shapes_.bounding_radius(shape);
      continue;
    }
    flat_[s] = world.is_movable(s) ? is_free_wall(shapes_, shape) : has_flat_faces(shapes_, shape);
    convex_[s] = is_convex(shapes_, shape);
    radius_[s] = shapes_.bounding_radius(shape);
    const Aabb box = shapes_.bounding_box(shape, Pose{});
    thin_[s] = 0.5 * (box.max - box.min).minCoeff();
    parts_[s] = part_count(shapes_, shape) > 1;
  }
  solids_ = std::ranges::count(parts_, 1) > 0;
  joins_ = std::ranges::count(flat_, 1) > (world.cell ? 0 : 1);
}

void Seams::hide(const World& world, ContactSet& contacts) {
  contacts.joined.clear();
  if (!joins_ && !solids_) return;
  if (!solids_ && !touch_several(world, contacts)) return;
  list_groups(world, contacts);
  candidates_.clear();
  others_.clear();
  for (const Group& group : groups_) consider(world, contacts, group);
  surface_.resize(groups_.size());
  std::iota(surface_.begin(), surface_.end(), 0u);
  hidden_.assign(contacts.size(), 0);
  instead_.resize(contacts.size());
  find_hidden(world, contacts);
  decide_faces(world, contacts);
  const std::size_t before = hidden_.size();
  rest_on_few(world, contacts);
  const bool appended = hidden_.size() > before;
  if (std::ranges::count(hidden_, 0) < std::ssize(hidden_)) take_out(contacts, hidden_);
  if (appended) contacts.sort();
  auto& joined = contacts.joined;
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
}

/// True if some free body touches walls by two groups of contacts. In most steps of a hopper none does: what follows
/// visits all bodies.
bool Seams::touch_several(const World& world, const ContactSet& contacts) {
  bool several = false;
  std::size_t seen = 0;
  const auto each = [&](std::size_t i, const auto& see) {
    const Slot a = contacts.a[i], b = contacts.b[i];
    if ((flat_[a] != 0 || flat_[b] != 0) && (i == 0 || !same_group(contacts, i - 1, i)))
      for (const Slot s : {a, b}) see(s);
  };
  for (; seen < contacts.size() && !several; ++seen)
    each(seen, [&](Slot s) {
      several = (std::exchange(touching_[s], std::uint8_t{1}) != 0 && world.is_movable(s)) || several;
    });
  for (std::size_t i = 0; i < seen; ++i) each(i, [&](Slot s) { touching_[s] = 0; });
  return several;
}

void Seams::list_groups(const World& world, const ContactSet& contacts) {
  groups_.clear();
  of_body_.begin.assign(world.size() + 1, 0);
  deepest_.assign(world.size(), 0.0);
  for (std::size_t begin = 0, end = 0; begin < contacts.size(); begin = end) {
    end = begin + 1;
    const Slot a = contacts.a[begin], b = contacts.b[begin];
    if (flat_[a] == 0 && flat_[b] == 0) continue;
    end = end_of_group(contacts, begin);
    Group group{begin, end, a, b, world.branch(a, b, contacts.feature[begin])};
    for (std::size_t i = begin; i < end; ++i) group.depth = std::max(group.depth, -contacts.gap[i]);
    for (const Slot s : {a, b})
      if (world.is_movable(s)) deepest_[s] = std::max(deepest_[s], group.depth);
    groups_.push_back(group);
  }
  of_body_.fill([&](auto&& f) {
    for (std::uint32_t k = 0; k < groups_.size(); ++k) {
      f(groups_[k].a, k);
      f(groups_[k].b, k);
    }
  });
  if (joins_) find_beside(world, contacts);
}

/// A convex wall extends above the plane of its contact by no more than the level tolerance, and so do its seams with
/// other walls; nor do they lie beyond its bounding sphere. These tests exclude most pairs of contacts in a pile.
void Seams::find_beside(const World& world, const ContactSet& contacts) {
  for (Slot body = 0; body < world.size(); ++body) {
    const auto groups = of_body_.at(body);
    if (groups.size() < 2 || groups.size() > most_of_free || !world.is_movable(body)) continue;
    views_.clear();
    for (const std::uint32_t k : groups) views_.push_back(view_of(contacts, groups_[k], body));
    for (std::size_t k = 0; k < groups.size(); ++k) {
      Group& with = groups_[groups[k]];
      if (!views_[k].flat) continue;
      for (std::size_t m = 0; m < groups.size(); ++m)
        if (m != k && views_[m].flat && may_reach(contacts, views_[m], views_[k], with))
          with.beside[with.a == body ? 1 : 0] |= 1ull << m;
    }
  }
}

Seams::View Seams::view_of(const ContactSet& contacts, const Group& group, Slot body) const {
  const bool wall_is_b = group.a == body;
  const Slot wall = group.of(wall_is_b);
  View view{flat_[wall] != 0};
  if (!view.flat) return view;
  if (!wall_is_b) view.centre = group.branch;
  view.wall = wall_is_b ? group.branch : Vec3(-group.branch);
  view.more = deepest_[wall] + 2.0 * group.depth;
  const double slack = view.more + leaning * radius_[body];
  view.radius = radius_[wall] + slack;
  const Vec3& normal = contacts.normal[group.begin];
  bool even = convex_[wall] != 0;
  if (even) view.out = wall_is_b ? Vec3(-normal) : normal;
  double top = -infinity;
  for (std::size_t i = group.begin; i < group.end && even; ++i) {
    even = same_direction(contacts.normal[i], normal);
    top = std::max(top, view.out.dot(contacts.arm[i] - view.centre));
  }
  view.top = even ? top + slack : infinity;
  return view;
}

/// Whether some contact with another wall may lie on this one.
bool Seams::may_reach(const ContactSet& contacts, const View& wall, const View& other, const Group& group) {
  for (std::size_t i = group.begin; i < group.end; ++i) {
    const Vec3 place = contacts.arm[i] - other.centre;
    const double more = other.more + std::max(0.0, contacts.gap[i]), radius = wall.radius + more;
    if (wall.out.dot(place) - more <= wall.top && (place - wall.wall).squaredNorm() <= radius * radius) return true;
  }
  return false;
}

/// The contacts of two bodies, either of which may be a wall to the other.
void Seams::consider(const World& world, const ContactSet& contacts, const Group& group) {
  struct Side {
    bool wall_is_b, parts = false;
    std::size_t first = 0, last = 0;
    bool is_empty() const { return !parts && first == last; }
  } sides[] = {{true}, {false}};
  for (Side& side : sides) {
    const Slot wall = group.of(side.wall_is_b);
    if (flat_[wall] == 0) continue;
    side.first = others_.size();
    if (joins_) list_others(world, contacts, group, side.wall_is_b);
    side.last = others_.size();
    side.parts = parts_[wall] != 0;
  }
  if (sides[0].is_empty() && sides[1].is_empty()) return;
  for (std::size_t i = group.begin; i < group.end; ++i)
    for (const Side& side : sides) {
      if (!side.parts &&
          !may_be_near(world, contacts, i, side.wall_is_b, {others_.begin() + side.first, others_.begin() + side.last}))
        continue;
      Candidate c = candidate(world, contacts, i, side.wall_is_b);
      c.group = &group;
      c.first_other = side.first;
      c.last_other = side.last;
      if (c.on_wall && has_other_near(c)) candidates_.push_back(c);
    }
}

/// Cheap test: the contact point on the wall is no farther from the detected one than the gap plus `level`.
bool Seams::may_be_near(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b,
                        std::span<const Other> others) const {
  if (others.empty()) return false;
  const Vec3 at = point_on(world, contacts, i, wall_is_b);
  const double off = std::abs(contacts.gap[i]);
  return std::ranges::any_of(others,
                             [&](const Other& o) { return !o.free || is_on(shapes_, o.piece, at, o.level + off); });
}

bool Seams::has_other_near(const Candidate& c) const {
  if (c.piece.part != WallPiece::whole) return true;
  return std::ranges::any_of(others_of(c), [&](const Other& o) {
    return o.free ? is_on(shapes_, o.piece, c.point, o.level) : o.box.overlaps(Aabb{c.point, c.point}.fattened(c.near));
  });
}

/// Neighbours are found from the body's other contacts. For a body that touches many, such as a floor, free ones are
/// not joined.
void Seams::list_others(const World& world, const ContactSet& contacts, const Group& group, bool wall_is_b) {
  const Slot body = group.of(!wall_is_b);
  const auto groups = of_body_.at(body);
  const auto add = [&](std::size_t k) {
    if (&groups_[groups[k]] != &group) add_other(world, contacts, group, wall_is_b, groups_[groups[k]]);
  };
  for (std::uint64_t rest = group.beside[wall_is_b ? 1 : 0]; rest != 0; rest &= rest - 1)
    add(static_cast<std::size_t>(std::countr_zero(rest)));
  if (groups.size() <= most_of_free || world.is_movable(group.of(wall_is_b)) || !world.is_movable(body)) return;
  for (std::size_t k = 0; k < groups.size(); ++k) add(k);
}

/// Walls that touch, and are at rest relative to each other if one is free: slower than a tenth of the body's speed or
/// than a fall through the level tolerance. Overlapping free bodies share no surface.
void Seams::add_other(const World& world, const ContactSet& contacts, const Group& group, bool wall_is_b,
                      const Group& held) {
  const Slot wall = group.of(wall_is_b), body = group.of(!wall_is_b);
  const bool held_is_b = held.a == body;
  const Slot slot = held.of(held_is_b);
  const bool free = world.is_movable(wall) || world.is_movable(slot);
  double level = near_of(wall, body);
  if (free) {
    const double depth = std::max(group.depth, held.depth), higher = std::abs(deepest_[wall] - deepest_[slot]);
    if (std::max(depth, higher) > most_pressed * std::min({thin_[wall], thin_[body], thin_[slot]})) return;
    level += (free_tolerance / tolerance - 1.0) * near_of(wall, body) + higher + depth;
  }
  Vec3 shift = Vec3::Zero();
  if (world.cell)
    shift = centre_of_body(world, contacts, group.begin, wall_is_b) -
            centre_of_body(world, contacts, held.begin, held_is_b);
  const Vec3 place = world.position[slot] + shift;
  const auto is_near = [&](std::size_t i) {
    const double reach = radius_[slot] + level + std::abs(contacts.gap[i]);
    return (point_on(world, contacts, i, wall_is_b) - place).squaredNorm() <= reach * reach;
  };
  std::size_t i = group.begin;
  while (i < group.end && !is_near(i)) ++i;
  if (i == group.end) return;
  if (free) {
    const Vec3 point = point_on(world, contacts, i, wall_is_b);
    const Vec3 of_wall = velocity_at(world, wall, point - world.position[wall]);
    const double apart = (velocity_at(world, slot, point - place) - of_wall).squaredNorm();
    const Vec3 centre = centre_of_body(world, contacts, i, wall_is_b);
    const double pace = (velocity_at(world, body, point - centre) - of_wall).squaredNorm();
    if (apart > 0.01 * pace + world.gravity.norm() * level) return;
  }
  Other other{slot, world.id[slot], {shape_of(world, slot), world.pose(slot)}, shift, &held, level, free};
  other.piece.pose.position = place;
  if (!free) other.box = shapes_.bounding_box(other.piece.shape, other.piece.pose);
  others_.push_back(other);
}

double Seams::near_of(Slot wall, Slot body) const {
  return tolerance * (std::isfinite(radius_[body]) ? radius_[body] : radius_[wall]);
}

/// Contact points lie on one of the surfaces or half way between them: the outermost place that is on the wall counts.
Seams::Candidate Seams::candidate(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) const {
  const Slot wall = wall_is_b ? contacts.b[i] : contacts.a[i], body = wall_is_b ? contacts.a[i] : contacts.b[i];
  const ShapeRef shape = shape_of(world, wall);
  Candidate c{i, wall_is_b, wall, body, world.id[wall], {shape, world.pose(wall)}};
  c.near = near_of(wall, body);
  c.normal = wall_is_b ? Vec3(-contacts.normal[i]) : contacts.normal[i];
  const Vec3 at = world.position[wall] + (wall_is_b ? contacts.arm_b(i, world) : contacts.arm[i]);
  const double out = std::max(0.0, -contacts.gap[i]), in = std::min(0.0, -contacts.gap[i]);
  for (const double way : {out, 0.5 * out, 0.5 * in, in}) {
    const Vec3 point = at + way * c.normal;
    const WallPiece piece = piece_at(c, point);
    const bool on_a_part = piece.part != WallPiece::whole || part_count(shapes_, piece.shape) < 2;
    const double height = on_a_part ? distance_to(shapes_, piece, point, c.near) : infinity;
    if (!(height <= c.near)) continue;
    c.point = point;
    c.piece.part = piece.part;
    c.on_wall = true;
    const Vec3 n = side_normal(shapes_, piece, point, c.normal, c.near);
    // the point of a round end represents its rim, and may be inside the wall
    if (height < -c.near && height > -2.0 * c.near - out) c.point -= height * n;
    if (!same_direction(n, c.normal)) c.normal = n;
    break;
  }
  return c;
}

/// Of a solid the first part with this normal at the point; the whole where there is none.
WallPiece Seams::piece_at(const Candidate& c, const Vec3& point) const {
  WallPiece piece{c.piece.shape, c.piece.pose};
  if (part_count(shapes_, piece.shape) < 2) return piece;
  static thread_local std::vector<std::size_t> parts;
  find_parts(shapes_, piece, point, c.near, parts);
  for (const std::size_t part : parts) {
    piece.part = part;
    const Vec3 normal = side_normal(shapes_, piece, point, c.normal, c.near);
    if (!goes_beyond(shapes_, piece, point, normal, c.near)) return piece;
  }
  return {c.piece.shape, c.piece.pose};
}

/// Of two walls that give the same contact the lower id has it, of two images of a wall the one further back.
bool Seams::comes_first(const Candidate& c, const Other& other) {
  if (other.id != c.id) return c.id < other.id;
  if (other.piece.part != WallPiece::whole) return true;  // one of both remains, few_points.h
  const Vec3 zero = Vec3::Zero();
  return std::lexicographical_compare(zero.data(), zero.data() + 3, other.shift.data(), other.shift.data() + 3);
}

/// As the wall sees it: beside the wall, or beside its image that the contact is with, put back.
Vec3 Seams::centre_of_body(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) {
  const Vec3 branch = world.branch(contacts.a[i], contacts.b[i], contacts.feature[i]);
  return wall_is_b ? Vec3(world.position[contacts.b[i]] - branch) : Vec3(world.position[contacts.a[i]] + branch);
}

/// A contact that carries no load yet may be with the second wall ahead: what holds instead of the first holds instead
/// of that too, which is known once the first is hidden.
void Seams::find_hidden(const World& world, ContactSet& contacts) {
  bool more = true;
  for (bool again = false; more; again = true) {
    more = false;
    for (const Candidate& c : candidates_) {
      if (hidden_[c.contact] != 0 || (again && !(contacts.gap[c.contact] > 0.0)) || !is_hidden(world, contacts, c))
        continue;
      hidden_[c.contact] = 1;
      more = predicted_;
    }
  }
}

bool Seams::is_hidden(const World& world, ContactSet& contacts, const Candidate& c) {
  const auto hides = [&](const Other& other) {
    if (!is_on(shapes_, other.piece, c.point, other.level)) return false;
    if (other.piece.part == WallPiece::whole && !world.is_movable(c.wall) && !world.is_movable(other.wall))
      join(*c.group, *other.held);
    const std::size_t holder = find_holder(world, contacts, c, other);
    if (holder == contacts.size()) return false;
    instead_[c.contact] = holder;
    contacts.joined.push_back({c.body, other.wall, c.wall});
    return true;
  };
  static thread_local std::vector<std::size_t> parts;
  parts.clear();
  if (c.piece.part != WallPiece::whole) find_parts(shapes_, {c.piece.shape, c.piece.pose}, c.point, c.near, parts);
  for (const std::size_t part : parts)
    if (part != c.piece.part &&
        hides({c.wall, c.id, {c.piece.shape, c.piece.pose, part}, Vec3::Zero(), c.group, c.near}))
      return true;
  return std::ranges::any_of(others_of(c), hides);
}

/// Which of the body's contacts with the other wall, or what holds instead of it, has a normal of the union at the
/// point, while this wall has another one there, or the same again; as many as there are if none. A body near an
/// inclined joint would meet it below the supporting surface, so the height of the wall there counts. Of free
/// neighbours each keeps flat contacts, because their loads differ.
std::size_t Seams::find_holder(const World& world, const ContactSet& contacts, const Candidate& c,
                               const Other& other) const {
  const std::size_t none = contacts.size();
  const bool beyond = goes_beyond(shapes_, other.piece, c.point, c.normal, other.level);
  if (!beyond && (comes_first(c, other) || (other.free && flat_[c.body] != 0))) return none;
  const std::size_t begin = other.held->begin, end = other.held->end;
  // the body may be inclined: at the wall it is not as deep as at the point
  const double deep = other.level + other.held->depth;
  const bool predicted = contacts.gap[c.contact] > 0.0;
  for (std::size_t first = begin; first < end; ++first) {
    std::size_t k = first;
    while (hidden_[k] != 0 && predicted && !world.cell) k = instead_[k];  // of images the shift is not known
    if (k == c.contact || hidden_[k] != 0) continue;
    const Candidate held = candidate(world, contacts, k, contacts.a[k] == c.body);
    if (k == first && other.piece.part != WallPiece::whole && held.piece.part != other.piece.part) continue;
    if (!beyond && same_direction(held.normal, c.normal) && (held.point + other.shift - c.point).norm() <= deep)
      return k;
    // several points: the body lies on it, possibly inclined; also at the wall's edges its side gives the normal
    const bool flat = end - begin > 1 && held.on_wall;
    const Vec3 n = flat ? side_normal(shapes_, held.piece, held.point, held.normal, -infinity) : held.normal;
    if (!beyond) continue;
    Vec3 at = c.point;
    if (predicted && held.on_wall) at += std::max(0.0, n.dot(held.point + other.shift - at)) * n;
    const auto ends_at = [&](const WallPiece& piece) {
      const Vec3 own = side_normal(shapes_, piece, at, n, -infinity);
      return !goes_beyond(shapes_, piece, at, own.dot(n) > level_cosine ? own : n, deep);
    };
    if (ends_at(other.piece) && ends_at(c.piece)) return k;
  }
  return none;
}

/// Points of one normal are kept or dropped together. They are kept if a visible one has a normal of its wall: a box
/// that slides over a seam keeps its corners there, with the wall's normal in place of its own face's. Otherwise they
/// are points of an edge, which the neighbour replaces. Beside no neighbour the parts of a solid change no normal.
void Seams::decide_faces(const World& world, ContactSet& contacts) {
  for (const Candidate& c : candidates_) {
    const Vec3 given = c.wall_is_b ? Vec3(-contacts.normal[c.contact]) : contacts.normal[c.contact];
    if (hidden_[c.contact] == 2) continue;
    if (hidden_[c.contact] == 0 && (others_of(c).empty() || same_direction(c.normal, given))) continue;
    std::size_t begin = c.contact, end = c.contact;
    while (begin > 0 && same_pair(contacts, begin - 1, c.contact)) --begin;
    while (end < contacts.size() && same_pair(contacts, end, c.contact)) ++end;
    const Vec3 of_group = contacts.normal[c.contact];
    const auto of_face = [&](std::size_t i) { return same_direction(contacts.normal[i], of_group); };
    bool stands = false, some_hidden = false;
    Vec3 normal = of_group;
    for (std::size_t i = begin; i < end; ++i) {
      some_hidden = some_hidden || (hidden_[i] != 0 && of_face(i));
      if (stands || hidden_[i] != 0 || !of_face(i)) continue;
      const Candidate other = candidate(world, contacts, i, c.wall_is_b);
      stands = !other.on_wall || !goes_beyond(shapes_, other.piece, other.point, other.normal, other.near);
      const Vec3 of_wall = c.wall_is_b ? Vec3(-other.normal) : other.normal;
      if (stands && other.on_wall && !same_direction(of_wall, of_group)) normal = of_wall;
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (!of_face(i)) continue;
      if (some_hidden) hidden_[i] = stands ? 0 : 2;
      contacts.normal[i] = normal;
    }
  }
  for (std::uint8_t& h : hidden_) h = h != 0;
}

}  // namespace epafi
