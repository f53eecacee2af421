/// @file registry.h  All lists of the engine in one place, for the reader, `epafi list` and `epafi schema`.
#pragma once
#include "scenes/reader/registry.h"

namespace epafi {

const Registry& full_registry();

}  // namespace epafi
