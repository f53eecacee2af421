/// @file fused_spheres.h  The fast path of smooth contact between spheres: pairs of free spheres, and of spheres with
/// fixed planes, go through laws/smooth/fused/sphere_kernel.h, all other contacts through the generic loop; forces of
/// both add up.
#pragma once
#include <memory>
#include <span>

#include "engine/drift.h"
#include "engine/pipeline.h"
#include "laws/smooth/fused/sphere_blocks.h"
#include "laws/smooth/make_smooth_contact.h"

namespace epafi {

class FusedSpheres : public ContactModel {
 public:
  /// Bodies are in new slots; radius: of the free spheres among them, else 0 [m].
  virtual void set_bodies(UnwrittenColumn<double> radius) = 0;
  /// The pairs that this model detects itself, whenever the list changes.
  virtual void set_pairs(const World& world, const SphereList& list) = 0;
  /// The list that was made now counts ways beside this drift.
  virtual void expect(const Drift& drift) = 0;
  /// By block of SphereBlocks::block_size: the largest way of a body in the step that has begun over half its margin,
  /// or more; empty: not known.
  virtual std::span<const double> largest_ways() const = 0;
  /// The list that set_pairs is called with next may go once it is laid out.
  virtual void lend(SpherePairs& list) = 0;
  /// A list is about to be made, and set_pairs will be called before the next act: SphereList::hurry goes, and of many
  /// bodies what is remembered between lists only.
  virtual void make_way() = 0;
  /// set_pairs must be called before the next act.
  virtual bool waits_for_pairs() const = 0;
};

/// Whether the parts of this set-up have a fused loop: a normal law for lanes, a friction spring or none, edges of
/// contacts not located.
bool has_fused_spheres(const SmoothSetup& setup);

/// spheres: the material of the free spheres. Null where has_fused_spheres is false.
std::unique_ptr<FusedSpheres> make_fused_spheres(const SmoothSetup& setup, std::size_t material);

/// Resistance to rolling, or dashpots beside the friction springs: more to read, to write and to remember.
bool needs_rolling_loop(const SmoothSetup& setup);
std::unique_ptr<FusedSpheres> make_fused_rolling(const SmoothSetup& setup, std::size_t material);

}  // namespace epafi
