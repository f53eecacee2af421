/// @file pair_memory.h  Memory of a pair of polyhedra from query to query. It names features, which are used only if
/// they are certified, by more than rounding, to be those of a search without memory. Results have the same bits
/// without it, so it is not state.
#pragma once
#include <array>

#include "engine/state/types.h"

namespace epafi {

/// The features on which the closest points of two separated polyhedra lie.
struct NearestFeatures {
  enum class Kind : std::uint8_t { none, vertices, vertex_edge, edge_vertex, edges, face_vertex, vertex_face };
  Kind kind = Kind::none;  ///< of A, then of B
  std::uint32_t a = 0, b = 0;
};

/// Features that hold the axis of largest separation while the bodies move little: in the pose kept here no other
/// feature separates by more than `threshold`, and moving the bodies changes no separation by more than they move.
struct AxisReference {
  static constexpr std::size_t most_faces = 6, most_crossings = 24;
  struct Face {
    std::uint16_t face, deepest;  ///< deepest: the other body's vertex below it
  };
  struct Crossing {
    std::uint16_t a, b;  ///< edges whose Gauss arcs cross, or may after turning by `turn`
  };
  bool known = false;
  std::uint8_t faces_a = 0, faces_b = 0, crossings = 0;
  std::array<Face, most_faces> face_a, face_b;
  std::array<Crossing, most_crossings> crossing;
  double threshold = 0.0;  ///< [m]
  double turn = 0.0;       ///< rotation up to which `crossing` is complete [rad]
  Mat3 rotation;           ///< B's axes to A's axes
  Vec3 offset, offset_b;   ///< B's centre from A's, in A's and in B's axes [m]
};

/// Faces of A and of B that bound an overlap, sorted.
struct NearFaces {
  static constexpr std::size_t most = 8;  ///< of each body; more: the overlap is cut out of the bodies
  std::uint8_t count_a = 0, count_b = 0;
  std::array<std::uint16_t, most> a, b;
};

/// Features that determine an overlap (overlap_forms.h, overlap_faces.h).
struct OverlapForm {
  enum class Kind : std::uint8_t { none, edges, face_vertex, vertex_face, faces };
  Kind kind = Kind::none;      ///< of A, then of B
  std::uint32_t a = 0, b = 0;  ///< edge, face or vertex
  NearFaces near;              ///< of kind `faces`
};

struct PairMemory {
  NearestFeatures nearest;                        ///< of the last time they were apart
  OverlapForm form;                               ///< of the last overlap
  std::uint8_t kind = 0;                          ///< of the last axis (SeparatingAxis::Kind), 0: none
  std::uint8_t uses = 0, wait = 0, patience = 0;  ///< of `reference`: fast pairs have none
  bool tried = false;                             ///< a reference was asked for
  Vec3 normal = Vec3::Zero();                     ///< of the last search, A's axes
  std::uint32_t feature_a = 0, feature_b = 0;     ///< of the last axis
  AxisReference reference;
};

}  // namespace epafi
