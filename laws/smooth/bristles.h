/// @file bristles.h  Friction of a Hertzian contact by a row of independent bristles across its diameter (Popov and
/// Hess 2015, method of dimensionality reduction). Each carries the normal load E* (delta - x^2/R*) dx and the
/// tangential stiffness 4 G* dx, sticks or slides by itself, and remembers: the row as a whole answers as the sphere
/// does under any history of loading, partial slip from the edge included (Cattaneo 1938, Mindlin and Deresiewicz
/// 1953). Error: the radius has 12 to 48 bristles. Displacement at half the sliding load 1e-3, loss per cycle 3e-3
/// (tests/laws/test_contact_laws.cpp). Each bristle is a spring of laws/smooth/spring.h, so no cycle creates energy.
#pragma once
#include <array>
#include <cstddef>

#include "laws/smooth/spring.h"

namespace epafi {

/// Loads of the bristles, from the middle outwards: 1.2 kB. Both halves of the row are alike.
struct Bristles {
  static constexpr int count = 48;
  std::array<Vec3, count> load;  ///< on A, of the bristle and its mirror image [N]; set where width > 0
  double share = 0.0;            ///< contact radius in widths of a bristle [-]
  double width = 0.0;            ///< tangential stiffness of a whole bristle with its mirror image [N/m]; 0: no contact
};

template <>
inline constexpr bool is_plain<Bristles> = true;

/// The same in columns that are not written before they are read.
struct alignas(Bristles) PackedBristles {
  std::byte bytes[sizeof(Bristles)];
  Bristles& get() { return *reinterpret_cast<Bristles*>(bytes); }
  const Bristles& get() const { return *reinterpret_cast<const Bristles*>(bytes); }
};

/// The same with bodies A and B exchanged.
inline void exchange(Bristles& bristles) {
  if (!(bristles.width > 0.0)) return;
  for (Vec3& load : bristles.load) load = -load;
}

/// [J]
double energy_of(const Bristles& bristles);

/// k_t: of the whole row, 8 G* a. limit: mu N.
FrictionResponse pull_bristles(const SlipStep& step, double stiffness, double limit, const Bristles& before,
                               Bristles& now);

}  // namespace epafi
