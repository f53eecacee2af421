/// @file shared_list.h  The pair list of a part: where all processes make a new one in the same step, none waits for
/// the others to do so in other steps. No result depends on the age of a list.
#pragma once

namespace epafi {

class SharedList {
 public:
  virtual ~SharedList() = default;
  /// It will not last for the next step.
  virtual bool wears_out() const = 0;
  /// That of some process will not: a new one in the next step, if half of this one is used up.
  virtual void wear_out() = 0;
};

}  // namespace epafi
