/// @file same_bits.h  Two answers about polyhedra, compared bit for bit.
#pragma once
#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi::support {

inline bool same_bits(const SeparatingAxis& p, const SeparatingAxis& q) {
  return p.kind == q.kind && p.gap == q.gap && p.normal == q.normal && p.feature_a == q.feature_a &&
         p.feature_b == q.feature_b;
}

inline bool same_bits(const PolyhedronDistance& p, const PolyhedronDistance& q) {
  return same_bits(p.axis, q.axis) && p.beyond == q.beyond && p.uncertainty == q.uncertainty &&
         (p.beyond || (p.witness_a == q.witness_a && p.witness_b == q.witness_b));
}

}  // namespace epafi::support
