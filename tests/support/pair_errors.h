/// @file pair_errors.h  Worst error of every cell of the pair table over random poses, by a method of its own.
/// The signed distance is the largest separation over all directions. The separation along the returned normal must be
/// the returned gap, and no direction found by climbing from there (a random search whose step shrinks from 0.3 to
/// 1e-9) may separate by more. Only the support functions of the shapes are shared with the code under test.
/// A mesh is the closed surface of a hull: seen from outside, and while less than a hundredth of the size is inside,
/// its distance is the hull's.
#pragma once
#include <chrono>

#include "detection/narrow/pairs/pair_table.h"
#include "tests/support/polyhedra.h"

namespace epafi::support {

struct PairError {
  std::string a, b, method;
  double worst = 0.0;        ///< of the gap, relative to the larger bounding radius
  double nanoseconds = 0.0;  ///< per pair, cold
  std::size_t pairs = 0, degenerate = 0;
};

inline TriangleMesh surface_of(const ConvexHull& h) {
  TriangleSurface surface{h.vertices, {}};
  for (std::size_t f = 0; f + 1 < h.face_begin.size(); ++f)
    for (std::uint32_t k = h.face_begin[f] + 1; k + 1 < h.face_begin[f + 1]; ++k)
      surface.triangles.push_back({h.face_vertices[h.face_begin[f]], h.face_vertices[k], h.face_vertices[k + 1]});
  return TriangleMesh::from_surface(surface);
}

template <class S>
S random_shape(Random& random) {
  const auto size = [&] { return random.uniform(0.3, 1.0); };
  const auto exponent = [&] { return 2 + static_cast<int>(random.uniform() * 7); };
  // drawn one after the other: compilers evaluate arguments in orders of their own
  const auto sizes = [&] {
    const double z = size(), y = size(), x = size();
    return Vec3(x, y, z);
  };
  if constexpr (std::is_same_v<S, Sphere>)
    return Sphere{size()};
  else if constexpr (std::is_same_v<S, HalfSpace>)
    return HalfSpace{};
  else if constexpr (std::is_same_v<S, ConvexHull>)
    return random_hull(random, 6 + static_cast<std::size_t>(random.uniform() * 20));
  else if constexpr (std::is_same_v<S, TriangleMesh>)
    return surface_of(random_hull(random, 6 + static_cast<std::size_t>(random.uniform() * 20)));
  else if constexpr (std::is_same_v<S, Superquadric>) {
    const int second = exponent(), first = exponent();
    return Superquadric(sizes(), first, second);
  } else if constexpr (std::is_constructible_v<S, double, double>) {
    const double second = size(), first = size();
    return S(first, second);
  } else
    return S(sizes());
}

/// max over the body of d.x, from its position [m]; d unit, world axes.
template <class S>
double reach_along(const S& s, const Pose& pose, const Vec3& d) {
  const Vec3 local = pose.orientation.conjugate() * d;
  if constexpr (MeshShape<S>) {
    double most = -infinity;
    for (const Vec3& v : s.vertices) most = std::max(most, local.dot(v));
    return most;
  } else {
    return local.dot(s.support(local)) + s.rounding();
  }
}

template <class A, class B>
double separation_along(const A& a, const Pose& pa, const B& b, const Pose& pb, const Vec3& n) {
  if constexpr (std::is_same_v<B, HalfSpace>)
    return (pb.orientation * b.normal).dot(pa.position - pb.position) -
           reach_along(a, pa, -(pb.orientation * b.normal));
  else if constexpr (std::is_same_v<A, HalfSpace>)
    return separation_along(b, pb, a, pa, n);
  else
    return n.dot(pb.position - pa.position) - reach_along(a, pa, n) - reach_along(b, pb, -n);
}

/// Largest separation that climbing from n finds; n: its direction afterwards.
template <class A, class B>
double climb(const A& a, const Pose& pa, const B& b, const Pose& pb, Vec3& n, Random& random) {
  double best = separation_along(a, pa, b, pb, n);
  for (double step = 0.3; step > 1e-9; step *= 0.9) {
    const Vec3 tried = (n + step * testing::random_direction(random)).normalized();
    if (const double s = separation_along(a, pa, b, pb, tried); s > best) {
      best = s;
      n = tried;
    }
  }
  return best;
}

/// Moves B out until less than a hundredth of the size overlaps.
template <class A, class B>
void lift_off(const A& a, const B& b, double size, World& world, Random& random) {
  Vec3 n = (world.position[1] - world.position[0]).normalized();
  const double apart = climb(a, world.pose(0), b, world.pose(1), n, random);
  if (apart < -0.01 * size) world.position[1] += (random.uniform(-0.01, 0.3) * size - apart) * n;
}

/// Worst of the gap along the normal given and of what other directions separate by; of the deepest point.
template <class A, class B>
double gap_error(const A& a, const B& b, const World& world, const ContactSet& contacts, Random& random) {
  std::size_t deepest = 0;
  for (std::size_t c = 1; c < contacts.size(); ++c)
    if (contacts.gap[c] < contacts.gap[deepest]) deepest = c;
  const double gap = contacts.gap.at(deepest);
  Vec3 n = contacts.normal[deepest];
  const Pose pa = world.pose(0), pb = world.pose(1);
  const double found = separation_along(a, pa, b, pb, n), best = climb(a, pa, b, pb, n, random);
  return std::max(std::abs(gap - found), best - gap);
}

/// The contacts of A, slot 0, with B, slot 1, from nothing: with the search for candidates where one is a mesh. Returns
/// how many were uncertain.
template <class A, class B>
std::size_t ask_cell(const ShapeStore& shapes, const World& world, double reach, ContactSet& contacts) {
  static const PairCell& cell = pair_table()[ShapeStore::type_of<A>()][ShapeStore::type_of<B>()];
  static std::vector<std::uint32_t> triangles, begin{0, 0};  // keep their size
  contacts.clear();
  triangles.clear();
  ContactSink sink(contacts);
  BatchInput in{.shapes = shapes,
                .world = world,
                .reach = reach,
                .curvature = false,
                .caches = {},
                .triangle_begin = {},
                .triangles = {}};
  const Pair pair{0, 1};
  if constexpr (MeshShape<A> || MeshShape<B>) {
    cell.candidates(in, pair, 0.0, triangles);
    begin[1] = static_cast<std::uint32_t>(triangles.size());
    in.triangles = triangles;
    in.triangle_begin = begin;
  }
  cell.batch(in, {&pair, 1}, sink);
  return sink.degenerate();
}

/// `count` random pairs, from deep overlap to a radius apart. timed: also ns.
template <class A, class B>
PairError measure_cell(Random& random, int count, bool timed) {
  const char* method = pair_table()[ShapeStore::type_of<A>()][ShapeStore::type_of<B>()].method;
  PairError out{A::name, B::name, method, 0.0, 0.0, 0, 0};
  for (int k = 0; k < count; ++k) {
    ShapeStore shapes;
    World world(Columns{.rotation = true, .force = false});
    const A a = random_shape<A>(random);
    const B b = random_shape<B>(random);
    const double ra = std::isfinite(a.bounding_radius()) ? a.bounding_radius() : 0.0,
                 rb = std::isfinite(b.bounding_radius()) ? b.bounding_radius() : 0.0;
    Body body;
    body.shape = shapes.add(a).packed;
    body.position = testing::random_point(random);
    body.orientation = testing::random_turn(random);
    world.add(body);
    body.shape = shapes.add(b).packed;
    body.position += random.uniform(0.2, 1.2) * (ra + rb) * testing::random_direction(random);
    body.orientation = testing::random_turn(random);
    world.add(body);
    constexpr bool mesh = MeshShape<A> || MeshShape<B>;
    if constexpr (mesh) lift_off(a, b, std::min(ra, rb), world, random);
    ContactSet contacts;
    const double reach = mesh ? 10.0 : 100.0;
    out.degenerate += ask_cell<A, B>(shapes, world, reach, contacts);
    out.worst = std::max(out.worst, gap_error(a, b, world, contacts, random) / std::max(ra, rb));
    ++out.pairs;
    if (!timed) continue;
    double least = infinity;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const auto start = std::chrono::steady_clock::now();
      for (int j = 0; j < 8; ++j) ask_cell<A, B>(shapes, world, reach, contacts);
      least = std::min(least,
                       std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / 8);
    }
    out.nanoseconds += least / count;
  }
  return out;
}

