/// @file sphere_springs.h  Memory of the touching contacts of a block, contiguous in the order of the pairs. A step
/// reads them in order and writes them a few places lower, which leaves room for new contacts before those not yet
/// read.
#pragma once
#include <cstdint>
#include <span>

#include "engine/state/large_column.h"
#include "laws/smooth/bristles.h"

namespace epafi {

/// Load of a contact, which differs from its memory if there are dashpots. Written only if an observer may read it.
struct alignas(32) SphereLoads {
  Lanes friction, moment;  ///< x y z on A [N], [N m]; unused
};

/// Needs of the parts of a law.
struct SphereNeeds {
  bool friction = false;
  bool dashpots = false;  ///< beside the friction springs
  bool rolling = false;   ///< resistance to rolling, with springs and moments of its own
  bool normal = false;    ///< the normal law has memory (one number)
  bool push = false;      ///< the normal law damps: the force of its dashpot is remembered
  bool bristles = false;  ///< friction is a row of bristles
  bool remembers() const { return friction || normal || push; }
  /// True if contacts turn bodies.
  bool turns() const { return friction || damps_slip(); }
  /// True if spins at the time of the detection are needed and loads differ from those of the springs.
  bool damps_slip() const { return dashpots || rolling; }
};

class SphereSprings {
 public:
  static constexpr std::uint32_t lead = 12;     ///< a third of it is for new contacts; see make_room
  static constexpr std::uint32_t unloaded = 0;  ///< place of a spring that is never changed
  static constexpr std::uint32_t fresh = 0xffffffffu;

  /// Next places that a step reads and writes, and the next record across blocks.
  struct Places {
    std::uint32_t read = 0, write = 0, record = 0;
  };

  explicit SphereSprings(const SphereNeeds& needs) : needs_(needs) {}
  std::uint32_t count() const { return last_ - first_; }
  /// Memory of the touching contact number `rank`.
  TileSpring& friction(std::uint32_t rank) { return friction_[first_ + rank]; }
  const TileSpring& friction(std::uint32_t rank) const { return friction_[first_ + rank]; }
  TileSpring& rolling(std::uint32_t rank) { return rolling_[first_ + rank]; }
  const TileSpring& rolling(std::uint32_t rank) const { return rolling_[first_ + rank]; }
  const SphereLoads& loads(std::uint32_t rank) const { return loads_[first_ + rank]; }
  double& normal(std::uint32_t rank) { return normal_[first_ + rank]; }
  double normal(std::uint32_t rank) const { return normal_[first_ + rank]; }
  double& push(std::uint32_t rank) { return push_[first_ + rank]; }
  double push(std::uint32_t rank) const { return push_[first_ + rank]; }
  PackedBristles& bristles(std::uint32_t rank) { return bristles_[first_ + rank]; }
  const PackedBristles& bristles(std::uint32_t rank) const { return bristles_[first_ + rank]; }

  /// Renumbers: contact k was number from[k] before, or is `fresh` (not loaded).
  void choose(std::span<const std::uint32_t> from);

  Places begin_step();
  /// Moves springs from `place` on, which the step has not read, up; returns by how many places.
  std::uint32_t make_room(std::uint32_t place);
  void end_step(Places now) {
    first_ -= lead;
    last_ = now.write;
  }
  /// By place.
  TileSpring* friction() { return friction_.data(); }
  TileSpring* rolling() { return rolling_.data(); }
  SphereLoads* loads() { return loads_.data(); }
  double* normal() { return normal_.data(); }
  double* push() { return push_.data(); }
  PackedBristles* bristles() { return bristles_.data(); }

 private:
  template <class F>
  void each_column(const F& f) {
    if (needs_.friction) f(friction_);
    if (needs_.rolling) f(rolling_);
    if (needs_.damps_slip()) f(loads_);
    if (needs_.normal) f(normal_);
    if (needs_.push) f(push_);
    if (needs_.bristles) f(bristles_);
  }
  void grow(std::size_t size);
  void move_up(std::uint32_t place, std::uint32_t by);
  void move_to_end();

  SphereNeeds needs_;
  UnwrittenColumn<TileSpring> friction_, rolling_;
  UnwrittenColumn<SphereLoads> loads_;
  UnwrittenColumn<double> normal_;  ///< largest overlap, root of the contact radius ...
  UnwrittenColumn<double> push_;    ///< force of the dashpot [N]
  UnwrittenColumn<PackedBristles> bristles_;
  std::uint32_t first_ = 0, last_ = 0, room_ = 0;
};

}  // namespace epafi
