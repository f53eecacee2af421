/// @file common_columns.h  Columns of a state that belong neither to bodies nor to contacts, over all processes.
#pragma once
#include "engine/step/simulation.h"
#include "ranks/state_image.h"

namespace epafi {

/// Common columns get the values of rank 0 everywhere; rank 0 gets the total of shared sums. Two messages for all
/// columns.
void take_common(StateImage& image);
/// Shared sums, at rank 0 and everywhere else.
void sum_shares(StateImage& image);
/// Rows of bodies and contacts.
void drop_rows(StateImage& image);
/// Data of detection by slot become invalid; data of contact models come with the state.
void forget_slots(Simulation& simulation);

}  // namespace epafi
