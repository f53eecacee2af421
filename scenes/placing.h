/// @file placing.h  Adds the bodies of a scene's tables and fills to its world, stage by stage. A body keeps the number
/// from its stage.
#pragma once
#include "scenes/assemble.h"
#include "scenes/shape_builder.h"

namespace epafi {

/// Sets defaults of servo walls: direction of gravity, mass of the body, and the largest speed sqrt(F d/m), which they
/// reach from rest within half the diameter d of the smallest free body. Call it before bodies are added.
void complete_servos(Assembly& assembly, ShapeBuilder& builder);

/// The bodies of the tables that a stage brings.
void add_bodies(Assembly& assembly, ShapeBuilder& builder, std::size_t stage);

/// Rows of [[bodies]] as exports of versions before format 2 of run.h5 wrote them have the orientations of principal
/// axes. They are recognised by deep overlaps that vanish with principal axes; then they are converted, with a warning.
/// Call it before bodies are added.
void read_principal_axes(Assembly& assembly, ShapeBuilder& builder);

/// Bodies of the fills of earlier stages; those that were not kept are computed again.
KnownFills known_fills(const Scene& scene, const AssembleOptions& options);

/// Adds the fills of an earlier stage. A fill that is not known does not test for overlap: the positions of that time
/// are lost.
void add_known_fills(Assembly& assembly, ShapeBuilder& builder, std::size_t stage, const KnownFills& known);

/// Adds the fills of the present stage. places_known: positions are those of now, so fills test for overlap.
void add_fills(Assembly& assembly, ShapeBuilder& builder, const KnownFills& known, bool places_known);

}  // namespace epafi
