#include "detection/broad/fat_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
constexpr double least_margin =
    0.06;  // of the bounding radius: what a body at rest may creep; 0.04-0.2 cost the same within 10 %
constexpr double most_learned = 0.16;  // of spheres: the same where bodies at rest often begin to move; 0.25 is no
                                       // quicker and takes 12 bytes more of each of a million at their lists
// A list of spheres costs 300 ns a body, a pair more per step 2.5 ns, and a margin larger by its radius 8 pairs: with a
// life L of the list that grows like the margin m, the sum is least at m L = 300/(2.5 8).
constexpr double best_share_times_life = 15.0;
constexpr double most_margin =
    2.0;  // of the bounding radius: for the few fast ones; with 0.5 what falls from a hopper asks for a list every
          // 14 steps, with 6 bodies near a mesh look at too many triangles
constexpr double most_stray_margin = 1000.0;  // of the bounding radius: for so few that their pairs do not count
constexpr double most_strays = 1e-3;          // of all bodies, and 1 always
constexpr double most_common_motion =
    1.0;  // of the median radius, as long as a list lasts: what does not move has that margin
          // (filling hopper: 0.5 to 3 radii took 11.6, 10.9, 11.3, 12.2, 11.9 ns)
constexpr double least_common = 0.25;                    // of the mean motion: below, no frame halves it
constexpr double headroom = 1.25;                        // bodies speed up between rebuilds
constexpr double least_steps = 4.0, most_steps = 512.0;  // of one list

Vec3 mean_velocity(const World& world, const std::vector<char>& immovable) {
  const auto moves = [&](std::size_t i) { return !immovable[i] && world.velocity[i].allFinite(); };
  const Sum3 sum = block_sum<Sum3>(world.size(), [&](std::size_t i) {
    const Vec3 v = moves(i) ? world.velocity[i] : Vec3::Zero();
    return Sum3{v.x(), v.y(), v.z()};
  });
  const auto count = block_sum<std::size_t>(world.size(), [&](std::size_t i) { return std::size_t{moves(i)}; });
  return Vec3(sum.a, sum.b, sum.c) / std::max(1.0, static_cast<double>(count));
}

constexpr double most_spread = 4.0;  // of the root mean square along an axis: whoever is further off is a stray

/// Largest f(corner) of the box; -infinity where there is none.
template <class F>
double most_of_corners(const Aabb& box, const F& f) {
  double most = -infinity;
  if (!(box.min.array() <= box.max.array()).all()) return most;
  for (unsigned k = 0; k < 8; ++k) {
    const auto at = [&](int axis) { return (k >> axis & 1u) != 0 ? box.max[axis] : box.min[axis]; };
    most = std::max(most, f(Vec3(at(0), at(1), at(2))));
  }
  return most;
}

/// Flow velocity of a deforming cell at x [m/s].
Vec3 flow_at(const World& world, const Vec3& x) {
  return world.cell ? Vec3(world.cell->strain_rate.cwiseProduct(x - world.cell->low)) : Vec3(Vec3::Zero());
}

}  // namespace

/// Of the nearest corner of the box over the half-space [m].
double FatBodies::corner_depth(Slot i, const ApartPlane& p) const {
  return p.normal.dot(boxes[i].centre() - p.point) - p.normal.cwiseAbs().dot(Vec3(0.5 * boxes[i].extent()));
}

FatBodies::FatBodies() : most_margin_(most_margin), least_share_(least_margin) {}

void FatBodies::learn(const World& world, double step_time, bool used_up_by_slow) {
  if (!boxes.empty() || !(step_time > 0.0) || world.size() != bodies()) return;  // pairs of other shapes cost more
  const double life = (world.time - taken_at_) / step_time, best = best_share_times_life / least_share_;
  if (used_up_by_slow && life < best)
    least_share_ = std::min(1.4 * least_share_, most_learned);
  else if (!used_up_by_slow || life > 2.0 * best)  // where fast bodies end the lists, margins of slow ones buy nothing
    least_share_ = std::max(least_share_ / 1.4, least_margin);
}

