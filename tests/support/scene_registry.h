/// @file scene_registry.h  A registry for tests of the scene door: the real shapes, schemes and measures, and laws and
/// solvers with the fields that a scene door must cope with (required, optional, with default), whatever the engine
/// offers at the time.
#pragma once
#include "detection/shape_store.h"
#include "engine/schemes/all_schemes.h"
#include "scenes/reader/registry.h"
#include "viz_export/measures/all_measures.h"

namespace epafi {

inline Registry test_registry() {
  Registry r;
  const auto shapes = shape_entries(AllShapes{});
  for (const char* name : {"sphere", "box", "capsule", "cylinder", "ellipsoid", "polyhedron", "mesh", "half_space"})
    if (const Entry* entry = find_entry(shapes, name)) r.shapes.push_back(*entry);
  const Field stiffness{"stiffness", "k_n", "N/m", Kind::number, {}, positive, "normal stiffness"};
  const Field ratio{
      "stiffness_ratio", "k_t/k_n", "", Kind::number, Value(2.0 / 7.0), positive, "tangential over normal stiffness"};
  r.normal_laws = {{"linear", "linear spring and dashpot", {stiffness}, {}, "Cundall and Strack 1979"},
                   {"hertz", "Hertz with damping", {}, {}, "Hertz 1882"},
                   {"hertz-mindlin", "Hertz and Mindlin", {}, {}, "Mindlin 1949"}};
  r.tangential_laws = {{"none", "no friction", {}, {}, ""},
                       {"coulomb-spring", "spring capped by friction", {ratio}, {}, ""}};
  r.rolling_laws = {{"none", "no rolling friction", {}, {}, ""}};
  const Field iterations{"iterations", "", "", Kind::integer, Value(50.0), {1, 1e6}, "largest number of sweeps"};
  const Field tolerance{"tolerance", "", "", Kind::number, Value(1e-6), not_negative, "residual at which to stop"};
  const Field relaxation{"relaxation",       "omega_r",          "", Kind::number, Value(1.0),
                         {0, 2, true, true}, "relaxation factor"};
  r.solvers = {{"pgs", "projected Gauss-Seidel", {iterations, tolerance, relaxation}, {}, ""},
               {"nsgs", "block Gauss-Seidel", {iterations, tolerance}, {}, ""}};
  r.broad_phases = {{"spatial-hash",
                     "sorted cells",
                     {{"cell_size", "", "m", Kind::number, {}, positive, "edge of a cell", true}},
                     {},
                     ""},
                    {"aabb-tree", "tree of boxes", {}, {}, ""},
                    {"all-pairs", "every pair", {}, {}, ""}};
  for (const auto& scheme : all_schemes()) {
    r.schemes.push_back(scheme.entry);
    (scheme.smooth ? r.smooth_schemes : r.nonsmooth_schemes).push_back(scheme.entry.name);
  }
  for (const auto& measure : all_measures()) r.measures.push_back(measure.entry);
  return r;
}

}  // namespace epafi
