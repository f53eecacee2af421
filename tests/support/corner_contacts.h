/// @file corner_contacts.h  Contacts of spheres, boxes and one kind of plane without the detection floor, for tests of
/// contact models: sphere-sphere, sphere-plane, box corners against a plane, upright boxes stacked face on face or on
/// spheres.
#pragma once
#include <algorithm>
#include <array>

#include "engine/step/pipeline.h"

namespace epafi::test {

/// By world.shape: a plane (normal in body axes), a sphere or a box.
struct Solid {
  enum class Kind { plane, sphere, box } kind = Kind::sphere;
  Vec3 half = Vec3::Zero();  ///< box: half edges; sphere: radius in x; plane: unit normal
};

/// Every pair with a free body, in canonical order.
class EveryPair final : public BroadPhase {
 public:
  const char* name() const override { return "every-pair"; }
  void find_pairs(const World& world, PairList& list) override {
    list.pairs.clear();
    for (Slot a = 0; a < world.size(); ++a)
      for (Slot b = 0; b < world.size(); ++b)
        if (world.id[a] < world.id[b] && (world.is_movable(a) || world.is_movable(b))) list.pairs.push_back({a, b});
    std::sort(list.pairs.begin(), list.pairs.end());
  }
};

class CornerContacts final : public NarrowPhase {
 public:
  CornerContacts(std::vector<Solid> solids, double reach) : solids_(std::move(solids)), reach_(reach) {}
  const char* name() const override { return "corners"; }
  void collide(const World& world, const PairList& pairs, ContactSet& contacts) override {
    contacts.clear();
    for (const Pair& pair : pairs.pairs) collide(world, pair.a, pair.b, contacts);
  }

 private:
  using Kind = Solid::Kind;
  const Solid& solid(const World& world, Slot s) const { return solids_[world.shape[s]]; }

  /// Adds a point with the outward normal of `below` (away from it) and the gap of `tip`, a point of the other body.
  void add(const World& world, Slot a, Slot b, bool below_is_a, const Vec3& normal, double gap, const Vec3& tip,
           std::uint32_t feature, ContactSet& contacts) const {
    if (gap >= reach_) return;
    ContactPoint c;
    c.gap = gap;
    c.normal = below_is_a ? normal : Vec3(-normal);
    c.feature = feature;
    c.arm = tip - 0.5 * gap * normal - world.position[a];
    contacts.append(a, b, c);
  }

  void collide(const World& world, Slot a, Slot b, ContactSet& contacts) const {
    const Kind ka = solid(world, a).kind, kb = solid(world, b).kind;
    if (ka == Kind::sphere && kb == Kind::sphere) {
      const Vec3 d = world.position[b] - world.position[a];
      const double ra = solid(world, a).half.x(), rb = solid(world, b).half.x(), distance = d.norm();
      const Vec3 n = d / distance;
      add(world, a, b, true, n, distance - ra - rb, world.position[b] - rb * n, 0, contacts);
      return;
    }
    if (ka == Kind::box && kb == Kind::box) return stack(world, a, b, contacts);
    if (ka == Kind::sphere && kb == Kind::box) return ball_under_box(world, a, b, contacts);
    const bool plane_is_a = ka == Kind::plane;
    const Slot plane = plane_is_a ? a : b, body = plane_is_a ? b : a;
    const Vec3 n = world.pose(plane).orientation * solid(world, plane).half;
    const auto tip = [&](const Vec3& p, std::uint32_t feature) {
      add(world, a, b, plane_is_a, n, n.dot(p - world.position[plane]), p, feature, contacts);
    };
    if (solid(world, body).kind == Kind::sphere) return tip(world.position[body] - solid(world, body).half.x() * n, 0);
    for (std::uint32_t k = 0; k < 8; ++k) tip(world.pose(body).to_world(corner(solid(world, body).half, k)), k);
  }

  static Vec3 corner(const Vec3& half, std::uint32_t k) {
    return {k & 1 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(), k & 4 ? half.z() : -half.z()};
  }

  /// The top of a sphere against the bottom face of a level box above it.
  void ball_under_box(const World& world, Slot ball, Slot box, ContactSet& contacts) const {
    const Pose pose = world.pose(box);
    const Vec3 up = pose.orientation * Vec3::UnitZ(), top = world.position[ball] + solid(world, ball).half.x() * up;
    const double gap = -solid(world, box).half.z() - pose.to_local(top).z();
    add(world, ball, box, true, up, gap, top + gap * up, 0, contacts);
  }

  /// The bottom corners of the upper box, moved into the top face of the lower one (right while both faces are
  /// parallel).
  void stack(const World& world, Slot a, Slot b, ContactSet& contacts) const {
    const bool below_is_a = world.position[a].z() < world.position[b].z();
    const Pose low = world.pose(below_is_a ? a : b), high = world.pose(below_is_a ? b : a);
    const Vec3 half_low = solid(world, below_is_a ? a : b).half, half_high = solid(world, below_is_a ? b : a).half;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Vec3 p = low.to_local(high.to_world(corner(half_high, k)));
      const double x = std::clamp(p.x(), -half_low.x(), half_low.x());
      const double y = std::clamp(p.y(), -half_low.y(), half_low.y());
      const Vec3 tip = low.to_world({x, y, p.z()});
      add(world, a, b, below_is_a, low.orientation * Vec3::UnitZ(), p.z() - half_low.z(), tip, k, contacts);
    }
  }

  std::vector<Solid> solids_;
  double reach_;
};

}  // namespace epafi::test
