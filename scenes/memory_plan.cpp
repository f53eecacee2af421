#include "scenes/memory_plan.h"

#include "detection/broad/fat_bodies.h"
#include "detection/narrow/pairs/pair_query.h"
#include "detection/narrow/polyhedra/resting_patch.h"
#include "engine/state/contacts.h"
#include "engine/state/large_column.h"
#include "laws/nonsmooth/contact_problem.h"
#include "laws/smooth/fused/fused_spheres.h"
#include "laws/smooth/fused/sphere_blocks.h"
#include "scenes/contact_setup.h"
#include "scenes/plan.h"

namespace epafi {
namespace {

/// Number of balls of the largest clump.
std::size_t balls_of_clumps(const Scene& scene) {
  std::size_t most = 0;
  for (const ShapeSpec& shape : scene.shapes) most = std::max(most, balls_of_clump(shape));
  return most;
}

/// Bytes per body in FatBodies and the pair list.
std::size_t list_bytes(const Scene& scene, const StepPlan& plan) {
  constexpr std::size_t inverse_half_margin = sizeof(float) + sizeof(char),
                        names = sizeof(std::uint32_t) + 3 * sizeof(std::uint8_t);
  if (!plan.fused_spheres ||
      balls_of_clumps(scene) > 0)  // box, ball, half and radius, where it stood and how it was turned
    return inverse_half_margin + names + sizeof(Aabb) + sizeof(Ball) + 2 * sizeof(double) + sizeof(Slot) +
           (plan.columns.orientation ? sizeof(Quat) : 0);
  constexpr std::size_t sorted = 4 * sizeof(float) + sizeof(Slot) + sizeof(std::uint32_t) + sizeof(std::uint8_t);
  return inverse_half_margin + names + sizeof(Ball) + sorted + 2 * sizeof(Slot);
}

/// State; position in its body by list and by loop, and in the world; loads.
constexpr std::size_t bytes_of_ball = sizeof(BodyState) + 3 * sizeof(BodyBall) + 3 * sizeof(Vec3) + sizeof(Ball);

/// Bytes per body, pair and contact in the loop over spheres.
void plan_spheres(const Scene& scene, MemoryPlan& out) {
  const SphereNeeds needs = sphere_needs(smooth_setup(scene));
  if (needs.damps_slip()) out.body += sizeof(Lanes);  // late spins
  out.body += balls_of_clumps(scene) * bytes_of_ball;
  out.pair = sizeof(SpherePlaces) + sizeof(Slot) + (scene.cell ? sizeof(SphereImage) + sizeof(std::uint32_t) : 0);
  // in a packed bed 1/6 of the contacts join two blocks and need a record
  const std::size_t record = sizeof(SphereRecord) + sizeof(SpherePlace) + (needs.rolling ? sizeof(Lanes) : 0);
  out.contact = (needs.friction ? sizeof(TileSpring) : 0) + (needs.normal ? sizeof(double) : 0) +
                (needs.push ? sizeof(double) : 0) + (needs.bristles ? sizeof(PackedBristles) : 0) +
                (needs.rolling ? sizeof(TileSpring) : 0) + (needs.damps_slip() ? sizeof(SphereLoads) : 0) + record / 6;
}

/// Bytes per contact in the contact model, besides the set of contacts.
std::size_t model_bytes(const StepPlan& plan, bool smooth) {
  const std::size_t key = 2 * sizeof(Slot) + sizeof(Feature), found = sizeof(std::uint32_t);
  const std::size_t incidence = sizeof(std::uint32_t);
  if (smooth) return incidence + (plan.needs.memory ? key + found + 2 * sizeof(Vec3) : 0);
  const bool rotates = plan.columns.rotation;
  const std::size_t problem = 2 * sizeof(Slot) + sizeof(ContactFrame) + (rotates ? 2 * sizeof(Vec3) : 0) +
                              3 * sizeof(double) + sizeof(Mat3) + incidence;
  const std::size_t remembered = key + 3 * sizeof(Vec3) + sizeof(double) + found + 1;
  constexpr std::size_t impulses = 4 * sizeof(Vec3);  // r, u, and those of the position correction
  // one lane of a row of four: axes, offsets, impulses, data of the update for three rows, friction, arms
  const std::size_t row = 3 * (3 + 1 + 1 + 1) * sizeof(double) + sizeof(double) + (rotates ? 6 * sizeof(double) : 0);
  return problem + remembered + impulses + row;
}

template <class T>
std::size_t bytes_of(const std::vector<T>& column) {
  return column.size() * sizeof(T);
}

}  // namespace

MemoryPlan plan_memory(const Scene& scene, const StepPlan& plan) {
  MemoryPlan out;
  out.body = World(plan.columns).bytes_per_body();
  out.list = list_bytes(scene, plan);
  ContactSet contacts;
  contacts.with_curvature = plan.needs.curvature;
  contacts.with_area = plan.needs.area;
  contacts.with_moment = plan.needs.contact_moment;
  out.in_set = contacts.bytes_per_contact();
  if (plan.fused_spheres) {
    plan_spheres(scene, out);
    return out;
  }
  const bool smooth = scene.contact.method.value == Method::smooth;
  // found by blocks, then copied into one set
  out.contact = 2 * out.in_set - sizeof(Vec3) + model_bytes(plan, smooth);
  out.pair = 2 * sizeof(Pair);
  const bool remembers = std::ranges::any_of(plan.pair_cells, [](const ReachableCell& c) { return c.method == "sat"; });
  const bool parts = std::ranges::any_of(plan.pair_cells, [](const ReachableCell& c) { return c.convex_parts; });
  const bool hulls = std::ranges::any_of(
      plan.pair_cells, [](const ReachableCell& c) { return c.convex_parts && (c.a == "solid" || c.b == "solid"); });
  const bool rests = (remembers || parts) && plan.resting_reach < plan.reach;
  // during a list update the columns of the old list still exist; 50 to 76 % of listed pairs touch or have touched
  if (remembers || parts)
    out.pair += 2 * (sizeof(Pair) + 2 * sizeof(std::uint32_t) + sizeof(PairCache) + (rests ? sizeof(void*) : 0));
  if (remembers) out.pair += 2 * (sizeof(PairMemory) + (rests ? sizeof(RestingPatch) : 0)) / 3;
  // stones of 8 to 15 parts keep 15 pairs of parts; half of these have touched or lost their axis
  if (parts) out.pair += 2 * sizeof(PartMemory) + 15 * PartMemory::bytes_per_pair;
  if (hulls) out.pair += 15 * sizeof(PairMemory) / 2;
  return out;
}

std::size_t polyhedra_bytes(const ShapeStore& shapes) {
  std::size_t bytes = 0;
  for (const ConvexHull& h : shapes.of<ConvexHull>())
    bytes += sizeof(ConvexHull) + bytes_of(h.vertices) + bytes_of(h.face_begin) + bytes_of(h.face_vertices) +
             bytes_of(h.face_normals) + bytes_of(h.face_offsets) + bytes_of(h.edges) + bytes_of(h.neighbour_begin) +
             bytes_of(h.neighbours) + bytes_of(h.fan_begin) + bytes_of(h.fans) + bytes_of(h.starts) +
             bytes_of(h.lanes.vertices) + bytes_of(h.lanes.faces) + bytes_of(h.lanes.edges);
  return bytes;
}

}  // namespace epafi
