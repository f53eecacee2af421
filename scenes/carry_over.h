/// @file carry_over.h  The state of one simulation moved into another: what a stage, a changed restart and a scene that
/// starts from a run have in common. Bodies keep their order; slots, stored forces and the memory of contacts go on as
/// they were, so a stage that changes nothing is no event, to the bit.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scenes/assemble.h"

namespace epafi {

struct CarryOver {
  const Assembly& from;
  bool goes_on = true;       ///< in time, with its ledger and measures; else a new run begins
  bool at_rest = false;      ///< velocities are left behind
  bool keeps_memory = true;  ///< of contacts
  Vec3 move = Vec3::Zero();  ///< [m]
  Quat turn = Quat(1, 0, 0, 0);
  bool turned = false;
};

/// Contact mechanics, gravity and bodies are those of before: forces and time step hold.
bool same_mechanics(const Scene& before, const Scene& now);

/// Bodies of `to` get place, motion and slots of those they come from.
void carry_bodies(const CarryOver& carry, Assembly& to);

/// Contacts and events of `to` go on with what those of `from` remember, whose stages are changed on the way; the
/// simulation enters. Returns what was dropped, for the user.
std::vector<std::string> carry_memory(const CarryOver& carry, Assembly& from, Assembly& to,
                                      const std::function<void(StateVisitor&)>& own_state_there,
                                      const std::function<void(StateVisitor&)>& own_state_here);

/// Begins a new run: from its scene at time 0, or with what the run that it starts from remembers.
std::vector<std::string> enter_simulation(Assembly& assembly);

/// Where the scene starts from another run: how its state comes over.
CarryOver carry_of_start(const Scene& scene);

}  // namespace epafi
