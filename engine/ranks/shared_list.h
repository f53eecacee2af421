/// @file shared_list.h  Common rebuilds of pair lists: all processes rebuild in the same step, so that none waits for
/// rebuilds of others in other steps. No result depends on the age of a list.
#pragma once

namespace epafi {

class SharedList {
 public:
  virtual ~SharedList() = default;
  /// Whether and why a list is about to end.
  struct End {
    bool comes = false;    ///< it is not valid for the next step
    bool by_slow = false;  ///< because of a body with the least margin, which the next margins depend on
  };
  virtual End predicted_end() const = 0;
  /// The list of some process ends: rebuild in the next step if half of this one's margin is used up.
  virtual void end_with_others(const End& theirs) = 0;
};

}  // namespace epafi
