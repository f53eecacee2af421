/// @file placing.h  Bodies of a scene's tables and fills put into its world, stage by stage: a body keeps the number
/// that it got when its stage came, whatever comes later.
#pragma once
#include "scenes/assemble.h"
#include "scenes/shape_builder.h"

namespace epafi {

/// Gives servo walls what the scene does not write: they press with gravity, have the mass of their body and close in
/// at most at sqrt(F d/m), which they reach from rest over half the diameter d of the smallest free body. Before the
/// bodies are added.
void complete_servos(Assembly& assembly, ShapeBuilder& builder);

/// The bodies of the tables that a stage brings.
void add_bodies(Assembly& assembly, ShapeBuilder& builder, std::size_t stage);

/// Rows of [[bodies]] as exports of versions before format 2 of run.h5 wrote them have the orientations of principal
/// axes. They are known by what they do: as written their bodies lie deep in each other, as principal axes they do not.
/// Then they are read so, with a warning. Before the bodies are added.
void read_principal_axes(Assembly& assembly, ShapeBuilder& builder);

/// Bodies of the fills of earlier stages; those that were not kept are computed again.
KnownFills known_fills(const Scene& scene, const AssembleOptions& options);

/// Of an earlier stage. A fill that is not known does not test for room: the positions of that time are lost.
void add_known_fills(Assembly& assembly, ShapeBuilder& builder, std::size_t stage, const KnownFills& known);

/// Of the present stage. places_known: positions are those of now, so fills test for room.
void add_fills(Assembly& assembly, ShapeBuilder& builder, const KnownFills& known, bool places_known);

}  // namespace epafi
