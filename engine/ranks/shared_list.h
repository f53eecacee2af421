/// @file shared_list.h  The pair list of a part: where all processes make a new one in the same step, none waits for
/// the others to do so in other steps. No result depends on the age of a list.
#pragma once

namespace epafi {

class SharedList {
 public:
  virtual ~SharedList() = default;
  /// Whether and why a list ends.
  struct End {
    bool comes = false;    ///< it will not last for the next step
    bool by_slow = false;  ///< a body of the least margin will have used it up, from which the next margins are learned
  };
  virtual End foreseen() const = 0;
  /// That of some process will end so: a new one in the next step, if half of this one is used up.
  virtual void end_with_others(const End& theirs) = 0;
};

}  // namespace epafi
