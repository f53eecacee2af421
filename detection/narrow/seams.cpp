#include "detection/narrow/seams.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace epafi {

namespace {

constexpr std::uint32_t no_wall = 0xffffffffu;

ShapeRef shape_of(const World& world, Slot s) { return ShapeRef{world.shape[s]}; }

bool same_bodies(const ContactSet& contacts, std::size_t i, std::size_t k) {
  return contacts.a[i] == contacts.a[k] && contacts.b[i] == contacts.b[k];
}

/// Of the same bodies, image and part.
bool same_pair(const ContactSet& contacts, std::size_t i, std::size_t k) {
  return same_bodies(contacts, i, k) && contacts.feature[i] >> 48 == contacts.feature[k] >> 48;
}

/// The points of a face have one normal to rounding; those of two faces of a body differ by more.
bool same_direction(const Vec3& n, const Vec3& m) { return n.dot(m) > 1.0 - 1e-9; }

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

/// Of the cell and its neighbours, itself first.
std::vector<Vec3> image_shifts(const PeriodicCell* cell) {
  std::vector<Vec3> shifts(1, Vec3::Zero());
  if (cell == nullptr) return shifts;
  for (int axis = 0; axis < 3; ++axis) {
    if (!cell->repeats[static_cast<std::size_t>(axis)]) continue;
    const Vec3 along = cell->size[axis] * Vec3::Unit(axis);
    const std::size_t count = shifts.size();
    for (std::size_t k = 0; k < count; ++k) {
      shifts.push_back(shifts[k] + along);
      shifts.push_back(shifts[k] - along);
    }
  }
  return shifts;
}

/// Contacts of two bodies; A has the lower id.
std::pair<std::size_t, std::size_t> pair_range(const World& world, const ContactSet& contacts, Slot p, Slot q) {
  const std::pair pair = world.id[p] < world.id[q] ? std::pair(p, q) : std::pair(q, p);
  const auto key = [&](std::size_t i) { return std::pair(contacts.a[i], contacts.b[i]); };
  std::size_t begin = 0, end = contacts.size();
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    if (key(middle) < pair)
      begin = middle + 1;
    else
      end = middle;
  }
  while (end < contacts.size() && key(end) == pair) ++end;
  return {begin, end};
}

}  // namespace

void Seams::find(const World& world) {
  const auto& solids = shapes_.of<SolidParts>();
  solids_ = std::ranges::any_of(solids, [](const SolidParts& s) { return s.part_count() > 1; });
  walls_.clear();
  moved_ = false;
  for (Slot s = 0; s < world.size(); ++s)
    if (!world.is_movable(s) && has_flat_faces(shapes_, shape_of(world, s))) walls_.push_back({s, {}});
  if (walls_.size() == 1 && !world.cell) walls_.clear();
  wall_of_slot_.assign(walls_.empty() ? 0 : world.size(), no_wall);
  for (std::uint32_t k = 0; k < walls_.size(); ++k) wall_of_slot_[walls_[k].slot] = k;
  find_neighbours(world);
}

/// None of a body that is no wall; bodies that were born since are none.
std::span<const Seams::Neighbour> Seams::neighbours_of(Slot s) const {
  if (s >= wall_of_slot_.size() || wall_of_slot_[s] == no_wall) return {};
  return walls_[wall_of_slot_[s]].neighbours;
}

/// Boxes of walls and images are swept along x.
void Seams::find_neighbours(const World& world) {
  const std::vector<Neighbour> all = walls_and_images(world);
  for (Wall& wall : walls_) wall.neighbours.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double reach = tolerance * all[i].box.extent().norm();
    const Aabb box = all[i].box.fattened(std::isfinite(reach) ? reach : 0.0);
    for (std::size_t k = i + 1; k < all.size() && all[k].box.min.x() <= box.max.x(); ++k) {
      if (!box.overlaps(all[k].box)) continue;
      if (all[i].shift.isZero(0.0)) walls_[wall_of_slot_[all[i].slot]].neighbours.push_back(all[k]);
      if (all[k].shift.isZero(0.0)) walls_[wall_of_slot_[all[k].slot]].neighbours.push_back(all[i]);
    }
  }
  touching_ = std::ranges::any_of(walls_, [](const Wall& wall) { return !wall.neighbours.empty(); });
}

