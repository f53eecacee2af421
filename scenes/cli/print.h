/// @file print.h  Results on stdout, where what cannot be written is an error: a full disk, a device that is gone.
#pragma once
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "engine/units/error.h"

namespace epafi {

inline void require_printed(bool done) {
  if (!done) throw FileError(std::string("cannot write to standard output: ") + std::strerror(errno));
}

/// Throws FileError, as does flush_printed().
inline void print(const std::string& text) {
  require_printed(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

/// Flushes printed text; throws where it cannot be written.
inline void flush_printed() { require_printed(std::fflush(stdout) == 0); }

}  // namespace epafi
