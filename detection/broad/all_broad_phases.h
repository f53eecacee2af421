/// @file all_broad_phases.h  The list of broad phases: one line per entry, and the choice behind `broad_phase =
/// "auto"`.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "detection/broad/broad_phase.h"
#include "engine/units/registry.h"

namespace epafi {

struct BroadPhaseEntry {
  Entry entry;
  std::function<std::unique_ptr<BroadPhase>(const BroadSetup&)> make;
};

const std::vector<BroadPhaseEntry>& all_broad_phases();

/// A name of the list and, for `epafi explain`, why it was chosen.
struct BroadChoice {
  std::string name;
  std::string reason;
};
BroadChoice choose_broad_phase(const World& world, const BroadSetup& setup);

/// By name; "auto" chooses. Null where the name is not in the list.
std::unique_ptr<BroadPhase> make_broad_phase(std::string_view name, const BroadSetup& setup, const World& world);

}  // namespace epafi
