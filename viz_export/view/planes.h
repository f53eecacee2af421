/// @file planes.h  Whole numbers as planes of bytes: first the lowest byte of all, then the next. What changes little
/// from row to row has empty upper planes, which compress to nothing. The page reads them back (page/unpack.js).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace epafi {

/// Small for small numbers of both signs: 0 -1 1 -2 2 ... become 0 1 2 3 4 ...
constexpr std::uint32_t zigzag(std::int32_t v) {
  return (static_cast<std::uint32_t>(v) << 1) ^ static_cast<std::uint32_t>(v >> 31);
}

inline void put_number(std::string& out, std::uint32_t v) {
  for (int byte = 0; byte < 4; ++byte) out += static_cast<char>(v >> (8 * byte) & 255u);
}

/// The lowest `bytes` bytes of each.
inline void put_planes(std::string& out, std::span<const std::uint32_t> values, int bytes) {
  for (int byte = 0; byte < bytes; ++byte)
    for (const std::uint32_t v : values) out += static_cast<char>(v >> (8 * byte) & 255u);
}

/// Differences from `before` where that has as many values, else from row to row.
inline void put_differences(std::string& out, std::span<const std::int32_t> values,
                            std::span<const std::int32_t> before, int bytes) {
  const bool by_row = before.size() != values.size();
  std::vector<std::uint32_t> changes(values.size());
  std::uint32_t last = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto now = static_cast<std::uint32_t>(values[k]);
    const std::uint32_t then = by_row ? last : static_cast<std::uint32_t>(before[k]);
    changes[k] = zigzag(static_cast<std::int32_t>(now - then));
    last = now;
  }
  put_planes(out, changes, bytes);
}

}  // namespace epafi
