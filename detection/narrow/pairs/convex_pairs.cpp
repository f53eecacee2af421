#include "detection/narrow/pairs/convex_pairs.h"

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/pairs/flat_patch.h"
#include "detection/narrow/pairs/hertz_radius.h"
#include "detection/narrow/polyhedra/overlap_cells.h"
#include "detection/narrow/polyhedra/resting_patch.h"

namespace epafi {
namespace {

constexpr double certain = 1e-6;  // of the size: a wider interval than this is reported as degenerate

void remember(const PairQuery& q, const Vec3& normal_in_a) {
  if (q.cache) q.cache->axis = q.a.orientation * normal_in_a;
}

/// The nearest (deepest) points of a pair of cores, in A's axes.
struct CoreContact {
  double gap = 0.0;  ///< sweeps taken off [m]
  Vec3 normal, middle;
};

void add_core_contact(const CoreContact& c, double radius, const PairQuery& q, ContactSink& sink) {
  const Mat3 to_world = q.a.orientation.toRotationMatrix();
  sink.add({c.gap, to_world * c.normal, to_world * c.middle, radius, 0});
}

/// R* of a contact [m]; rotation: B's axes in A's. 0 where no law asks for it.
double radius_at(const CoreContact& c, const Mat3& rotation, const RoundedPair& r, const PairQuery& q) {
  if (!q.curvature) return 0.0;
  return pair_radius(r.radius_a, r.radius_b, c.normal, -(rotation.transpose() * c.normal), q);
}

/// From the nearest points of the cores to those of the rounded bodies.
CoreContact rounded_contact(double core_gap, const Vec3& normal, const Vec3& on_a, const Vec3& on_b,
                            const RoundedPair& r) {
  return {core_gap - r.sweep_a - r.sweep_b, normal, 0.5 * (on_a + on_b) + 0.5 * (r.sweep_a - r.sweep_b) * normal};
}

/// By GJK of what is left of the cores after peeling: overlaps shallower than the peel are distances there.
CommonNormal peeled_distance(const CorePair& cores, const MinkowskiDifference& difference, double limit) {
  const PeeledCore &a = cores.peeled_a, &b = cores.peeled_b;
  const MinkowskiDifference inner(a.inner, b.inner, difference.rotation, difference.offset);
  const double peel = a.peel + b.peel;
  const GjkResult g = gjk(inner, {limit + peel + 1e-12 * difference.size(), 1e-14, Vec3::Zero()});
  const bool beyond = g.status == GjkResult::Status::beyond;
  if (!beyond && g.status != GjkResult::Status::separated) return {};
  return {beyond ? CommonNormal::Status::beyond : CommonNormal::Status::found,
          g.lower - peel,
          g.normal,
          g.witness_a + a.peel * g.normal,
          g.witness_b - b.peel * g.normal,
          g.iterations};
}

CommonNormal quick_answer(const CorePair& cores, const MinkowskiDifference& difference, double limit) {
  if (cores.quick) return cores.quick(cores.a.shape, cores.b.shape, difference.rotation, difference.offset, limit);
  if (cores.peeled_a.peel + cores.peeled_b.peel > 0.0) return peeled_distance(cores, difference, limit);
  return {};
}

/// A pair that touches has no axis that keeps it apart: none is tried in the next step.
bool is_near(const CoreContact& c, const PairQuery& q) {
  const bool near = c.gap < q.reach;
  if (near && q.cache) q.cache->axis.setZero();
  return near;
}

/// False where they are farther apart than the reach.
bool find_nearest(const CorePair& cores, const MinkowskiDifference& difference, const RoundedPair& r,
                  const PairQuery& q, ContactSink& sink, CoreContact& out, const CommonNormal* known = nullptr) {
  const double limit = quick_limit(r, q);
  const double size = difference.size() + std::max(r.sweep_a, r.sweep_b);
  const CommonNormal c = known ? *known : quick_answer(cores, difference, limit);
  if (c.status != CommonNormal::Status::uncertain) {
    remember(q, c.normal);
    out = rounded_contact(c.gap, c.normal, c.on_a, c.on_b, r);
    return is_near(out, q);
  }
  const GjkResult g = gjk(difference, {limit + 1e-12 * size, 1e-14, Vec3::Zero()});
  remember(q, g.normal);
  if (g.status == GjkResult::Status::beyond) return false;
  double core = g.lower;
  Vec3 n = g.normal, on_a = g.witness_a, on_b = g.witness_b;
  double uncertainty = g.upper - g.lower;
  if (g.status == GjkResult::Status::overlapping) {
    const Penetration p = epa(difference);
    core = -p.upper;
    n = p.normal;
    on_a = p.witness_a;
    on_b = p.witness_b;
    uncertainty = p.upper - p.lower;
  }
  if (uncertainty > certain * size) sink.mark_degenerate();
  out = rounded_contact(core, n, on_a, on_b, r);
  return is_near(out, q);
}

double smaller(const CorePair& cores, const RoundedPair& r) {
  return std::min(cores.a.radius + r.sweep_a, cores.b.radius + r.sweep_b);
}

}  // namespace

void collide_cores(const CorePair& cores, const RoundedPair& r, const PairQuery& q, ContactSink& sink) {
  const MinkowskiDifference difference(cores.a, cores.b, q.a, q.b);
  CoreContact c;
  if (!find_nearest(cores, difference, r, q, sink, c)) return;
  add_core_contact(c, radius_at(c, difference.rotation, r, q), q, sink);
}

void collide_round(const CorePair& cores, const RoundRef& a, const RoundRef& b, const RoundedPair& r,
                   const PairQuery& q, ContactSink& sink, const CommonNormal* known) {
  const MinkowskiDifference difference(cores.a, cores.b, q.a, q.b);
  CoreContact c;
  if (!find_nearest(cores, difference, r, q, sink, c, known)) return;
  const double radius = q.curvature ? hertz_radius(a, r.sweep_a, b, r.sweep_b, difference.rotation, c.normal) : 0.0;
  add_core_contact(c, radius, q, sink);
}

void collide_flat_core(const CorePair& cores, const FlatCore& sides, const RoundedPair& r, const PairQuery& q,
                       ContactSink& sink) {
  const MinkowskiDifference difference(cores.a, cores.b, q.a, q.b);
  CoreContact c;
  if (!find_nearest(cores, difference, r, q, sink, c)) return;
  const bool first = sides.polyhedron_first;
  const Mat3 &turn = difference.rotation, back = turn.transpose();
  const CoreAndPolyhedron pair{
      sides.polyhedron, first ? turn : back, first ? difference.offset : Vec3(-(back * difference.offset)),
      sides.shape,      sides.facing,        smaller(cores, r)};
  const NearestPoint nearest = first ? NearestPoint{c.middle, c.normal, c.gap}
                                     : NearestPoint{back * (c.middle - difference.offset), -(back * c.normal), c.gap};
  const Patch patch = core_patch(pair, nearest, q.reach, first ? r.sweep_a : r.sweep_b, first ? r.sweep_b : r.sweep_a);
  const Mat3 to_world = q.a.orientation.toRotationMatrix();
  const double radius = radius_at(c, difference.rotation, r, q);
  for (int k = 0; k < patch.count; ++k) {
    const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
    const Vec3 x = first ? p.position : Vec3(turn * p.position + difference.offset);
    sink.add({p.gap, to_world * c.normal, to_world * x, radius, p.feature});
  }
}

void collide_flat_pair(const CorePair& cores, const FlatSides& sides, const RoundedPair& r, const PairQuery& q,
                       ContactSink& sink) {
  const MinkowskiDifference difference(cores.a, cores.b, q.a, q.b);
  CoreContact c;
  if (!find_nearest(cores, difference, r, q, sink, c)) return;
  FlatPair pair{sides.facing_a(cores.a.shape, c.normal),
                sides.facing_b(cores.b.shape, -(difference.rotation.transpose() * c.normal)), smaller(cores, r),
                r.sweep_a, r.sweep_b};
  for (int k = 0; k < pair.b.count; ++k) {
    Vec3& x = pair.b.corner[static_cast<std::size_t>(k)];
    x = difference.rotation * x + difference.offset;
  }
  const Patch patch = flat_patch(pair, {c.middle, c.normal, c.gap}, q.reach);
  const Mat3 to_world = q.a.orientation.toRotationMatrix();
  const double radius = radius_at(c, difference.rotation, r, q);
  for (int k = 0; k < patch.count; ++k) {
    const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
    sink.add({p.gap, to_world * c.normal, to_world * p.position, radius, p.feature});
  }
}

namespace {

void add_patch(const PairQuery& q, const Patch& patch, const Vec3& normal, double radius, ContactSink& sink) {
  const Mat3 to_world = q.a.orientation.toRotationMatrix();
  const Vec3 n = to_world * normal;
  for (int k = 0; k < patch.count; ++k) {
    const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
    sink.add({p.gap, n, to_world * p.position, radius, p.feature});
  }
}

}  // namespace

void leave_rest(const PairQuery& q) {
  if (q.resting && *q.resting) (*q.resting)->count = 0;
}

void collide_polyhedra(const PolyhedronView& a, const PolyhedronView& b, const RoundedPair& r, const PairQuery& q,
                       ContactSink& sink) {
  const double limit = q.area ? 0.0 : q.reach + r.sweep_a + r.sweep_b;  // an area is that of an overlap
  const PolyhedronPair pair(a, b, q.a, q.b);
  const double radius = q.curvature ? radius_of_flats(r.radius_a, r.radius_b, q) : 0.0;
  if (q.resting && *q.resting) {
    RestingPatch& resting = **q.resting;
    Patch patch;
    Vec3 normal;
    if (recall_resting(pair, resting, q.reach, patch, normal)) return add_patch(q, patch, normal, radius, sink);
    resting.count = 0;
  }
  if (q.area && q.cache && q.cache->polyhedra) {
    OverlapForm& form = q.cache->polyhedra->form;
    if (form.kind != OverlapForm::Kind::none &&
        collide_form(pair, form, {radius, q.a.orientation.toRotationMatrix()}, sink))
      return;
    form = {};
  }
  // a pair that is queried once and found apart keeps an axis only
  const bool had_axis = q.cache && q.cache->axis.squaredNorm() > 0.0;
  PairMemory* const memory = had_axis ? &q.cache->made() : q.cache ? q.cache->polyhedra.get() : nullptr;
  const PolyhedronDistance d = polyhedron_distance(pair, limit, memory);
  if (d.beyond)
    remember(q, d.axis.normal);
  else if (q.cache) {
    q.cache->axis.setZero();
    q.cache->made();
  }
  if (d.beyond) return;
  if (q.area) {
    const OverlapForm form = collide_volumes(pair, d.axis, {radius, q.a.orientation.toRotationMatrix()}, sink);
    if (q.cache) q.cache->made().form = form;
    return;
  }
  if (d.uncertainty > certain * pair.size()) sink.mark_degenerate();
  const Patch patch = contact_patch(pair, d, q.reach, r.sweep_a, r.sweep_b);
  if (q.resting && patch.count > 0 && patch.count <= 4) {
    if (!*q.resting) *q.resting = std::make_unique<RestingPatch>();
    keep_resting(pair, d.axis, patch, q.reach, **q.resting);
  }
  add_patch(q, patch, d.axis.normal, radius, sink);
}

}  // namespace epafi
