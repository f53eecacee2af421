/// @file warm_start.h  Impulses of the last step as the start of this one.
/// A contact is matched by its key (bodies, feature). If clipping changed the name of a point (coincident edges of
/// aligned faces do so under rounding), the nearest unmatched point of the same pair provides the impulse: an aligned
/// stack of ten boxes drifts 0.4 mm in ten seconds with this rule, 1.7 mm without.
#pragma once
#include <optional>

#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

class WarmStart {
 public:
  /// r[i] = remembered impulse of contact i in its frame, 0 where there is none; projected on its cone.
  void recall(const World& world, const ContactSet& contacts, const ContactProblem& problem, Impulses& r);
  /// True if the recalled list has the same contacts in the same order as the last step.
  bool same() const;
  /// Data of contact i from the last step: the gap predicted for now [m], and the final slip velocity (B against A,
  /// world axes) [m/s]. -infinity and none for a contact that is new or had no impulse.
  double predicted_gap(std::size_t i) const;
  std::optional<Vec3> slip(std::size_t i) const;
  /// Stores the impulses of these contacts, the gaps predicted for the next detection [m], and the slip of the final
  /// relative velocities u.
  void remember(const World& world, const ContactSet& contacts, const ContactProblem& problem, const Impulses& r,
                std::span<const double> next_gap, const std::vector<Vec3>& u);
  void reorder(const Reordering& change);
  void visit(StateVisitor& visitor);

 private:
  /// Contacts of one pair: [begin, end) of the new list.
  struct Run {
    std::uint32_t begin, end;
  };
  void match_run(const World& world, const ContactSet& contacts, Run run);
  std::size_t find_pair(Slot a, Slot b, std::size_t guess) const;

  UnwrittenStream<Slot> a_, b_;
  UnwrittenStream<Feature> feature_;
  std::vector<Vec3> arm_;        ///< from A's centre, in A's axes [m]
  std::vector<Vec3> impulse_;    ///< on B, world axes [N s]
  UnwrittenStream<double> gap_;  ///< predicted [m]
  std::vector<Vec3> slip_;       ///< world axes [m/s]

  UnwrittenStream<std::uint32_t> runs_;      ///< of one pair each: the first contact
  UnwrittenStream<std::uint32_t> previous_;  ///< of each new contact: index in the remembered list, or none
  UnwrittenStream<std::uint8_t> by_name_;    ///< found by its key, not as the nearest of its pair
};

}  // namespace epafi
