/// @file all_measures.h  The list of measures a scene may ask for: one line per entry.
#pragma once
#include <vector>

#include "engine/registry.h"

namespace epafi {

const std::vector<Entry>& all_measures();

}  // namespace epafi
