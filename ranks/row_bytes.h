/// @file row_bytes.h  Rows of bytes on their way, each written before it is read; many of them in large pages, which
/// are quicker to come by.
#pragma once
#include <cstddef>

#include "engine/state/large_column.h"

namespace epafi {

using RowBytes = UnwrittenColumn<std::byte>;

}  // namespace epafi