void FatBodies::update(const World& world, const BroadSetup& setup, double step_time, bool same_bodies) {
  const double since = world.time - std::exchange(taken_at_, world.time);
  images.clear();
  if (!same_bodies) {
    read_shapes(world, setup);
    median_radius_ = median_radius(world, *setup.shapes);
  }
  if (world.cell) cell_size_ = world.cell->size;
  if (loose_planes_) look_around(world, *setup.shapes);
  const double steps = steps_ = choose_list_steps(world, setup, step_time, since);
  fatten(world, setup, step_time, steps);
  set_apart(world, *setup.shapes, same_bodies);
  set_planes(world, setup, step_time, steps);
  if (world.cell) add_images(world);
}

bool FatBodies::take_in(const World& world, const BroadSetup& setup, double step_time) {
  const std::size_t old = bodies(), n = world.size();
  const auto fits = [&](std::size_t i) {  // free spheres among many of their size: sources pour little else
    const double r = setup.shapes->bounding_radius({world.shape[i]});
    return ShapeRef{world.shape[i]}.type() == ShapeStore::type_of<Sphere>() && world.is_movable(static_cast<Slot>(i)) &&
           r <= giant_ratio * median_radius_ && world.position[i].allFinite();
  };
  if (n <= old || world.cell || type.size() != old || ball.size() != old || !complete_) return false;
  for (std::size_t i = old; i < n; ++i)
    if (!fits(i)) return false;
  const Vec3 common = common_motion_.displacement(world.time - taken_at_);
  const auto grow = [n](auto& column) {
    if (!column.empty()) column.resize(n);
  };
  grow(boxes);
  grow(half);
  grow(radius);
  grow(role);
  grow(orientation);
  resize_columns(n);
  for (std::size_t i = old; i < n; ++i) {
    const auto s = static_cast<Slot>(i);
    id[i] = static_cast<std::uint32_t>(world.id[s]);
    immovable[i] = 0;
    type[i] = static_cast<std::uint8_t>(ShapeStore::type_of<Sphere>());
    if (!role.empty()) role[i] = SphereRole::sphere;
    const double r = setup.shapes->bounding_radius({world.shape[i]});
    if (!radius.empty()) radius[i] = r;
    fatten_one(world, setup, s, margin_of(world, s, setup, step_time, steps_), world.position[s] - common);
    ordinary.push_back(s);
    if (loose_planes_) around.include(position(i));
  }
  return true;
}

/// The columns that every list has.
void FatBodies::resize_columns(std::size_t n) {
  ball.resize(n);
  inverse_half_margin.resize(n);
  slow_.resize(n);
  id.resize(n);
  type.resize(n);
  immovable.resize(n);
}

void FatBodies::read_shapes(const World& world, const BroadSetup& setup) {
  const std::size_t n = world.size();
  static_assert(AllShapes::size <= 256);
  ball.clear();  // no more than that: a large page is taken as a whole
  ball.reserve(n);
  resize_columns(n);
  // with images, pairs of spheres are separated from the others after they are named
  role.resize(setup.spheres.wanted && !world.cell ? n : 0);
  elsewhere.resize(world.owner.empty() || role.empty() ? 0 : n);
  parallel_for(n, [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    id[i] = static_cast<std::uint32_t>(world.id[s]);
    type[i] = static_cast<std::uint8_t>(ShapeRef{world.shape[s]}.type());
    immovable[i] = !world.is_movable(s);
    if (!role.empty()) role[i] = setup.spheres.of(world, s);
    if (!elsewhere.empty()) elsewhere[i] = world.owner[s] == World::elsewhere;
  });
  round_ = block_max<char>(n, 0, [&](std::size_t i) {
             return static_cast<char>(!is_sphere(i) && type[i] != ShapeStore::type_of<HalfSpace>());
           }) == 0;
  half.resize(round_ ? 0 : n);
  radius.resize(round_ ? 0 : n);
  parallel_for(radius.size(), [&](std::size_t i) { radius[i] = setup.shapes->bounding_radius({world.shape[i]}); });
  const auto any = [&](const auto& is) {
    return block_max<char>(n, 0, [&](std::size_t i) { return static_cast<char>(is(i)); }) != 0;
  };
  loose_planes_ = any([&](std::size_t i) { return is_loose_plane(i); });
  holds_bounded_ = any([&](std::size_t i) { return immovable[i] && !is_half_space(i); });
  most_radius_ = block_max<double>(radius.size(), 0.0,
                                   [&](std::size_t i) { return is_sphere(i) || is_half_space(i) ? 0.0 : radius[i]; });
}

