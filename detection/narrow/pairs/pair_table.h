/// @file pair_table.h  The generated matrix of batch functions, one cell per ordered pair of shape types.
/// A cell is, in this order: part by part, a closed form, the same with the bodies exchanged, a mesh pair, polyhedra,
/// the common normal of round shapes and of cylinders, GJK and EPA, or empty where the pair never touches.
/// tests/golden/pair_table.txt holds the method of every cell.
#pragma once
#include <array>
#include <string>
#include <type_traits>

#include "detection/narrow/mesh/mesh_pairs.h"
#include "detection/narrow/pairs/ball_parts.h"
#include "detection/narrow/pairs/capsule_sieve.h"
#include "detection/narrow/pairs/closed_forms.h"
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/narrow/pairs/pair_methods.h"
#include "detection/narrow/pairs/part_pairs.h"
#include "detection/narrow/pairs/superquadric_batch.h"
#include "detection/narrow/polyhedra/resting_patch.h"
#include "detection/shape_store.h"
#include "engine/lanes/prefetch.h"

namespace epafi {

/// Fixed body made of triangles: query(box in its axes, out) lists candidate triangles in ascending order, find_near
/// those of a body.
/// Its header offers collide_triangles(convex, mesh, triangles, query, sink) with the convex body as A.
template <class M>
concept MeshShape = requires(const M& m, const Aabb& box, std::vector<std::uint32_t>& out) {
  m.query(box, out);
};

/// Input of a batch.
struct BatchInput {
  const ShapeStore& shapes;
  const World& world;
  double reach;  ///< at most [m]
  bool curvature;
  std::span<PairCache> caches;                    ///< of the run's pairs, or empty
  std::span<const std::uint32_t> triangle_begin;  ///< CSR over the run's pairs, where the cell has candidates
  std::span<const std::uint32_t> triangles;
  bool area = false;
  std::span<const double> motion =
      {};                    ///< by slot: what a body may move in the step [m]; empty: the reach is the same for all
  double least_reach = 0.0;  ///< [m], with motion
  std::span<std::unique_ptr<RestingPatch>> resting = {};  ///< of the run's pairs, or empty; null: none is known
  std::span<PartMemory> parts = {};                       ///< of the run's pairs, or empty