template <class A, class... S>
void measure_row(ShapeList<S...>, int count, bool timed, std::vector<PairError>& out) {
  const auto one = [&]<class B>(std::type_identity<B>) {
    // a mesh and a plane, or another mesh, never touch
    constexpr bool walls =
        (MeshShape<A> || std::is_same_v<A, HalfSpace>)&&(MeshShape<B> || std::is_same_v<B, HalfSpace>);
    constexpr bool parts =
        std::is_same_v<A, Clump> || std::is_same_v<B, Clump> ||          // spheres, tests/physics/test_clumps.cpp
        std::is_same_v<A, SolidParts> || std::is_same_v<B, SolidParts>;  // tests/physics/test_solids.cpp
    // a wheelset touches tracks only, at regions: tests/detection/test_track.cpp, test_profiles.cpp
    constexpr bool railway = std::is_same_v<A, WheelProfile> || std::is_same_v<B, WheelProfile> ||
                             std::is_same_v<A, RailProfile> || std::is_same_v<B, RailProfile>;
    // hollow walls are no convex bodies: tests/detection/test_hollow_walls.cpp
    constexpr bool hollow = HollowShape<A> || HollowShape<B>;
    if constexpr (!walls && !parts && !railway && !hollow) {
      Random random(301, out.size());  // of the cell: fewer draws are the first of more
      out.push_back(measure_cell<A, B>(random, count, timed));
    }
  };
  (one(std::type_identity<S>{}), ...);
}

template <class... S>
std::vector<PairError> measure_cells(ShapeList<S...> all, int count, bool timed) {
  std::vector<PairError> out;
  (measure_row<S>(all, count, timed, out), ...);
  return out;
}

}  // namespace epafi::support