/// Mean motion of the moving bodies relative to the common motion, in radii a step.
double FatBodies::mean_motion(const World& world, const BroadSetup& setup, double step_time) const {
  const Sum3 sum = block_sum<Sum3>(world.size(), [&](std::size_t i) {
    const double r = radius_of(world, *setup.shapes, i);
    if (immovable[i] || !(r > 0.0)) return Sum3{};
    const double speed = speed_of(world, static_cast<Slot>(i), *setup.shapes, common_motion_.velocity);
    return Sum3{step_time * speed / r, 1.0, 0.0};
  });
  return sum.b > 0.0 ? sum.a / sum.b : 0.0;
}

/// Returns the intended lifetime of the list in steps. since: time since the last update [s].
double FatBodies::choose_list_steps(const World& world, const BroadSetup& setup, double step_time, double since) {
  // A list that lasts K steps costs rebuild/K + K * (pairs that the margin adds): K = 1.6/sqrt(e), e the mean motion
  // per step in radii; perf/broad.cpp shows the minimum to be flat within a factor of two. Slow bodies keep their least
  // margin whatever K is, so that only the fast ones make the list longer.
  const auto best_steps = [](double motion) {
    return motion > 0.0 ? std::clamp(1.6 / std::sqrt(motion), least_steps, most_steps) : most_steps;
  };
  common_motion_ = {};
  const double motion = setup.margin > 0.0 ? 0.0 : mean_motion(world, setup, step_time);
  if (!(motion > 0.0)) {
    knows_mean_ = false;
    return best_steps(motion);
  }
  const Vec3 mean = mean_velocity(world, immovable);
  const bool has_last = std::exchange(knows_mean_, true) && since > 0.0;
  const Vec3 last = std::exchange(mean_velocity_, mean);
  if (!(step_time * mean.norm() > least_common * motion * median_radius_)) return best_steps(motion);
  common_motion_ = {mean, has_last ? Vec3((mean - last) / since) : Vec3::Zero()};
  const double rest = mean_motion(world, setup, step_time);
  if (!(rest < 0.5 * motion)) {
    common_motion_ = {};
    return best_steps(motion);
  }
  double steps = best_steps(rest);
  while (steps > least_steps &&
         common_motion_.displacement(headroom * steps * step_time).norm() > most_common_motion * median_radius_)
    steps *= 0.9;
  return steps;
}

/// steps: intended lifetime of the list for fast bodies.
double FatBodies::margin_of(const World& world, Slot s, const BroadSetup& setup, double step_time, double steps) const {
  if (setup.margin > 0.0) return setup.margin;
  const double radius = radius_of(world, *setup.shapes, s);
  const Vec3 frame =
      common_motion_.velocity_at(immovable[s] ? 0.5 * steps * step_time : 0.0);  // the others fall with it
  const double step = step_time * speed_of(world, s, *setup.shapes, frame), small = 4.0 * median_radius_;
  const double wanted = 2.0 * headroom * steps * step;
  if (!std::isfinite(wanted)) return 0.0;
  // rounding moves the axis of a wall that turns about it: in most poses the list would last a step
  const double rounding = is_hollow(s) && wanted > 0.0 ? 1e-9 * turning_radius(s) : 0.0;
  if (immovable[s]) return std::min(std::max(wanted, rounding), most_margin * small);
  return std::clamp(wanted, least_share_ * std::min(radius, small), most_margin_ * radius);
}

/// Enlargement of the exact bound of a body on every side [m].
double FatBodies::fattening(const World& world, Slot s, const BroadSetup& setup, double margin) {
  // four units in the last place of the coordinate: far from the origin the box itself is rounded
  return 0.5 * (setup.reach + margin) + 0x1p-50 * world.position[s].cwiseAbs().maxCoeff();
}

