/// @file row_bytes.h  Buffer of rows, uninitialised; large ones use large pages, which are faster to allocate.
#pragma once
#include <cstddef>

#include "engine/state/large_column.h"

namespace epafi {

using RowBytes = UnwrittenColumn<std::byte>;

}  // namespace epafi
