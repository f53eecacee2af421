/// @file overlap_faces.h  The overlap of two polyhedra between a few known faces, without a search: its faces are those
/// of the bodies, cut by the other body's planes, and its cells are cones over parts of them. The apex of a field's
/// cones is a point that all its planes share, on an edge or a vertex, so faces between cells and the body's own faces
/// contribute nothing; the apex may lie outside the overlap.
#pragma once
#include <span>
#include <vector>

#include "detection/narrow/polyhedra/overlap_cell.h"
#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi {

/// The faces that come nearer to the overlap with these corners (A's axes) than twice the bound of its field: the least
/// over the faces of their largest depth in it, which no depth exceeds. What bounds the overlap or is the nearest
/// somewhere is among them. Counts are 0 where they are too many, or for edges and corners, which overlap_forms.h
/// writes down.
NearFaces near_faces(const PolyhedronPair& pair, std::span<const Vec3> corners);

/// The cells where these are the near faces; false where they are not, or may be by rounding alone, and where those of
/// a body have no edge or vertex in common. No overlap is between two sets of faces, so that the answer tells nothing
/// of where the set came from; `out` is undefined where it is false.
bool find_cells(const PolyhedronPair& pair, const NearFaces& near, std::vector<OverlapCell>& out);

}  // namespace epafi