/// x: where the body is in the frame of the list [m].
void FatBodies::fatten_one(const World& world, const BroadSetup& setup, Slot s, double margin, const Vec3& x) {
  const double r = radius_of(world, *setup.shapes, s);
  inverse_half_margin[s] = 2.0 < margin * double{largest_inverse_half_margin}
                               ? static_cast<float>((1.0 + 0x1p-23) * 2.0 / margin)
                               : largest_inverse_half_margin;
  slow_[s] = std::isfinite(r) && margin <= 1.001 * least_share_ * r;
  if (world.has_orientation()) orientation[s] = world.orientation[s];
  const double fat = fattening(world, s, setup, margin);
  ball[s] = {x.x(), x.y(), x.z(), r + fat};
  if (round_) return;
  if (!std::isfinite(r)) {
    half[s] = fat;
    boxes[s] = {Vec3::Constant(-infinity), Vec3::Constant(infinity)};
    return;
  }
  const Vec3 shift = x - world.position[s];
  boxes[s] = setup.shapes->bounding_box(world, s).fattened(fat);
  boxes[s].min += shift;
  boxes[s].max += shift;
  half[s] = std::max((boxes[s].max - x).maxCoeff(), (x - boxes[s].min).maxCoeff());
}

void FatBodies::fatten(const World& world, const BroadSetup& setup, double step_time, double steps) {
  boxes.resize(round_ ? 0 : world.size());
  orientation.resize(world.has_orientation() ? world.size() : 0);
  most_margin_ = most_margin;
  // true: the body may need a larger one
  const auto fatten_body = [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    const double margin = margin_of(world, s, setup, step_time, steps);
    fatten_one(world, setup, s, margin, world.position[s]);
    return !immovable[s] && margin >= most_margin * radius_of(world, *setup.shapes, s);
  };
  const auto swift = block_sum<std::size_t>(world.size(), [&](std::size_t i) { return std::size_t{fatten_body(i)}; });
  // A single fast body would need a new list every few steps, at five times the cost for all others. If few bodies are
  // that fast, they get as large a margin as they need; not in a cell, where the images of all bodies would stand in so
  // large a region.
  if (setup.strays && !world.cell &&
      static_cast<double>(swift) <= std::max(1.0, most_strays * static_cast<double>(world.size()))) {
    most_margin_ = most_stray_margin;
    if (swift > 0) parallel_for(world.size(), [&](std::size_t i) { fatten_body(i); });
  }
  if (!world.cell) return;
  strain_over_half_margin_ = block_max<double>(world.size(), 0.0, [&](std::size_t i) {
    const double size = std::max(ball[i].r, half_of(i));
    return std::isfinite(radius_of(world, *setup.shapes, i)) && size > 0.0 ? size * double{inverse_half_margin[i]}
                                                                           : 0.0;
  });
}

void FatBodies::set_apart(const World& world, const ShapeStore& shapes, bool same_bodies) {
  // a body at a position that is not finite has no neighbours; the checks of the state report it
  const auto is_somewhere = [&](std::size_t s) { return position(s).allFinite() && half_of(s) >= 0.0; };
  const bool all = block_max<char>(size(), 0, [&](std::size_t s) { return static_cast<char>(!is_somewhere(s)); }) == 0;
  for (std::vector<Slot>* const list : {&ordinary, &apart})  // images stood behind the bodies
    list->erase(std::ranges::lower_bound(*list, static_cast<Slot>(size())), list->end());
  if (same_bodies && all && complete_) return;
  complete_ = all;
  const auto radius_at = [&](std::size_t s) { return radius_of(world, shapes, s); };
  const double largest = largest_ordinary(size(), median_radius_, radius_at);
  const auto is_apart = [&](std::size_t s) { return !(radius_at(s) <= largest); };
  const auto slot = [](std::size_t s) { return static_cast<Slot>(s); };
  parallel_select(
      size(), [&](std::size_t s) { return is_somewhere(s) && !is_apart(s); }, slot, ordinary);
  parallel_select(
      size(), [&](std::size_t s) { return is_somewhere(s) && is_apart(s); }, slot, apart);
  const auto is_sphere = [&](Slot s) { return role[s] == SphereRole::sphere; };
  ordered_spheres = !role.empty() && std::ranges::all_of(ordinary, is_sphere) && std::ranges::none_of(apart, is_sphere);
  only_spheres = ordered_spheres && std::ranges::all_of(apart, [&](Slot s) { return role[s] == SphereRole::plane; });
}

