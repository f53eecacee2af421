/// @file carry_over.h  Moves the state of one simulation to another: for stages, changed restarts, and scenes that
/// start from a run. Bodies keep their order, slots, stored forces and memory of contacts, so a stage without changes
/// has no effect on the bits.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scenes/assemble.h"

namespace epafi {

struct CarryOver {
  const Assembly& from;
  bool goes_on = true;       ///< continues time, ledger and measures; else a new run begins
  bool at_rest = false;      ///< sets velocities to 0
  bool keeps_memory = true;  ///< of contacts
  Vec3 move = Vec3::Zero();  ///< [m]
  Quat turn = Quat(1, 0, 0, 0);
  bool turned = false;
};

/// True if contact mechanics, gravity and bodies are unchanged: forces and time step remain valid.
bool same_mechanics(const Scene& before, const Scene& now);

/// Bodies of `to` get pose, velocity and slots of their counterparts.
void carry_bodies(const CarryOver& carry, Assembly& to);

/// Moves the memory of contacts and events from `from`, whose stages are modified, to `to`, and enters the simulation.
/// Returns a description of dropped data.
std::vector<std::string> carry_memory(const CarryOver& carry, Assembly& from, Assembly& to,
                                      const std::function<void(StateVisitor&)>& own_state_there,
                                      const std::function<void(StateVisitor&)>& own_state_here);

/// Begins a new run: from its scene at time 0, or with the memory of the run that it starts from.
std::vector<std::string> enter_simulation(Assembly& assembly);

/// Options for a scene that starts from another run.
CarryOver carry_of_start(const Scene& scene);

}  // namespace epafi
