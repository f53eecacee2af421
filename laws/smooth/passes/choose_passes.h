/// @file choose_passes.h  From the names of a set-up to its passes and to the rows of its pairs of materials.
#pragma once
#include <vector>

#include "laws/smooth/fused/tile_passes.h"
#include "laws/smooth/make_smooth_contact.h"

namespace epafi {

/// How a normal law is evaluated: contacts of a tile, and one of them; numbers: its PairRow::normal.
struct NormalEvaluation {
  void (*tile)(const NormalCall&) = nullptr;
  NormalResponse (*one)(const double* numbers, const ContactKinematics&, double before, double& now,
                        const double* dt_if_located) = nullptr;
};
/// Compiled in the .cpp files of this folder, one for each Loop<Law>; for the widest lanes of now.
template <class Law>
NormalEvaluation normal_evaluation();

void (*coulomb_pass())(const TangentialCall&);
void (*bristle_pass())(const TangentialCall&);
void (*rolling_pass())(const RollingCall&);

/// The laws of a set-up for tiles.
struct TileLaws {
  NormalEvaluation (*normal)() = nullptr;
  std::vector<PairRow> rows;  ///< as MaterialTable::pairs
  std::uint32_t materials = 1;
  bool damped = false;  ///< velocities at the time of the detection are wanted
  SphereNeeds needs;
  AnyRolling::Type rolling = AnyRolling::Type::spring;
  bool locates = false;
  bool holds_on = false;  ///< contacts hold beyond touch

  /// Loops for the widest lanes of now.
  Passes passes() const;
};

/// What keeps a set-up from tiles of spheres; empty: nothing.
std::string without_tiles(const SmoothSetup& setup);
TileLaws tile_laws(const SmoothSetup& setup);

}  // namespace epafi
