/// @file cell_events.h  Events of a periodic cell between steps: wrapping of bodies, deformation.
#pragma once
#include <optional>

#include "engine/step/events.h"

namespace epafi {

/// Wraps all bodies into the cell as soon as one is `slack` outside; not at every crossing, since each wrap rebuilds
/// the pair list.
class WrapBodies final : public Event {
 public:
  /// slack [m], > 0
  explicit WrapBodies(double slack) : slack_(slack) {}
  void before_step(World& world, double, std::vector<BodyId>&) override {
    if (asks(world)) answer(world);
  }
  bool is_local() const override { return true; }
  bool is_common() const override { return true; }
  bool asks(const World& world) const override;
  void answer(World& world) override;

 private:
  double slack_;
};

/// Deforms the cell and moves the free bodies with it, at a given rate or towards a pressure. Pressure: each periodic
/// axis strains at rate_limit s (sigma - P)/P, at most rate_limit s, with the contact stress sigma along it and a
/// factor s <= 1 that falls while the direction keeps changing.
struct CellControl {
  Vec3 strain_rate = Vec3::Zero();                   ///< [1/s]; where no pressure is given
  std::optional<double> pressure;                    ///< P [Pa], > 0
  double rate_limit = 0.0;                           ///< [1/s], > 0
  double first_pressure = 0.0, pressure_time = 0.0;  ///< P goes geometrically from the first [Pa] until then [s]; 0: P

  double pressure_at(double time) const;
};

class DeformCell final : public Event {
 public:
  /// elapsed: of its time when the present stage began [s].
  explicit DeformCell(CellControl control, double elapsed = 0.0) : control_(control), elapsed_(elapsed) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  /// Every process knows the virial of all contacts (engine/state/virial.h) and moves its own bodies.
  bool is_local() const override { return true; }
  void visit(StateVisitor& visitor) override { visitor.value("cell/share", share_); }

 private:
  CellControl control_;
  double elapsed_;
  Vec3 share_ = Vec3::Ones();
};

}  // namespace epafi
