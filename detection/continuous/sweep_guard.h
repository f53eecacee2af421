/// @file sweep_guard.h  Keeps flagged bodies from passing through others within a step (`continuous = true` of a body).
/// A flagged body whose path leads it deeper into another than a tenth of its inner radius is stopped where it first
/// touches (where it was, if it touched already); its velocity is left to the contact model. Bodies that only graze,
/// slide or roll are not stopped. At a hollow wall, which has no inside, the ball inscribed about the body's centre
/// must not pass. Other bodies cost nothing but the tests of the flagged ones against them.
#pragma once
#include <cstdint>
#include <vector>

#include "detection/continuous/time_of_impact.h"
#include "detection/shape_store.h"
#include "engine/step/pipeline.h"

namespace epafi {

class SweepGuard final : public MotionGuard {
 public:
  /// `shapes` must outlive this.
  SweepGuard(const ShapeStore& shapes, std::vector<BodyId> flagged) : shapes_(shapes), flagged_(std::move(flagged)) {}

  const char* name() const override { return "continuous"; }
  void remember(const World& world) override;
  double hold_back(World& world, double duration) override;

  std::uint64_t held() const { return held_; }  ///< times a body was held back, since the start
  std::uint64_t unfinished() const {
    return capped_;
  }  ///< searches that ended at the cap: held at a time certainly before touch

 private:
  struct Hit {
    double share = 1.0;
    bool found = false;
  };
  void look(const World& world, double duration, std::size_t k, Hit& hit);
  void meet(const MovingBody& a, double allowed, const MovingBody& b, Hit& hit);

  const ShapeStore& shapes_;
  std::vector<BodyId> flagged_;
  std::vector<Pose> before_;  ///< of the flagged bodies
  std::vector<Hit> hits_;
  std::vector<std::uint32_t> triangles_;
  std::uint64_t held_ = 0, capped_ = 0;
};

}  // namespace epafi
