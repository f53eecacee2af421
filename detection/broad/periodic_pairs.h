/// @file periodic_pairs.h  Pairs of a periodic cell, by any broad phase: it is shown the bodies and the images of those
/// that reach over a face. Images are held bodies to it, so that no two of them pair. Only periodic scenes pay.
#pragma once
#include <memory>

#include "detection/broad/broad_phase.h"

namespace epafi {

class PeriodicPairs final : public BroadPhase {
 public:
  /// inner: lists all pairs, those of spheres among them.
  PeriodicPairs(BroadSetup setup, std::unique_ptr<BroadPhase> inner);
  const char* name() const override { return inner_->name(); }
  /// Pair::image holds image_code of B's place in the low byte, of its place along unwrapped paths (the key of the
  /// contact) in the next. Sorted by bodies and key.
  void find_pairs(const World& world, PairList& pairs) override;
  void reorder(const Reordering& change) override { valid_ = false, inner_->reorder(change); }

 private:
  struct Image {
    Slot of;
    Wraps step;  ///< -1, 0, 1 along each axis
  };
  void choose_images(const World& world);
  /// Of slot i of shown_.
  Slot of(const World& world, std::size_t i) const {
    return i < world.size() ? static_cast<Slot>(i) : images_[i - world.size()].of;
  }
  static Vec3 place_of(const World& world, const Image& image) {
    return world.position[image.of] + world.cell->shift(image_code(image.step));
  }
  void follow(const World& world);
  void show(const World& world);
  void translate(const World& world, PairColumn& pairs) const;
  double fat_radius(const World& world, Slot s) const;

  BroadSetup setup_;
  std::unique_ptr<BroadPhase> inner_;
  ListBroadPhase* list_;  ///< inner_
  World shown_;
  std::vector<Image> images_;
  PairList found_;
  bool valid_ = false;
};

}  // namespace epafi
