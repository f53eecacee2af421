/// @file deflate.h  The only door to zlib: compressed streams and checksums.
#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace epafi {

/// A zlib stream (RFC 1950); level 1 is fast, 9 small. "" where there is not memory enough: threads may call it.
[[nodiscard]] std::string deflated(std::span<const char> bytes, int level);

/// The same, looking for runs of one byte only: of planes of bytes (view/planes.h), which hold noise and runs, it makes
/// as little as level 6 in a third of the time.
[[nodiscard]] std::string deflated_runs(std::span<const char> bytes);

/// CRC-32 as in PNG (ISO 3309).
[[nodiscard]] std::uint32_t crc32_of(std::span<const char> bytes);

}  // namespace epafi
