/// @file version.h  Which release this is, and under which licences it comes.
#pragma once
#include <string>

namespace epafi {

/// Version as written to files: "1.0.0".
[[nodiscard]] const char* version();
/// Text of `epafi --version`: version, licence, and parts under other licences.
[[nodiscard]] std::string version_text();

}  // namespace epafi
