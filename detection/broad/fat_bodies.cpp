#include "detection/broad/fat_bodies.h"

#include <algorithm>
#include <cmath>

#include "engine/parallel_order.h"

namespace epafi {

namespace {
constexpr double least_margin =
    0.06;  // of the bounding radius: what a body at rest may creep; 0.04-0.2 cost the same within 10 %
constexpr double most_learned = 0.25;  // of spheres: the same where bodies at rest often begin to move
// A list of spheres costs 400 ns a body, a pair more per step 2.5 ns, and a margin larger by its radius 8 pairs: with a
// life L of the list that grows like the margin m, the sum is least at m L = 400/(2.5 8).
constexpr double best_share_times_life = 20.0;
constexpr double most_margin =
    2.0;  // of the bounding radius: for the few fast ones; with 0.5 what falls from a hopper asks for a list every
          // 14 steps, with 6 bodies near a mesh look at too many triangles
constexpr double giant_ratio =
    16.0;  // of the median radius: above, one box test per body is cheaper than one more grid level
constexpr std::size_t most_giants = 16;
constexpr double headroom = 1.25;                        // bodies speed up between rebuilds
constexpr double least_steps = 4.0, most_steps = 512.0;  // of one list

/// Distance by which a point of the body moves per second, at most [m/s].
double surface_speed(const World& world, Slot s, double turning_radius) {
  const double v = std::sqrt(world.velocity[s].squaredNorm());
  const double w2 = world.rotates() ? world.angular_velocity[s].squaredNorm() : 0.0;
  return w2 > 0.0 && turning_radius > 0.0 ? v + std::sqrt(w2) * turning_radius : v;
}
}  // namespace

bool FatBodies::near_plane(Slot i, std::size_t k) const {
  const Slot w = apart[k];
  const Vec3& n = plane_normal[k];
  const Vec3 to_ball = position(i) - position(w);
  double corner = -infinity;
  if (!boxes.empty()) corner = n.dot(boxes[i].centre() - position(w)) - n.cwiseAbs().dot(Vec3(0.5 * boxes[i].extent()));
  return std::max(corner, n.dot(to_ball) - ball[i].r) <= half[w];  // half of a half-space: its own fattening
}

FatBodies::FatBodies() : least_share_(least_margin) {}

void FatBodies::learn(const World& world, double step_time) {
  if (!boxes.empty() || !(step_time > 0.0) || world.size() != size()) return;  // pairs of other shapes cost more
  const auto is_slow = [&](std::size_t i) { return margin[i] <= 1.001 * least_share_ * radius[i]; };
  const bool by_slow_one = block_max<char>(size(), 0, [&](std::size_t i) {
                             return static_cast<char>(is_slow(i) && way(world, i) > 0.5 * margin[i]);
                           }) != 0;
  const double life = (world.time - taken_at_) / step_time, best = best_share_times_life / least_share_;
  if (by_slow_one && life < best)
    least_share_ = std::min(1.4 * least_share_, most_learned);
  else if (!by_slow_one || life > 2.0 * best)  // where fast bodies end the lists, margins of slow ones buy nothing
    least_share_ = std::max(least_share_ / 1.4, least_margin);
}

void FatBodies::update(const World& world, const BroadSetup& setup, double step_time) {
  taken_at_ = world.time;
  const std::size_t n = world.size();
  ball.resize(n), half.resize(n), radius.resize(n), margin.resize(n);
  id.resize(n), type.resize(n), immovable.resize(n);
  if (world.has_orientation()) orientation.resize(n);
  read_shapes(world, *setup.shapes);
  find_median_radius();
  choose_margins(world, setup, step_time);
  fatten(world, setup);
  set_apart(world, *setup.shapes);
}

void FatBodies::read_shapes(const World& world, const ShapeStore& shapes) {
  parallel_for(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    const ShapeRef ref{world.shape[s]};
    id[i] = static_cast<std::uint32_t>(world.id[s]), type[i] = ref.type();
    immovable[i] = !world.is_movable(s);
    radius[i] = shapes.bounding_radius(ref);
    if (world.has_orientation()) orientation[i] = world.orientation[s];
  });
}

/// Whether the last one still is: radii hardly ever change. A look at all by all threads, which to find it has not.
bool FatBodies::median_holds() const {
  const Sum3 seen = block_sum<Sum3>(size(), [&](std::size_t i) {
    if (immovable[i] || !std::isfinite(radius[i])) return Sum3{};
    return Sum3{radius[i] < median_radius_ ? 1.0 : 0.0, radius[i] <= median_radius_ ? 1.0 : 0.0, 1.0};
  });
  const double middle = std::floor(seen.c / 2.0);
  return seen.c > 0.0 && seen.a <= middle && middle < seen.b;
}

/// Works in `half`, which is written later.
void FatBodies::find_median_radius() {
  if (median_holds()) return;
  half.clear(), median_radius_ = 0.0;
  for (std::size_t i = 0; i < size(); ++i)
    if (!immovable[i] && std::isfinite(radius[i])) half.push_back(radius[i]);
  if (half.empty())
    for (double r : radius)
      if (std::isfinite(r)) half.push_back(r);
  const auto middle = half.begin() + static_cast<std::ptrdiff_t>(half.size() / 2);
  if (!half.empty()) std::nth_element(half.begin(), middle, half.end()), median_radius_ = *middle;
  half.resize(size());
}

