#include "detection/broad/ball_pairs.h"

#include <algorithm>

#include "detection/broad/pair_collector.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
/// f(part, of a clump, centre, radius)
template <class F>
void each_ball(const ShapeStore& shapes, ShapeRef shape, const F& f) {
  if (shape.type() == ShapeStore::type_of<Sphere>())
    return f(std::size_t{0}, false, Vec3(Vec3::Zero()), shapes.of<Sphere>()[shape.index()].radius);
  const Clump& clump = shapes.of<Clump>()[shape.index()];
  for (std::size_t k = 0; k < clump.part_count(); ++k) f(k, true, clump.parts[k].centre, clump.parts[k].radius);
}

/// By how much two places are known worse than their difference [m].
double rounding_of(const Vec3& a, const Vec3& b) {
  return 0x1p-48 * (a.cwiseAbs().maxCoeff() + b.cwiseAbs().maxCoeff());
}
}  // namespace

std::vector<BodyBall> find_balls(const World& world, const ShapeStore& shapes, const SphereRoles& roles) {
  std::vector<BodyBall> free, held;
  for (Slot s = 0; s < world.size(); ++s) {
    if (roles.of(world, s) != SphereRole::balls) continue;
    std::vector<BodyBall>& out = world.is_movable(s) ? free : held;
    each_ball(shapes, ShapeRef{world.shape[s]}, [&](std::size_t k, bool clump, const Vec3& x, double r) {
      out.push_back({s, static_cast<std::uint16_t>(k), clump, x, r});
    });
  }
  free.insert(free.end(), held.begin(), held.end());
  return free;
}

void BallPairs::read_bodies(const World& world, const BroadSetup& setup) {
  const std::size_t n = world.size();
  role_.resize(n);
  parallel_for(n, [&](std::size_t s) { role_[s] = setup.spheres.of(world, static_cast<Slot>(s)); });
  balls_ = find_balls(world, *setup.shapes, setup.spheres);
  first_.assign(balls_.empty() ? 0 : n, 0);
  count_.assign(first_.size(), 0);
  for (std::uint32_t k = 0; k < balls_.size(); ++k)
    if (count_[balls_[k].body]++ == 0) first_[balls_[k].body] = k;
}

void BallPairs::place_balls(const World& world) {
  placed_.resize(balls_.size());
  parallel_for(balls_.size(), [&](std::size_t k) {
    const BodyBall& ball = balls_[k];
    placed_[k] = {world.pose(ball.body).to_world(ball.centre), ball.radius};
  });
}

bool BallPairs::takes(const World& world, const Pair& p) const {
  const auto is = [&](Slot s, SphereRole role) { return role_[s] == role; };
  const auto is_round = [&](Slot s) { return is(s, SphereRole::sphere) || is(s, SphereRole::balls); };
  if (is_round(p.a) && is_round(p.b)) return true;
  return !world.cell && ((is(p.a, SphereRole::balls) && is(p.b, SphereRole::plane)) ||
                         (is(p.b, SphereRole::balls) && is(p.a, SphereRole::plane)));
}

std::span<const BallPairs::Placed> BallPairs::balls_of(const Call& call, Slot s, Placed& one) const {
  if (role_[s] == SphereRole::balls) return std::span(placed_).subspan(first_[s], count_[s]);
  one = {call.bodies.position(s), call.setup.shapes->of<Sphere>()[ShapeRef{call.world.shape[s]}.index()].radius};
  return {&one, 1};
}

Slot BallPairs::first_place(Slot s) const {
  return role_[s] == SphereRole::balls ? first_[s] : static_cast<Slot>(balls_.size()) + s;
}

template <class F>
void BallPairs::each_near(const Call& call, const Pair& p, const F& f) const {
  const auto& [world, setup, bodies, list] = call;
  Placed one_a, one_b;
  const auto balls_a = balls_of(call, p.a, one_a), balls_b = balls_of(call, p.b, one_b);
  const Slot place_a = first_place(p.a), place_b = first_place(p.b);
  const Vec3 shift = world.cell ? world.cell->shift(p.image) : Vec3(Vec3::Zero());
  const double apart = setup.reach + list.margin_of(p) + rounding_of(bodies.position(p.a), bodies.position(p.b));
  const bool forward = place_a < place_b;
  for (std::size_t i = 0; i < balls_a.size(); ++i) {
    const Vec3 from = balls_a[i].centre - shift;
    for (std::size_t j = 0; j < balls_b.size(); ++j) {
      const double far = balls_a[i].radius + balls_b[j].radius + apart;
      if ((balls_b[j].centre - from).squaredNorm() > far * far) continue;
      const Slot a = place_a + static_cast<Slot>(i), b = place_b + static_cast<Slot>(j);
      forward ? f(a, Partner{b, p.image}) : f(b, Partner{a, opposite_image(p.image)});
    }
  }
}

