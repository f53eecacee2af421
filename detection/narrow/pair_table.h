/// @file pair_table.h  The generated matrix of batch functions, one cell per ordered pair of shape types.
/// A cell is, in this order: a closed form, the same with the bodies exchanged, a mesh pair, polyhedra, GJK and EPA, or
/// empty where the pair never touches. tests/golden/pair_table.txt holds the method of every cell.
#pragma once
#include <array>
#include <string>
#include <type_traits>

#include "detection/narrow/closed_forms.h"
#include "detection/narrow/convex_pairs.h"
#include "detection/narrow/mesh_pairs.h"
#include "detection/narrow/pair_methods.h"
#include "detection/shape_store.h"

namespace epafi {

/// Fixed body made of triangles: query(box in its axes, out) lists candidate triangles in ascending order.
/// Its header offers collide_triangles(convex, mesh, triangles, query, sink) with the convex body as A.
template <class M>
concept MeshShape = requires(const M& m, const Aabb& box, std::vector<std::uint32_t>& out) {
  m.query(box, out);
};

/// What a batch reads.
struct BatchInput {
  const ShapeStore& shapes;
  const World& world;
  double reach;
  bool curvature;
  std::span<PairCache> caches;                    ///< of the run's pairs, or empty
  std::span<const std::uint32_t> triangle_begin;  ///< CSR over the run's pairs, where the cell has candidates
  std::span<const std::uint32_t> triangles;
  bool area = false;
};

struct PairCell {
  /// Appends the contacts of a run of consecutive pairs of this cell.
  void (*batch)(const BatchInput&, std::span<const Pair>, ContactSink&) = nullptr;
  /// Appends the candidate triangles of a pair for a body that may move by `margin` [m]; null where there are none.
  void (*candidates)(const BatchInput&, const Pair&, double margin, std::vector<std::uint32_t>&) = nullptr;
  const char* method = "none";
  bool remembers = false;  ///< keeps a PairCache per pair
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
  return {in.world.pose(p.a), in.world.pose(p.b), in.reach, in.curvature, in.caches.empty() ? nullptr : &in.caches[k],
          in.area};
}
inline PairQuery exchanged(const PairQuery& q) { return {q.b, q.a, q.reach, q.curvature, nullptr, q.area}; }

/// One loop per cell: f(a, b, query, sink, k) with the concrete shapes.
template <class A, class B, class F>
void each_pair(const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink, const F& f) {
  const auto &as = in.shapes.of<A>(), &bs = in.shapes.of<B>();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Pair& p = pairs[k];
    sink.begin(p.a, p.b);
    f(as[ShapeRef{in.world.shape[p.a]}.index()], bs[ShapeRef{in.world.shape[p.b]}.index()], query_of(in, p, k), sink,
      k);
    sink.end();
  }
}

template <class Mesh, class Body>
void find_candidates(const BatchInput& in, Slot mesh, Slot body, double margin, std::vector<std::uint32_t>& out) {
  const Pose pose_mesh = in.world.pose(mesh), pose_body = in.world.pose(body);
  const Pose relative{pose_mesh.to_local(pose_body.position),
                      pose_mesh.orientation.conjugate() * pose_body.orientation};
  const Aabb box = in.shapes.of<Body>()[ShapeRef{in.world.shape[body]}.index()].bounding_box(relative);
  in.shapes.of<Mesh>()[ShapeRef{in.world.shape[mesh]}.index()].query(box.fattened(margin + in.reach), out);
}

template <class A, class B>
constexpr PairCell make_cell() {
  if constexpr (HasClosedForm<A, B>) {
    return {[](const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink) {
              each_pair<A, B>(in, pairs, sink,
                              [](const A& a, const B& b, const PairQuery& q, ContactSink& s, std::size_t) {
                                collide_closed(a, b, q, s);
                              });
            },
            nullptr, "closed-form"};
  } else if constexpr (HasClosedForm<B, A>) {
    return {[](const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink) {
              each_pair<A, B>(in, pairs, sink,
                              [](const A& a, const B& b, const PairQuery& q, ContactSink& s, std::size_t) {
                                s.flip(q.b.position - q.a.position);
                                collide_closed(b, a, exchanged(q), s);
                              });
            },
            nullptr, "closed-form"};
  } else if constexpr (HasTriangles<A, B>) {
    return {[](const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink) {
              each_pair<A, B>(
                  in, pairs, sink, [&in](const A& a, const B& b, const PairQuery& q, ContactSink& s, std::size_t k) {
                    collide_triangles(
                        a, b,
                        in.triangles.subspan(in.triangle_begin[k], in.triangle_begin[k + 1] - in.triangle_begin[k]), q,
                        s);
                  });
            },
            [](const BatchInput& in, const Pair& p, double margin, std::vector<std::uint32_t>& out) {
              find_candidates<B, A>(in, p.b, p.a, margin, out);
            },
            "mesh"};
  } else if constexpr (HasTriangles<B, A>) {
    return {[](const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink) {
              each_pair<A, B>(
                  in, pairs, sink, [&in](const A& a, const B& b, const PairQuery& q, ContactSink& s, std::size_t k) {
                    s.flip(q.b.position - q.a.position);
                    collide_triangles(
                        b, a,
                        in.triangles.subspan(in.triangle_begin[k], in.triangle_begin[k + 1] - in.triangle_begin[k]),
                        exchanged(q), s);
                  });
            },
            [](const BatchInput& in, const Pair& p, double margin, std::vector<std::uint32_t>& out) {
              find_candidates<A, B>(in, p.a, p.b, margin, out);
            },
            "mesh"};
  } else if constexpr (ConvexShape<A> && ConvexShape<B>) {
    return {[](const BatchInput& in, std::span<const Pair> pairs, ContactSink& sink) {
              each_pair<A, B>(
                  in, pairs, sink,
                  [](const A& a, const B& b, const PairQuery& q, ContactSink& s, std::size_t) { collide(a, b, q, s); });
            },
            nullptr, PolyhedralShape<A> && PolyhedralShape<B> ? "sat" : "gjk-epa", true};
  } else {
    return {};
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
