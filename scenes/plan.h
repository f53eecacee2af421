/// @file plan.h  Work of the engine for a scene, derived from its declarations. `plan_text.cpp` prints it for `epafi
/// explain`.
#pragma once
#include <string>
#include <vector>

#include "engine/state/contacts.h"
#include "scenes/memory_plan.h"
#include "scenes/scene.h"
#include "scenes/shape_builder.h"

namespace epafi {

/// A cost of the scene, with reason and line.
struct Cost {
  std::string name, why;
  Place where{};
};

/// A cell of the pair table that the scene can reach.
struct ReachableCell {
  std::string a, b, method;
  bool convex_parts = false;  ///< pairs of parts have memory
};

struct StepPlan {
  Columns columns;                    ///< of the world
  Needs needs;                        ///< of laws or solver
  double reach = 0.0;                 ///< contacts with gap < reach are handed to the contact model [m]
  double resting_reach = 0.0;         ///< the same for bodies that move less in a step [m]
  bool rolling = false;               ///< wheels on rails by laws of rolling contact
  bool fused_spheres = false;         ///< free spheres, and what else consists of balls, take the fused loop
  bool fused_held = false;            ///< spheres and clumps that are held do so too
  std::string without_fused_spheres;  ///< why they do not; empty: no spheres
  std::vector<ReachableCell> pair_cells;
  std::vector<Cost> costs;
  std::vector<std::string> not_paid;
  std::string broad_phase, broad_phase_reason;
  MemoryPlan memory;

  /// The line that causes a cost, or "not paid".
  std::string reason(const std::string& cost) const;
};

/// 0 for other shapes.
std::size_t balls_of_clump(const ShapeSpec& shape);

/// shapes: of every scene shape, built. Bodies of fills count as free bodies.
/// may_fuse: false where spheres shall not take their own loop.
StepPlan plan(const Scene& scene, const std::vector<BuiltShape>& shapes, bool may_fuse = true);

/// The text of `epafi explain`, for a terminal of 80 columns. shapes: those of the scene.
std::string explain(const Scene& scene, const StepPlan& plan, const ShapeStore& shapes);

}  // namespace epafi
