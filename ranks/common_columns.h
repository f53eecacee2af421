/// @file common_columns.h  Columns of a state whose rows are no body's and no contact's, over all ranks.
#pragma once
#include "engine/step/simulation.h"
#include "ranks/state_image.h"

namespace epafi {

/// What is nobody's is that of rank 0 everywhere; of shared sums rank 0 has all. Two messages, however many columns.
void take_common(StateImage& image);
/// Shared sums, at rank 0 and everywhere else.
void sum_shares(StateImage& image);
/// Rows of bodies and contacts.
void drop_rows(StateImage& image);
/// What detection keeps by slot is void; what contact models keep comes in with the state.
void forget_slots(Simulation& simulation);

}  // namespace epafi
