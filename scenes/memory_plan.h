/// @file memory_plan.h  Memory of bodies, pairs and contacts during a run, from the types of their columns: the bytes
/// of `epafi explain`. Not included: growth reserves (up to a half), output, and the program (10 to 14 MB). Runs of 10
/// 000 to 1 000 000 spheres and of 1000 to 5000 polyhedra beside it: docs/performance/memory.md.
#pragma once
#include "detection/shape_store.h"
#include "scenes/scene.h"

namespace epafi {

struct StepPlan;

struct MemoryPlan {
  std::size_t body = 0;  ///< columns of the world [B per body]
  std::size_t list = 0;  ///< memory of its neighbour list [B per body]
  std::size_t pair = 0;  ///< listed, with what it remembers [B per pair]
  /// Wherever it lies: in set, law and solver, or in the loop over spheres where the scene has one [B per contact];
  /// what others have there (spheres with a mesh, a box) is not counted: they are few.
  std::size_t contact = 0;
  std::size_t in_set = 0;  ///< in the set that measures read [B per contact]; no part of the loop over spheres
};

/// plan: whose columns, needs and loops are known.
MemoryPlan plan_memory(const Scene& scene, const StepPlan& plan);

/// Memory of all polyhedra of the scene [B]: vertices, faces and edges, also in lanes of four.
std::size_t polyhedra_bytes(const ShapeStore& shapes);

}  // namespace epafi
