/// @file held_loads.h  What contacts put on fixed and driven bodies, as sums of parts that several processes add up to
/// the bits of one (gather_forces, incidence.h).
#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "engine/state/contacts.h"
#include "engine/threads/order_free_sum.h"

namespace epafi {

struct HeldLoad {
  std::array<OrderFreeSum, 6> sums;  ///< force [N], torque [N m]
  HeldLoad& operator+=(const HeldLoad& other) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += other.sums[k];
    return *this;
  }
};

/// Contact k on body A where sign is +1, on B where it is -1.
Vec3 contact_torque(const ContactSet& contacts, std::size_t k, double sign, const World& world);

/// By slots of `held`, ascending; counts(a, b): contacts of these bodies are among those that are summed.
std::vector<HeldLoad> held_loads(const World& world, const ContactSet& contacts, std::span<const Slot> held,
                                 const std::function<bool(Slot, Slot)>& counts);

}  // namespace epafi
