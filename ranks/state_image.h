/// @file state_image.h  A state as plain columns with the owner of their rows (RowsOf), and the transfer of rows
/// between ranks: bodies by their place in the order of all bodies, with the memory of their contacts. The same code
/// serves distribution, migration and gathering.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "engine/state/state_visitor.h"
#include "engine/state/world.h"
#include "ranks/row_bytes.h"

namespace epafi {

struct ImageColumn {
  std::string name;
  RowsOf whose = RowsOf::nobody;
  std::size_t row = 0;  ///< bytes of one
  RowBytes data;
  std::size_t rows() const { return data.size() / row; }
};
using StateImage = std::vector<ImageColumn>;
using StateWalk = std::function<void(StateVisitor&)>;

/// world: that of the walk, where its states of bodies go as they are, with all that contacts read of them.
StateImage image_of(const StateWalk& walk, const World* world = nullptr);
/// Into the state that the walk shows; it has the same columns.
void restore(StateImage& image, const StateWalk& walk, World* world = nullptr);

/// Destinations of the rows of a state.
struct Routes {
  static constexpr int all_ranks = -1;
  std::vector<std::uint32_t> place;  ///< by slot: of the body in the order of all bodies
  std::vector<int> owner;            ///< by slot: rank that owns the body from now on; all_ranks: every one has it
  std::vector<std::uint8_t> mine;    ///< by slot: this rank sends the body's rows
  std::vector<std::uint32_t> begin;  ///< by slot, and one more: of its ranks in `to`
  std::vector<int> to;               ///< ranks that get the rows of a body
  std::vector<int> to_all;           ///< ranks that get contacts of two bodies that every rank has
  bool gathers = false;              ///< all contacts go to rank 0
  bool to_one = false;               ///< a contact goes to the owner of its first free body, where both bodies go
};

/// Received bodies.
struct Arrival {
  std::vector<std::uint32_t> place;  ///< by slot, ascending
  std::vector<int> owner;            ///< as Routes::owner
  double bytes = 0.0;                ///< sent by this rank
};

/// Replaces the rows of the image by those received; common columns do not change. Called by all ranks.
Arrival exchange_rows(StateImage& image, const Routes& routes);

}  // namespace epafi
