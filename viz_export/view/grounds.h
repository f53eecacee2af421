/// @file grounds.h  Walls that hide nothing from an eye above them: floors, rails, a table. They are drawn solid, all
/// other walls translucent, as what they hold must be seen through them.
#pragma once
#include <map>
#include <vector>

#include "viz_export/view/view_source.h"

namespace epafi {

class Grounds {
 public:
  /// up: unit.
  explicit Grounds(const Vec3& up) : up_(up) {}
  void add(const ViewFrame& frame);

  /// Ids of the walls that lay below the centres of the free bodies in every frame added, ascending; of more than 50
  /// bodies the lowest 2 % do not count.
  std::vector<std::uint32_t> ids() const;
  /// The highest of their points, along `up` [m].
  double top() const;

 private:
  struct Wall {
    double top;  ///< along `up` [m]
    bool is_below;
  };
  Vec3 up_;
  std::map<std::uint32_t, Wall> walls_;
};

}  // namespace epafi
