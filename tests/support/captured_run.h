/// @file captured_run.h  `epafi run` inside a test: what it prints and the code it ends with.
#pragma once
#include "scenes/cli/commands.h"
#include "tests/support/captured.h"

namespace epafi {

/// One thread, no progress line.
inline RunOptions quiet_into(const std::filesystem::path& folder) {
  RunOptions options;
  options.out = folder.string();
  options.threads = 1;
  options.quiet = true;
  return options;
}

inline Captured run_of(const std::filesystem::path& scene, const RunOptions& options,
                       const std::vector<std::string>& overrides = {}) {
  return captured([&] { return guarded([&] { return command_run({scene.string(), overrides}, options); }); });
}

}  // namespace epafi
