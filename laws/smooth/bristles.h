/// @file bristles.h  Friction of a Hertzian contact by a row of independent bristles across its diameter (Popov and
/// Hess 2015, method of dimensionality reduction). Each carries the normal load E* (delta - x^2/R*) dx and the
/// tangential stiffness 4 G* dx, sticks or slides by itself, and remembers: the row as a whole answers as the sphere
/// does under any history of loading, partial slip from the edge included (Cattaneo 1938, Mindlin and Deresiewicz
/// 1953). Error: the radius has 12 to 48 bristles. Displacement at half the sliding load 1e-3, loss per cycle 3e-3
/// (tests/laws/test_contact_laws.cpp). Each bristle is a spring as in laws/smooth/spring.h, so no cycle creates energy.
#pragma once
#include <cstddef>

#include "laws/smooth/spring.h"

namespace epafi {

/// Loads of the bristles, from the middle outwards: 0.8 kB. Both halves of the row are alike. They lie along two axes
/// in the contact plane, `axis` and normal x axis, which turn with it: no load has to.
struct Bristles {
  static constexpr int count = 48;
  double along[count] = {}, across[count] = {};  ///< on A, of the bristle and its mirror image [N]; 0 past the edge
  double load_along = 0.0, load_across = 0.0;    ///< of all [N]
  double energy = 0.0;                           ///< of all [J]
  Vec3 axis = Vec3::Zero();                      ///< of length 1
  double share = 0.0;                            ///< contact radius in widths of a bristle [-]
  double width = 0.0;  ///< tangential stiffness of a whole bristle with its mirror image [N/m]; 0: no contact
};

template <>
inline constexpr bool is_plain<Bristles> = true;

/// The same in columns that are not written before they are read.
struct alignas(Bristles) PackedBristles {
  std::byte bytes[sizeof(Bristles)];
  Bristles& get() { return *reinterpret_cast<Bristles*>(bytes); }
  const Bristles& get() const { return *reinterpret_cast<const Bristles*>(bytes); }
};

/// The same with bodies A and B exchanged: loads and normal turn round, and with the normal the second axis.
inline void exchange(Bristles& row) {
  for (double& load : row.along) load = -load;
  row.load_along = -row.load_along;
}

/// [J]
inline double energy_of(const Bristles& row) { return row.energy; }

/// k_t: of the whole row, 8 G* a. limit: mu N. `now` may be `before`.
FrictionResponse pull_bristles(const SlipStep& step, double stiffness, double limit, const Bristles& before,
                               Bristles& now);

}  // namespace epafi
