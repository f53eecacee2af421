/// @file halo.h  Ghosts of a rank: after each step the owners send the changed state of bodies.
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "engine/state/world.h"
#include "ranks/plan.h"

namespace epafi {

/// A row of all that a step changes of a body: position, velocity, force and whatever else the world has. by_states: in
/// place of forces what contacts read of the states, where the next step has begun.
std::size_t bytes_of_moving(World& world, bool by_states = false);
/// Of the two.
std::size_t most_bytes_of_moving(World& world);
void write_moving(World& world, bool by_states, Slot s, std::byte* to);
void read_moving(const std::byte* from, bool by_states, Slot s, World& world);

class Halo {
 public:
  /// sends: ranks and slots; place: by slot, ascending, in the order of all bodies. By all ranks.
  void set_up(World& world, std::vector<std::pair<int, Slot>> sends, const std::vector<std::uint32_t>& place);
  /// Rows of what moves, in two steps: own bodies stay as they are in between, ghosts must not be read. by_states: the
  /// same at all ranks.
  void begin(World& world, bool by_states);
  void finish(World& world, bool by_states);
  std::span<const Slot> ghosts() const { return into_; }
  double bytes() const { return bytes_; }  ///< sent by this rank in all steps

 private:
  static void read(World& world, bool by_states, std::span<const Slot> into, const std::byte* rows);

  Plan plan_;
  bool shares_ = false;  ///< rows are read where their owners write them (SharedRows), without messages
  std::vector<std::uint32_t> first_of_rank_;  ///< by rank, then: the first of its rows that are for this one
  std::vector<Slot> from_, into_;
  RowBytes out_, in_;
  double bytes_ = 0.0;
};

}  // namespace epafi
