/// @file territory.h  Ownership of bodies: parts of space, and the width of the ghost layer.
#pragma once
#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "engine/ranks/rank_team.h"
#include "engine/state/world.h"
#include "ranks/partition.h"
#include "ranks/state_image.h"

namespace epafi {

using Owners = std::vector<std::uint8_t>;  ///< as World::owner

class Territory {
 public:
  explicit Territory(PartSetup setup);

  /// Computes the ghost distance from the sizes of the present free bodies, and cuts with equal work. worked: processor
  /// time of this rank since the last cut [s], which gives the weight of its bodies. No result depends on it. Bodies
  /// are at rank 0. Called by all ranks.
  void cut(const World& world, const Owners& owner, double worked);
  /// The same where bodies are with their owners; time: of all ranks [s]; bodies: of all ranks.
  void cut_by_owners(const World& world, const Owners& owner, double worked, double time, double bodies);
  /// New cuts are worth a move: as much time was lost by waiting for the slowest rank, which took so long [s].
  static bool is_uneven(double longest, double time, double bodies);
  /// Ghosts are enough while no body has moved farther than this since it was placed [m].
  double margin() const { return margin_; }
  /// Bodies farther apart than this do not interact, except tied ones [m].
  double reach() const { return setup_.rings * (2.0 * largest_ + setup_.reach); }
  /// Enough for displacements of this length too; no more than so many times the usual margin.
  void widen(double longest, double most = std::numeric_limits<double>::infinity()) {
    margin_ = std::max(usual_margin_, std::min(2.0 * longest, most * usual_margin_));
  }
  /// The margin that suits best where so many bodies and ghosts of all ranks move that far at most in a step.
  void suit(double longest, double bodies, double ghosts);
  /// Finds by the present cuts the owners of the bodies here, and the ranks that need ghosts of them. Held ones go to
  /// `held`. place: by slot, as Routes::place.
  Routes routes(const World& world, const Owners& owner, const std::vector<std::uint32_t>& place,
                const std::vector<int>& held) const;
  /// Only ways along these axes (1, others 0) lead from one part to another.
  Vec3 cut_axes() const { return partition_.cut_axes(); }
  double radius(std::uint32_t shape) const { return setup_.radius(shape); }
  bool is_clump(std::uint32_t shape) const { return setup_.is_clump(shape); }

 private:
  static constexpr double time_of_move = 5e-7;  ///< of one body, where all ranks move theirs [s]
  void measure(const World& world, const Owners& owner);
  void add_ranks_of_tied(const World& world, const Owners& owner, Slot s, std::vector<int>& ranks) const;
  std::vector<float> weights(const std::vector<Vec3>& places, const std::vector<double>& worked) const;
  int owner(const Vec3& x, double half, int likely) const;

  PartSetup setup_;
  Partition partition_;
  double usual_margin_ = 0.0, margin_ = 0.0;     ///< [m]
  double largest_ = 0.0;                         ///< radius of all free bodies [m]
  std::vector<std::pair<BodyId, BodyId>> tied_;  ///< both ways, in order
};

std::vector<int> all_ranks();
/// Owners before the first distribution: rank 0 has all bodies.
Owners owners_of_whole(const World& world);
/// Owners of the bodies that have arrived.
Owners owners_of(const Arrival& arrival);
/// Every body and contact goes to rank 0, from the owner, held ones from rank 0 itself; world.owner is filled.
Routes routes_home(const World& world, const std::vector<std::uint32_t>& place);

}  // namespace epafi