void FatBodies::set_planes(const World& world, const BroadSetup& setup, double step_time, double steps) {
  plane.clear();
  sphere_planes.clear();
  for (const Slot s : apart) {
    ApartPlane& p = plane.emplace_back();
    if (type[s] != ShapeStore::type_of<HalfSpace>()) continue;
    p.normal = world.pose(s).orientation * setup.shapes->of<HalfSpace>()[ShapeRef{world.shape[s]}.index()].normal;
    p.point = position(s);
    p.reach = fattening(world, s, setup, margin_of(world, s, setup, step_time, steps));
    p.loose = is_loose_plane(s);
    if (role.empty() || role[s] != SphereRole::plane) continue;
    p.place = SpherePairs::plane | static_cast<Slot>(sphere_planes.size());
    sphere_planes.push_back(s);
  }
}

/// True if its surface has moved by more than half its margin. A rotation by t moves a point at R by 2 R sin(t/2) <= 2
/// R |q - q0|, since |q - q0| = 2 sin(t/4).
inline bool FatBodies::is_beyond(const World& world, std::size_t i, bool rotates, const ListFrame& now) const {
  if (is_loose_plane(i)) return false;  // plane_use says it
  const double moved = now.growth() * displacement(i, now.back(world.position[i]));
  const double allowed = half_margin(i) * (1.0 - now.strain_use);
  if (moved > allowed || !rotates || !(turning_radius(i) > 0.0)) return moved > allowed;
  if (is_hollow(i)) {
    const Vec3 axis_moved = world.orientation[i] * Vec3::UnitZ() - orientation[i] * Vec3::UnitZ();
    return moved + turning_radius(i) * axis_moved.norm() > allowed;
  }
  const double turn = (world.orientation[i].coeffs() - orientation[i].coeffs()).norm();
  return turn > 0.0 && moved + 2.0 * turning_radius(i) * turn > allowed;  // a half-space that never moves: infinite
}

ListFrame FatBodies::frame(const World& world) const {
  ListFrame now;
  now.common = common_motion_.displacement(world.time - taken_at_);
  if (!world.cell) return now;
  now.take_cell(*world.cell, cell_size_);
  if (now.flows()) now.strain_use = now.strain * strain_over_half_margin_;
  return now;
}

ListState FatBodies::used_up(const World& world) const {
  if (world.size() != bodies()) return {true, false};
  const auto any = [&](const auto& f) {
    return block_max<char>(bodies(), 0, [&](std::size_t i) { return static_cast<char>(f(i)); }) != 0;
  };
  const bool rotates = world.has_orientation();
  const ListFrame now = frame(world);
  const bool bodies_beyond = any([&](std::size_t i) { return is_beyond(world, i, rotates, now); });
  if (!bodies_beyond) return {plane_use(world, now) > 1.0, false};
  return {true, any([&](std::size_t i) { return slow_[i] != 0 && is_beyond(world, i, rotates, now); })};
}

double FatBodies::largest_margin(std::size_t first) const {
  return block_max<double>(inverse_half_margin.size() - first, 0.0,
                           [&](std::size_t i) { return 2.0 * half_margin(first + i); });
}

// --- half-spaces that move: the distance of a point from a plane changes by an affine function of the point, so its
// extremes over a box are at the corners. A rotating plane moves at any speed far away, but only the box around the
// bodies matters.

/// Finds the box of the free bodies, except distant ones, which every such half-space lists.
void FatBodies::look_around(const World& world, const ShapeStore& shapes) {
  const auto counts = [&](std::size_t i) {
    return !immovable[i] && world.position[i].allFinite() && std::isfinite(shapes.bounding_radius({world.shape[i]}));
  };
  const auto sum = [&](const auto& of) {
    const Sum3 all = block_sum<Sum3>(world.size(), [&](std::size_t i) {
      const Vec3 x = counts(i) ? Vec3(of(i)) : Vec3(Vec3::Zero());
      return Sum3{x.x(), x.y(), x.z()};
    });
    return Vec3(all.a, all.b, all.c);
  };
  const auto count =
      static_cast<double>(block_sum<std::size_t>(world.size(), [&](std::size_t i) { return std::size_t{counts(i)}; }));
  around = {};
  if (!(count > 0.0)) return;
  const Vec3 mean = sum([&](std::size_t i) { return Vec3(world.position[i]); }) / count;
  const Vec3 square = sum([&](std::size_t i) { return Vec3((world.position[i] - mean).cwiseAbs2()); }) / count;
  const Vec3 spread = most_spread * square.cwiseSqrt();
  struct Box {
    Aabb all;
    Box& operator+=(const Box& o) {
      all.include(o.all);
      return *this;
    }
  };
  around = block_sum<Box>(world.size(), [&](std::size_t i) {
             Box one;
             if (counts(i) && ((world.position[i] - mean).array().abs() <= spread.array()).all())
               one.all.include(world.position[i]);
             return one;
           }).all;
}

