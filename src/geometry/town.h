// Where the buildings are, for what a wind case does among them.
#pragma once

#include <algorithm>

#include "tetropolis/geometry/types.h"

#include "core/infinity.h"

namespace tetropolis {

/// The box around the buildings, wider by the height of the highest roof above the lowest ground at
/// a wall.
class Town {
 public:
  /// A corner of a roof or wall.
  void add(const Point3& corner) {
    box_.extend(Point2{corner[0], corner[1]});
    low_ = std::min(low_, corner[2]);
    high_ = std::max(high_, corner[2]);
  }
  /// Empty without buildings.
  Bounds2 bounds() const { return box_.empty() ? box_ : box_.grown(high_ - low_); }

 private:
  Bounds2 box_ = Bounds2::nothing();
  double low_ = kInfinity;
  double high_ = -kInfinity;
};

}  // namespace tetropolis