void FatBodies::choose_margins(const World& world, const BroadSetup& setup, double step_time) {
  if (setup.margin > 0.0) {
    margin.assign(world.size(), setup.margin);
    return;
  }
  // A list that lasts K steps costs rebuild/K + K * (pairs that the margin adds): K = 1.6/sqrt(e), e the mean motion
  // per step in radii; perf/broad.cpp shows the minimum to be flat within a factor of two. Slow bodies keep their least
  // margin whatever K is, so that only the fast ones make the list longer.
  const Sum3 sum = block_sum<Sum3>(world.size(), [&](std::size_t i) {
    if (immovable[i] || !(radius[i] > 0.0)) return Sum3{};
    return Sum3{step_time * surface_speed(world, static_cast<Slot>(i), turning_radius(i)) / radius[i], 1.0, 0.0};
  });
  const double motion = sum.b > 0.0 ? sum.a / sum.b : 0.0;
  const double steps = motion > 0.0 ? std::clamp(1.6 / std::sqrt(motion), least_steps, most_steps) : most_steps;
  const double small = 4.0 * median_radius_;
  parallel_for(world.size(), [&](std::size_t i) {
    const double step = step_time * surface_speed(world, static_cast<Slot>(i), turning_radius(i));
    const double wanted = 2.0 * headroom * steps * step;
    if (!std::isfinite(wanted))
      margin[i] = 0.0;  // a turning half-space: its list lasts one step
    else if (immovable[i])
      margin[i] = std::min(wanted, most_margin * small);
    else
      margin[i] = std::clamp(wanted, least_share_ * std::min(radius[i], small), most_margin * radius[i]);
  });
}

void FatBodies::fatten(const World& world, const BroadSetup& setup) {
  const bool round = block_max<char>(size(), 0, [&](std::size_t i) {
                       return static_cast<char>(type[i] != ShapeStore::type_of<Sphere>() &&
                                                type[i] != ShapeStore::type_of<HalfSpace>());
                     }) == 0;
  boxes.resize(round ? 0 : world.size());
  parallel_for(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    const Vec3& x = world.position[s];
    // four units in the last place of the coordinate: far from the origin the box itself is rounded
    const double rounding = 0x1p-50 * x.cwiseAbs().maxCoeff();
    const double fat = 0.5 * (setup.reach + margin[i]) + rounding;
    if (!std::isfinite(radius[i])) {
      half[i] = fat, ball[i] = {x.x(), x.y(), x.z(), infinity};
      if (!round) boxes[i] = {Vec3::Constant(-infinity), Vec3::Constant(infinity)};
      return;
    }
    half[i] = radius[i] + fat, ball[i] = {x.x(), x.y(), x.z(), radius[i] + fat};
    if (round) return;
    boxes[i] = setup.shapes->bounding_box(world, s).fattened(fat);
    half[i] = std::max((boxes[i].max - x).maxCoeff(), (x - boxes[i].min).maxCoeff());
  });
}

void FatBodies::set_apart(const World& world, const ShapeStore& shapes) {
  const double giant = giant_ratio * median_radius_;
  const auto giants = block_sum<std::size_t>(
      size(), [&](std::size_t i) { return static_cast<std::size_t>(std::isfinite(radius[i]) && radius[i] > giant); });
  const bool giants_apart = giants <= most_giants;
  // a body that is nowhere has no neighbours: whoever watches the state reports it
  const auto is_somewhere = [&](std::size_t s) { return position(s).allFinite() && half[s] >= 0.0; };
  const auto is_apart = [&](std::size_t s) { return !std::isfinite(radius[s]) || (giants_apart && radius[s] > giant); };
  const auto slot = [](std::size_t s) { return static_cast<Slot>(s); };
  parallel_select(
      size(), [&](std::size_t s) { return is_somewhere(s) && !is_apart(s); }, slot, ordinary);
  parallel_select(
      size(), [&](std::size_t s) { return is_somewhere(s) && is_apart(s); }, slot, apart);
  plane_normal.clear();
  for (const Slot s : apart) {
    const ShapeRef ref{world.shape[s]};
    const bool plane = ref.type() == ShapeStore::type_of<HalfSpace>();
    plane_normal.push_back(plane ? Vec3(world.pose(s).orientation * shapes.of<HalfSpace>()[ref.index()].normal)
                                 : Vec3::Zero());
  }
}

bool FatBodies::outdated(const World& world) const {
  if (world.size() != size()) return true;
  const bool rotates = world.has_orientation();
  // a maximum is the same for every thread count
  return block_max<char>(size(), 0, [&](std::size_t i) {
           const double way = (world.position[i] - position(i)).squaredNorm(), allowed = 0.5 * margin[i];
           if (!rotates || !(turning_radius(i) > 0.0)) return static_cast<char>(way > allowed * allowed);
           // a turn by t moves a point at R by 2 R sin(t/2) <= 2 R |q - q0|, as |q - q0| = 2 sin(t/4)
           const double turn = (world.orientation[i].coeffs() - orientation[i].coeffs()).squaredNorm();
           return static_cast<char>(std::sqrt(way) + 2.0 * turning_radius(i) * std::sqrt(turn) > allowed);
         }) != 0;
}

/// Of the body's surface since update [m].
double FatBodies::way(const World& world, std::size_t i) const {
  const double straight = (world.position[i] - position(i)).norm();
  if (!world.has_orientation() || !(turning_radius(i) > 0.0)) return straight;
  return straight + 2.0 * turning_radius(i) * (world.orientation[i].coeffs() - orientation[i].coeffs()).norm();
}

double FatBodies::wear(const World& world) const {
  if (world.size() != size()) return infinity;
  return block_max<double>(size(), 0.0, [&](std::size_t i) {
    const double moved = way(world, i);
    return moved > 0.0 ? moved / (0.5 * margin[i]) : 0.0;
  });
}

double FatBodies::largest_margin() const {
  return block_max<double>(margin.size(), 0.0, [&](std::size_t i) { return margin[i]; });
}

}  // namespace epafi