  double reach_of(const Pair& p) const {
    return motion.empty() ? reach : std::clamp(motion[p.a] + motion[p.b], least_reach, reach);
  }
};

struct PairCell {
  /// Appends the contacts of a run of consecutive pairs of this cell.
  void (*batch)(const BatchInput&, std::span<const Pair>, ContactSink&) = nullptr;
  /// Appends the candidate triangles of a pair for a body that may move by `margin` [m]; null where there are none.
  void (*candidates)(const BatchInput&, const Pair&, double margin, std::vector<std::uint32_t>&) = nullptr;
  /// True where the bodies may touch after an approach of at most `margin` [m]; null: always assumed.
  bool (*near)(const BatchInput&, const Pair&, double margin) = nullptr;
  const char* method = "none";
  bool remembers = false;  ///< keeps a PairCache per pair
  bool parts = false;      ///< and a PartMemory
};

namespace pair_table_detail {

template <class A, class B>
concept HasClosedForm = requires(const A& a, const B& b, const PairQuery& q, ContactSink& s) {
  collide_closed(a, b, q, s);
};
template <class A, class B>
concept HasTriangles = MeshShape<B> &&
    requires(const A& a, const B& b, std::span<const std::uint32_t> t, const PairQuery& q, ContactSink& s) {
  collide_triangles(a, b, t, q, s);
};

inline PairQuery query_of(const BatchInput& in, const Pair& p, std::size_t k) {
  PairQuery q{in.world.pose(p.a),
              in.world.pose(p.b),
              in.reach_of(p),
              in.curvature,
              in.caches.empty() ? nullptr : &in.caches[k],
              in.area,
              in.resting.empty() ? nullptr : &in.resting[k],
              in.parts.empty() ? nullptr : &in.parts[k],
              !in.world.is_movable(p.a),
              !in.world.is_movable(p.b)};
  if (in.world.cell) q.b.position += in.world.cell->shift(p.image);
  return q;
}

/// Method of a pair. exchanged: by the function of (B, A); balls: both consist of balls; parts: convex parts, selected
/// by a search; parts_of_a, parts_of_b: every part is tested.
enum class PairMethod {
  balls,
  closed,
  closed_exchanged,
  triangles,
  triangles_exchanged,
  convex,
  parts,
  parts_of_a,
  parts_of_b,
  none
};

template <class A, class B>
constexpr PairMethod pair_method() {
  if constexpr (requires(const A& a, const B& b, const PairQuery& q, ContactSink& s) { collide_balls(a, b, q, s); }) {
    return PairMethod::balls;
  } else if constexpr (Compound<A> || Compound<B>) {
    constexpr PairMethod by = pair_method<PartOf<A>, PartOf<B>>();
    return by == PairMethod::none     ? by
           : by == PairMethod::convex ? PairMethod::parts
           : Compound<A>              ? PairMethod::parts_of_a
                                      : PairMethod::parts_of_b;
  } else if constexpr (HasClosedForm<A, B>) {
    return PairMethod::closed;
  } else if constexpr (HasClosedForm<B, A>) {
    return PairMethod::closed_exchanged;
  } else if constexpr (HasTriangles<A, B>) {
    return PairMethod::triangles;
  } else if constexpr (HasTriangles<B, A>) {
    return PairMethod::triangles_exchanged;
  } else {
    return ConvexShape<A> && ConvexShape<B> ? PairMethod::convex : PairMethod::none;
  }
}

/// f(part, pose, number) for the parts that may come near the other body.
template <class C, class B, class F>
void each_part(const C& whole, const Pose& pose, const B& other, const Pose& far, double reach, const F& f) {
  for (std::size_t k = 0; k < whole.part_count(); ++k) {
    const auto part = whole.part(k);
    const Pose at = whole.part_pose(k, pose);
    const double near = part.bounding_radius() + other.bounding_radius() + reach;
    if ((at.position - far.position).squaredNorm() <= near * near) f(part, at, k);
  }
}

/// Appends the contacts of one pair with the concrete shapes. triangles: candidates, where one of them is a mesh.
template <class A, class B>
void meet(const A& a, const B& b, const PairQuery& q, ContactSink& s, std::span<const std::uint32_t> triangles) {
  constexpr PairMethod by = pair_method<A, B>();
  if constexpr (by == PairMethod::closed_exchanged || by == PairMethod::triangles_exchanged)
    s.flip(q.b.position - q.a.position);
  if constexpr (by == PairMethod::balls) collide_balls(a, b, q, s);
  if constexpr (by == PairMethod::closed) collide_closed(a, b, q, s);
  if constexpr (by == PairMethod::closed_exchanged) collide_closed(b, a, q.exchanged(), s);
  if constexpr (by == PairMethod::triangles) collide_triangles(a, b, triangles, q, s);
  if constexpr (by == PairMethod::triangles_exchanged) collide_triangles(b, a, triangles, q.exchanged(), s);
  if constexpr (by == PairMethod::convex) collide(a, b, q, s);
  if constexpr (by == PairMethod::parts)
    each_part_pair(a, b, q, s, [&](const auto& x, const auto& y, const PairQuery& p) { collide(x, y, p, s); });
  if constexpr (by == PairMethod::parts_of_a) {
    each_part(a, q.a, b, q.b, q.reach, [&](const auto& part, const Pose& pose, std::size_t k) {
      const Vec3 offset = pose.position - q.a.position;
      s.enter_part(k, offset);
      meet(part, b, q.of_parts(pose, q.b), s, triangles);
      s.leave_part(offset);
    });
  }
  if constexpr (by == PairMethod::parts_of_b) {
    each_part(b, q.b, a, q.a, q.reach, [&](const auto& part, const Pose& pose, std::size_t k) {
      s.enter_part(k, Vec3::Zero());
      meet(a, part, q.of_parts(q.a, pose), s, triangles);
      s.leave_part(Vec3::Zero());
    });
  }
}

template <class Mesh, class Body>
void find_candidates(const BatchInput& in, const Pair& p, bool mesh_first, double margin,
                     std::vector<std::uint32_t>& out) {
  const Slot mesh = mesh_first ? p.a : p.b, body = mesh_first ? p.b : p.a;
  Pose pose_mesh = in.world.pose(mesh), pose_body = in.world.pose(body);
  if (in.world.cell) (mesh_first ? pose_body : pose_mesh).position += in.world.cell->shift(p.image);
  const Pose relative{pose_mesh.to_local(pose_body.position),
                      pose_mesh.orientation.conjugate() * pose_body.orientation};
  const Body& near = in.shapes.of<Body>()[ShapeRef{in.world.shape[body]}.index()];
  const Mesh& triangles = in.shapes.of<Mesh>()[ShapeRef{in.world.shape[mesh]}.index()];
  const std::size_t first = out.size();
  triangles.find_near(near, relative, margin + in.reach, out);
  drop_far(triangles, relative.position, near.bounding_radius() + margin + in.reach, first, out);
}

/// The box of a hollow wall contains everything inside it, but most of a filling is far from its surface.
template <class Wall, class Body>
bool is_near_wall(const BatchInput& in, const Pair& p, bool wall_first, double margin) {
  const Slot wall = wall_first ? p.a : p.b, body = wall_first ? p.b : p.a;
  const Wall& shape = in.shapes.of<Wall>()[ShapeRef{in.world.shape[wall]}.index()];
  const Body& near = in.shapes.of<Body>()[ShapeRef{in.world.shape[body]}.index()];
  Pose pose = in.world.pose(wall);
  Vec3 centre = in.world.position[body];
  if (in.world.cell) (wall_first ? centre : pose.position) += in.world.cell->shift(p.image);
  return shape.wall.distance(pose.to_local(centre)) <= near.bounding_radius() + margin + in.reach;
}

/// Prefetches the second bodies of the next pairs: the pointer to the shape two pairs ahead, its data one ahead.
/// Without this, 1000 stones wait for memory in a sixth of their narrow phase.
template <class B>
void look_ahead(const BatchInput& in, std::span<const Pair> pairs, std::size_t k) {
  const std::vector<B>& bs = in.shapes.of<B>();
  const auto second = [&](std::size_t i) -> const B& { return bs[ShapeRef{in.world.shape[pairs[i].b]}.index()]; };
  if (k + 2 < pairs.size()) prefetch(&second(k + 2), sizeof(B));
  if (k + 2 < pairs.size() && !in.resting.empty() && in.resting[k + 2])
    prefetch(in.resting[k + 2].get(), sizeof(RestingPatch));
  if (k + 1 >= pairs.size()) return;
  if (!in.resting.empty() && in.resting[k + 1] && in.resting[k + 1]->count > 0) return;  // at rest it is not read
  second(k + 1).prefetch();
  if (!in.caches.empty() && in.caches[k + 1].polyhedra) prefetch(in.caches[k + 1].polyhedra.get(), sizeof(PairMemory));
}

/// The pairs of a run, one after the other.
template <class A, class B>
void run_of(const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink) {
  const std::vector<A>& as = in.shapes.of<A>();
  const std::vector<B>& bs = in.shapes.of<B>();
  const auto ask = [&](std::size_t k) {
    const Pair& p = pairs[k];
    if constexpr (requires(const B& b) { b.prefetch(); }) look_ahead<B>(in, pairs, k);
    sink.begin(p.a, p.b, p.image >> 8);
    std::span<const std::uint32_t> triangles;
    if constexpr (MeshShape<A> || MeshShape<B>)
      triangles = in.triangles.subspan(in.triangle_begin[k], in.triangle_begin[k + 1] - in.triangle_begin[k]);
    meet(as[ShapeRef{in.world.shape[p.a]}.index()], bs[ShapeRef{in.world.shape[p.b]}.index()], query_of(in, p, k), sink,
         triangles);
    sink.end();
  };
  if constexpr (std::same_as<A, Capsule> && std::same_as<B, Capsule>) {
    for (const NearCapsules& c : near_capsules(in.world, as, pairs, [&](const Pair& p) { return in.reach_of(p); })) {
      if (!c.is_found) {
        ask(c.pair);
        continue;
      }
      const Pair& p = pairs[c.pair];
      sink.begin(p.a, p.b, p.image >> 8);
      sink.add(c.point);
    }
  } else if constexpr (std::same_as<A, Superquadric> && std::same_as<B, Superquadric>) {
    static thread_local SuperquadricBatch batch;
    const auto shape = [&](Slot s) -> const Superquadric& { return as[ShapeRef{in.world.shape[s]}.index()]; };
    for (std::size_t first = 0; first < pairs.size(); first += SuperquadricBatch::room) {
      const std::size_t end = std::min(pairs.size(), first + SuperquadricBatch::room);
      for (std::size_t k = first; k < end; ++k)
        batch.ask(k, shape(pairs[k].a), shape(pairs[k].b), query_of(in, pairs[k], k));
      batch.answer([&](std::size_t k) { sink.begin(pairs[k].a, pairs[k].b, pairs[k].image >> 8); }, sink);
    }
  } else {
    for (std::size_t k = 0; k < pairs.size(); ++k) ask(k);
  }
}

template <class A, class B>
constexpr const char* method_name() {
  if constexpr (Compound<A> || Compound<B>) return "parts";
  if constexpr (pair_method<A, B>() == PairMethod::triangles || pair_method<A, B>() == PairMethod::triangles_exchanged)
    return "mesh";
  if constexpr (pair_method<A, B>() == PairMethod::convex && quick_distance<A, B>() != nullptr) return "common-normal";
  if constexpr (pair_method<A, B>() == PairMethod::convex)
    return PolyhedralShape<A> && PolyhedralShape<B> ? "sat" : "gjk-epa";
  return "closed-form";
}

template <class A, class B>
constexpr PairCell make_cell() {
  if constexpr (pair_method<A, B>() == PairMethod::none) {
    return {};
  } else {
    PairCell cell{&run_of<A, B>,
                  nullptr,
                  nullptr,
                  method_name<A, B>(),
                  pair_method<A, B>() == PairMethod::convex || pair_method<A, B>() == PairMethod::parts,
                  pair_method<A, B>() == PairMethod::parts};
    if constexpr (HollowShape<A> || HollowShape<B>) {
      cell.near = [](const BatchInput& in, const Pair& p, double margin) {
        if constexpr (HollowShape<A>)
          return is_near_wall<A, B>(in, p, true, margin);
        else
          return is_near_wall<B, A>(in, p, false, margin);
      };
    }
    if constexpr (MeshShape<B>) {
      cell.candidates = [](const BatchInput& in, const Pair& p, double margin, std::vector<std::uint32_t>& out) {
        find_candidates<B, A>(in, p, false, margin, out);
      };
    } else if constexpr (MeshShape<A>) {
      cell.candidates = [](const BatchInput& in, const Pair& p, double margin, std::vector<std::uint32_t>& out) {
        find_candidates<A, B>(in, p, true, margin, out);
      };
    }
    return cell;
  }
}

template <class A, class... S>
constexpr std::array<PairCell, sizeof...(S)> make_row(ShapeList<S...>) {
  return {make_cell<A, S>()...};
}
template <class... S>
constexpr std::array<std::array<PairCell, sizeof...(S)>, sizeof...(S)> make_table(ShapeList<S...> all) {
  return {make_row<S>(all)...};
}

}  // namespace pair_table_detail

using PairTable = std::array<std::array<PairCell, AllShapes::size>, AllShapes::size>;

/// pair_table()[type_a][type_b]; compiled once, in pair_table.cpp.
const PairTable& pair_table();

}  // namespace epafi