template <class F>
void BallPairs::each_on_plane(const Call& call, const Pair& p, const F& f) const {
  const auto& [world, setup, bodies, list] = call;
  const bool first = role_[p.a] == SphereRole::plane;
  const Slot plane = first ? p.a : p.b, body = first ? p.b : p.a;
  const std::vector<Slot>& planes = list.spheres.planes;
  const auto place = static_cast<Slot>(std::ranges::lower_bound(planes, plane) - planes.begin());
  const Vec3 normal =
      world.pose(plane).orientation * setup.shapes->of<HalfSpace>()[ShapeRef{world.shape[plane]}.index()].normal;
  const double apart = setup.reach + list.margin_of(p) + rounding_of(bodies.position(body), world.position[plane]);
  for (std::uint32_t k = first_[body]; k < first_[body] + count_[body]; ++k)
    if (normal.dot(placed_[k].centre - world.position[plane]) - placed_[k].radius <= apart)
      f(k, Partner{SpherePairs::plane | place, 0});
}

template <class F>
void BallPairs::each_ball_pair(const Call& call, const Pair& p, const F& f) const {
  if (!takes(call.world, p)) return;
  if (role_[p.a] == SphereRole::plane || role_[p.b] == SphereRole::plane)
    each_on_plane(call, p, f);
  else
    each_near(call, p, f);
}

/// The partners of the balls come before those of the bodies, whose places move up.
void BallPairs::join(std::size_t bodies, SpherePairs& list) {
  const auto balls = static_cast<std::uint32_t>(balls_.size()), own = begin_[balls];
  std::vector<std::uint32_t> first(balls + bodies + 1, own);
  std::copy_n(begin_.begin(), balls, first.begin());
  UnwrittenColumn<Slot> partner(own + list.partner.size());
  std::copy_n(partner_.begin(), own, partner.begin());
  if (!list.partner.empty()) parallel_for(bodies + 1, [&](std::size_t s) { first[balls + s] = own + list.first[s]; });
  parallel_for(list.partner.size(), [&](std::size_t k) {
    const Slot b = list.partner[k];
    partner[own + k] = (b & SpherePairs::plane) != 0 ? b : b + balls;
  });
  if (!image_.empty()) {
    UnwrittenColumn<std::uint32_t> image(partner.size(), 0);
    std::copy_n(image_.begin(), own, image.begin());
    std::ranges::copy(list.image, image.begin() + own);
    list.image.swap(image);
  }
  list.first.swap(first);
  list.partner.swap(partner);
}

void BallPairs::take(const World& world, const BroadSetup& setup, const FatBodies& bodies, bool same_bodies,
                     PairList& pairs) {
  if (!same_bodies || role_.size() != world.size()) read_bodies(world, setup);
  if (balls_.empty()) return;
  place_balls(world);
  const Call call{world, setup, bodies, pairs};
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k) each_ball_pair(call, pairs.pairs[k], f);
  };
  parallel_group(
      pairs.pairs.size(), balls_.size(), begin_, each,
      [&](std::size_t count) {
        renew(partner_, count);
        renew(image_, count);
      },
      [&](std::uint32_t place, const Partner& p) {
        partner_[place] = p.place;
        image_[place] = p.image;
      },
      64);
  parallel_for(balls_.size(), [&](std::size_t k) {
    sort_partners(partner_.data() + begin_[k], image_.data() + begin_[k], begin_[k + 1] - begin_[k]);
  });
  if (!world.cell) image_.clear();
  join(world.size(), pairs.spheres);
  drop_taken(world, pairs);
}

void BallPairs::take_more(const World& world, const BroadSetup& setup, const FatBodies& bodies, PairList& pairs) {
  role_.resize(world.size(), SphereRole::sphere);
  if (balls_.empty()) return;
  std::vector<std::pair<Slot, Slot>> more;
  for (const Pair& p : pairs.pairs)
    each_ball_pair({world, setup, bodies, pairs}, p, [&](Slot a, const Partner& b) { more.emplace_back(a, b.place); });
  std::ranges::sort(more);
  insert_pairs(more, balls_.size() + world.size(), pairs.spheres);
  drop_taken(world, pairs);
}

void BallPairs::drop_taken(const World& world, PairList& pairs) const {
  PairColumn rest;
  parallel_select(
      pairs.pairs.size(), [&](std::size_t k) { return !takes(world, pairs.pairs[k]); },
      [&](std::size_t k) { return pairs.pairs[k]; }, rest);
  pairs.pairs.swap(rest);
}

}  // namespace epafi