std::vector<Seams::Neighbour> Seams::walls_and_images(const World& world) const {
  std::vector<Neighbour> all;
  for (const Wall& wall : walls_) {
    const Aabb box = shapes_.bounding_box(world, wall.slot);
    for (const Vec3& shift : image_shifts(world.cell ? &*world.cell : nullptr))
      all.push_back({wall.slot, world.id[wall.slot], shift, {box.min + shift, box.max + shift}});
  }
  std::sort(all.begin(), all.end(), [](const Neighbour& p, const Neighbour& q) {
    return std::pair(p.box.min.x(), p.id) < std::pair(q.box.min.x(), q.id);
  });
  return all;
}

/// Driven walls and straining cells: neighbours are those of the step.
void Seams::follow(const World& world) {
  const auto moves = [&](const Wall& w) {
    return !world.velocity[w.slot].isZero(0.0) || (world.rotates() && !world.angular_velocity[w.slot].isZero(0.0));
  };
  const bool strains = world.cell && !world.cell->strain_rate.isZero(0.0);
  moved_ = moved_ || (strains && !walls_.empty()) || std::ranges::any_of(walls_, moves);
  if (moved_) find_neighbours(world);
}

void Seams::hide(const World& world, ContactSet& contacts) {
  follow(world);
  if (!touching_ && !solids_) return;
  candidates_.clear();
  const auto may_be_wall = [&](Slot s) { return solids_ || (s < wall_of_slot_.size() && wall_of_slot_[s] != no_wall); };
  for (std::size_t i = 0; i < contacts.size(); ++i)
    for (const bool wall_is_b : {true, false})
      if (may_be_wall(wall_is_b ? contacts.b[i] : contacts.a[i])) consider(world, contacts, i, wall_is_b);
  if (candidates_.empty()) return;
  hidden_.assign(contacts.size(), 0);
  for (const Candidate& c : candidates_)
    if (hidden_[c.contact] == 0 && is_hidden(world, contacts, c)) hidden_[c.contact] = 1;
  decide_faces(world, contacts);
  take_out(contacts, hidden_);
}

void Seams::consider(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) {
  const Slot wall = wall_is_b ? contacts.b[i] : contacts.a[i];
  if (neighbours_of(wall).empty() && !(solids_ && part_count(shapes_, shape_of(world, wall)) > 1)) return;
  const Candidate c = candidate(world, contacts, i, wall_is_b);
  if (c.on_wall && has_other_near(c)) candidates_.push_back(c);
}

/// Contact points lie on one of the surfaces or half way between them: the outermost place that is on the wall counts.
Seams::Candidate Seams::candidate(const World& world, const ContactSet& contacts, std::size_t i, bool wall_is_b) const {
  const Slot wall = wall_is_b ? contacts.b[i] : contacts.a[i], body = wall_is_b ? contacts.a[i] : contacts.b[i];
  const ShapeRef shape = shape_of(world, wall);
  Candidate c{i, wall_is_b, wall, body, world.id[wall], {shape, world.pose(wall)}};
  c.near = tolerance * shapes_.bounding_radius(shape_of(world, body));
  if (!std::isfinite(c.near)) c.near = tolerance * shapes_.bounding_radius(shape);
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
    // the point of a round end stands for its rim, and may be in the wall
    if (height < -c.near && height > -2.0 * c.near - out) c.point -= height * n;
    if (!same_direction(n, c.normal)) c.normal = n;
    break;
  }
  return c;
}

/// Of a solid the first part with this normal at the point; the whole where there is none.
WallPiece Seams::piece_at(const Candidate& c, const Vec3& point) const {
  WallPiece piece{c.piece.shape, c.piece.pose};
  const std::size_t parts = part_count(shapes_, piece.shape);
  if (parts < 2) return piece;
  for (piece.part = 0; piece.part < parts; ++piece.part) {
    if (!is_on(shapes_, piece, point, c.near)) continue;
    const Vec3 normal = side_normal(shapes_, piece, point, c.normal, c.near);
    if (!goes_beyond(shapes_, piece, point, normal, c.near)) return piece;
  }
  return {c.piece.shape, c.piece.pose};
}

/// Of two walls that give the same contact the lower id has it, of two images of a wall the one further back.
bool Seams::comes_first(const Candidate& c, const Other& other) {
  if (other.id != c.id) return c.id < other.id;
  if (other.piece.part != WallPiece::whole) return true;  // is_given_before
  const Vec3 zero = Vec3::Zero();
  return std::lexicographical_compare(zero.data(), zero.data() + 3, other.shift.data(), other.shift.data() + 3);
}

