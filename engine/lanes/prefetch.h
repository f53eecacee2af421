/// @file prefetch.h  Asks the processor for memory that is read soon; no result depends on it.
#pragma once
#include <cstddef>

namespace epafi {

inline void prefetch(const void* from, std::size_t bytes) {
  constexpr std::size_t line = 64;  // bytes, of every processor that Epafi's lanes are written for
  for (std::size_t i = 0; i < bytes; i += line) __builtin_prefetch(static_cast<const char*>(from) + i);
}

}  // namespace epafi
