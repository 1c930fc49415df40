// Orders along a Hilbert curve: what is near in the order is near in the plane.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Position of cell (x, y) of a 2^16 x 2^16 grid along the Hilbert curve.
std::uint32_t hilbert_index(std::uint32_t x, std::uint32_t y);

/// Maps points of `box` to positions along a Hilbert curve through it.
class HilbertCurve {
 public:
  explicit HilbertCurve(const Bounds2& box);
  std::uint32_t operator()(Point2 p) const;

 private:
  Bounds2 box_;
  double scale_ = 0;
};

/// The indices of `keys` by ascending key, ties by index.
std::vector<std::int32_t> sorted_order(std::span<const std::uint32_t> keys);

}  // namespace tetropolis