/// As the wall sees it: beside the wall, or beside its image that the contact is with, put back.
Vec3 Seams::centre_of_body(const World& world, const ContactSet& contacts, const Candidate& c) {
  const Vec3 branch = world.branch(contacts.a[c.contact], contacts.b[c.contact], contacts.feature[c.contact]);
  return world.position[c.wall] + (c.wall_is_b ? Vec3(-branch) : branch);
}

bool Seams::has_other_near(const Candidate& c) const {
  if (c.piece.part != WallPiece::whole) return true;
  const Aabb at = Aabb{c.point, c.point}.fattened(c.near);
  return std::ranges::any_of(neighbours_of(c.wall), [&](const Neighbour& n) { return n.box.overlaps(at); });
}

bool Seams::is_hidden(const World& world, const ContactSet& contacts, const Candidate& c) const {
  const auto hides = [&](const Other& other) {
    return is_on(shapes_, other.piece, c.point, c.near) && holds_instead(world, contacts, c, other);
  };
  const std::size_t parts = c.piece.part == WallPiece::whole ? 0 : part_count(shapes_, c.piece.shape);
  if (parts > 0 && is_given_before(contacts, c)) return true;
  for (std::size_t part = 0; part < parts; ++part)
    if (part != c.piece.part && hides({c.wall, c.id, {c.piece.shape, c.piece.pose, part}, Vec3::Zero()})) return true;
  return std::ranges::any_of(neighbours_of(c.wall), [&](const Neighbour& n) {
    Other other{n.slot, n.id, {shape_of(world, n.slot), world.pose(n.slot)}, n.shift};
    other.piece.pose.position += n.shift;
    return hides(other);
  });
}

/// Two parts give the same point with the same normal.
bool Seams::is_given_before(const ContactSet& contacts, const Candidate& c) const {
  for (std::size_t k = c.contact; k-- > 0 && same_bodies(contacts, k, c.contact);)
    if (contacts.feature[k] >> 56 == contacts.feature[c.contact] >> 56 && hidden_[k] == 0 &&
        same_direction(contacts.normal[k], contacts.normal[c.contact]) &&
        (contacts.arm[k] - contacts.arm[c.contact]).norm() <= c.near)
      return true;
  return false;
}

/// One of the body's contacts with the other wall has a normal of the union at the point, and the wall in question
/// gives another one there, or the same once more.
bool Seams::holds_instead(const World& world, const ContactSet& contacts, const Candidate& c,
                          const Other& other) const {
  const bool beyond = goes_beyond(shapes_, other.piece, c.point, c.normal, c.near);
  if (!beyond && comes_first(c, other)) return false;
  const Vec3 centre = centre_of_body(world, contacts, c);
  const auto [begin, end] = pair_range(world, contacts, other.wall, c.body);
  double deepest = 0.0;  // the body may lean: where it has the wall it is not as deep as at the point
  for (std::size_t k = begin; k < end; ++k) deepest = std::max(deepest, -contacts.gap[k]);
  const double deep = c.near + deepest;
  for (std::size_t k = begin; k < end; ++k) {
    if (k == c.contact || hidden_[k] != 0) continue;
    const Candidate held = candidate(world, contacts, k, contacts.b[k] == other.wall);
    if (other.piece.part != WallPiece::whole && held.piece.part != other.piece.part) continue;
    if ((centre_of_body(world, contacts, held) + other.shift - centre).norm() > c.near) continue;  // of another image
    if (!beyond && same_direction(held.normal, c.normal) && (held.point + other.shift - c.point).norm() <= deep)
      return true;
    // several points: the body lies on it, and may lean; at the wall's edges too its side says the normal
    const bool flat = end - begin > 1 && held.on_wall;
    const Vec3 n = flat ? side_normal(shapes_, held.piece, held.point, held.normal, -infinity) : held.normal;
    if (beyond && !goes_beyond(shapes_, other.piece, c.point, n, deep) &&
        !goes_beyond(shapes_, c.piece, c.point, n, deep))
      return true;
  }
  return false;
}

/// Points of one normal stand or go together. They stand where one that is not hidden has a normal of its wall: a box
/// that slides over a seam keeps the corners that it has on it, with the wall's normal where its own face said one.
/// Else they are those of an edge, which the neighbour has.
void Seams::decide_faces(const World& world, ContactSet& contacts) {
  for (const Candidate& c : candidates_) {
    const Vec3 given = c.wall_is_b ? Vec3(-contacts.normal[c.contact]) : contacts.normal[c.contact];
    if (hidden_[c.contact] == 2 || (hidden_[c.contact] == 0 && same_direction(c.normal, given))) continue;
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
