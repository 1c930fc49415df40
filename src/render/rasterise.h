// What is seen at each pixel. Private to src/render.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "camera.h"

namespace tetropolis {

/// Per pixel, row by row from the top.
struct VisibleMap {
  int width = 0;
  int height = 0;
  std::vector<float> nearness;         ///< Of what is seen; -infinity where nothing is.
  std::vector<std::int32_t> triangle;  ///< Its number; -1 where nothing is. Empty if not asked for.

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

using Triangles = std::span<const std::array<std::int32_t, 3>>;

/// The triangles' nearest points at the middle of every pixel, from either side; of equally near
/// ones the first. Corners are rounded to 1/256 of a pixel, so triangles with a common edge leave
/// no gap. What is nearer than the camera's near depth is clipped. The same for any number of
/// threads.
///
/// Source: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988 (edge
/// functions).
VisibleMap rasterise(std::span<const Vec3> points, Triangles triangles, const Camera& camera,
                     int width, int height, bool with_triangles = true);

}  // namespace tetropolis
