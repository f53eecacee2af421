/// @file hertz_spring.h  What laws on Hertz's spring share: N = 4/3 E* sqrt(R*) overlap^(3/2) (Hertz 1882), with a
/// dashpot beside it.
#pragma once
#include "laws/contact_law.h"

namespace epafi {

/// dN/d(overlap) [N/m]; modulus: E* [Pa].
template <class Real>
EPAFI_LANES Real hertz_stiffness(const Real& modulus, const KinematicsOf<Real>& c) {
  return 2.0 * modulus * sqrt(c.effective_radius * c.overlap);
}

/// elastic: the spring's force, 2/3 stiffness overlap [N]; dashpot: its constant [N s/m], growing with overlap^growth.
/// The sum never pulls.
template <class Real>
EPAFI_LANES ResponseOf<Real> hertz_response(const KinematicsOf<Real>& c, const Real& stiffness, const Real& elastic,
                                            const Real& dashpot, double growth) {
  return {.force = max(Real{}, elastic + c.viscous(dashpot, stiffness, Real{} + growth)),
          .elastic_force = elastic,
          .stiffness = stiffness,
          .energy = 0.4 * elastic * c.overlap,
          .dashpot = dashpot,
          .growth = Real{} + growth};
}

}  // namespace epafi
