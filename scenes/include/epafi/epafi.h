/// @file epafi.h  The library in one header: read a scene, make it ready, step it, look at it.
///
///   auto assembly = epafi::load("stack.toml", {"params.n=20"});
///   for (int k = 0; k < 100; ++k) assembly->simulation->advance();
///   std::puts(epafi::state_hash(assembly->simulation->world).c_str());
#pragma once
#include "engine/simulation.h"
#include "scenes/assemble.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"

namespace epafi {

/// A scene file made ready and started: forces, ledger and observers at time 0. Throws SceneError with every problem of
/// the file.
inline std::unique_ptr<Assembly> load(const std::string& path, const std::vector<std::string>& overrides = {}) {
  ReadResult read = read_scene(path, overrides, full_registry());
  if (!read.scene) throw SceneError(read.problems);
  auto assembly = assemble(std::move(*read.scene));
  assembly->simulation->start();
  return assembly;
}

}  // namespace epafi