/// Largest speed of approach or retreat relative to a body that follows the common motion [m/s].
double FatBodies::plane_speed(const World& world, Slot s, const ShapeStore& shapes, const Vec3& common_motion) const {
  if (!is_loose_plane(s)) return world.velocity[s].norm() + common_motion.norm();
  const Vec3 n = world.pose(s).orientation * shapes.of<HalfSpace>()[ShapeRef{world.shape[s]}.index()].normal;
  const Vec3 turning = world.rotates() ? Vec3(Vec3(world.angular_velocity[s]).cross(n)) : Vec3(Vec3::Zero());
  const Vec3 point = world.position[s], velocity = common_motion - world.velocity[s];
  const double most = most_of_corners(
      around, [&](const Vec3& x) { return std::abs(turning.dot(x - point) + n.dot(velocity + flow_at(world, x))); });
  return std::max(most, 0.0) + most_radius_ * turning.norm();
}

/// Distance by which a point of the body moves per second beside the common_motion and the flow of the cell, at most
/// [m/s].
double FatBodies::speed_of(const World& world, Slot s, const ShapeStore& shapes, const Vec3& common_motion) const {
  if (is_half_space(s)) return plane_speed(world, s, shapes, common_motion);
  const double turned = turning_radius(s);
  Vec3 beside = world.velocity[s] - common_motion;
  if (immovable[s] && world.cell) beside -= flow_at(world, world.position[s]);
  const double v = std::sqrt(beside.squaredNorm());
  double w2 = world.rotates() ? world.angular_velocity[s].squaredNorm() : 0.0;
  if (w2 > 0.0 && is_hollow(s))
    w2 = Vec3(world.angular_velocity[s]).cross(world.orientation[s] * Vec3::UnitZ()).squaredNorm();
  const double moves = w2 > 0.0 && turned > 0.0 ? v + std::sqrt(w2) * turned : v;
  return world.cell ? moves + world.cell->strain_rate.cwiseAbs().maxCoeff() * radius_of(world, shapes, s) : moves;
}

double FatBodies::plane_use(const World& world, const ListFrame& now) const {
  double most = 0.0;
  for (std::size_t k = 0; k < plane.size(); ++k) {
    const ApartPlane& p = plane[k];
    if (!p.is_plane() || !p.loose) continue;
    const Slot s = apart[k];
    const bool turns = world.has_orientation();
    const Quat turn = turns ? Quat(world.orientation[s] * orientation[s].conjugate()) : Quat(1, 0, 0, 0);
    const Vec3 n = turns && world.orientation[s].coeffs() != orientation[s].coeffs() ? Vec3(turn * p.normal) : p.normal;
    const Vec3 point = world.position[s];
    // put back into the cell it is the same plane, but its pairs are named by how often it was
    for (Eigen::Index axis = 0; world.cell && axis < 3; ++axis)
      if (world.cell->repeats[static_cast<std::size_t>(axis)] &&
          std::abs(point[axis] - p.point[axis]) > 0.5 * world.cell->size[axis])
        return infinity;
    const double nearer = most_of_corners(around, [&](const Vec3& x) {
      return (p.normal - n).dot(x - p.point) + n.dot(Vec3(point - p.point - now.way_from(x)));
    });
    const double beyond = nearer + most_radius_ * (n - p.normal).norm();
    most = std::max(most, beyond * double{inverse_half_margin[s]});
  }
  return most;
}

}  // namespace epafi
