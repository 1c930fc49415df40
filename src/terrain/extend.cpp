#include "extend.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/parallel.h"

namespace tetropolis {

namespace {

double smoothstep(double t) {
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// 0 inside.
double distance_to_box(const Bounds2& box, Point2 p) {
  const double dx = std::max({box.xmin - p.x, 0.0, p.x - box.xmax});
  const double dy = std::max({box.ymin - p.y, 0.0, p.y - box.ymax});
  return std::sqrt(dx * dx + dy * dy);
}

}  // namespace

double rim_height(const Raster& raster) {
  double sum = 0;
  std::int64_t count = 0;
  for (std::int32_t j = 0; j < raster.ny; ++j) {
    const bool is_end = j == 0 || j == raster.ny - 1;
    const std::int32_t step = is_end ? 1 : std::max(raster.nx - 1, 1);
    for (std::int32_t i = 0; i < raster.nx; i += step) {
      sum += raster.at(i, j);
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

Raster extend_terrain(const Raster& raster, const Bounds2& box, const TerrainFade& fade,
                      const Raster* wider) {
  const auto steps_before = [&](double from, double to) {
    return std::max(0.0, std::ceil((to - from) / raster.step));
  };
  const Bounds2 old = raster.bounds();
  const double west = steps_before(box.xmin, old.xmin), east = steps_before(old.xmax, box.xmax);
  const double south = steps_before(box.ymin, old.ymin), north = steps_before(old.ymax, box.ymax);
  const double nx = raster.nx + west + east, ny = raster.ny + south + north;
  constexpr double kMostNodes = 4e8;
  if (nx * ny > kMostNodes)
    throw Error(ErrorKind::kUsage,
                fmt::format("the terrain of the domain would have {:.0f} x {:.0f} nodes: raise "
                            "dtm_step, or ask for another domain",
                            nx, ny));
  Raster result;
  result.nx = static_cast<std::int32_t>(nx);
  result.ny = static_cast<std::int32_t>(ny);
  result.step = raster.step;
  result.x0 = raster.x0 - west * raster.step;
  result.y0 = raster.y0 - south * raster.step;
  result.values.resize(static_cast<std::size_t>(result.nx) * static_cast<std::size_t>(result.ny));
  const auto first_i = static_cast<std::int32_t>(west), first_j = static_cast<std::int32_t>(south);
  const auto fill_rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const auto j = static_cast<std::int32_t>(row);
      for (std::int32_t i = 0; i < result.nx; ++i) {
        const std::int32_t near_i = std::clamp(i - first_i, 0, raster.nx - 1);
        const std::int32_t near_j = std::clamp(j - first_j, 0, raster.ny - 1);
        const bool is_new = near_i != i - first_i || near_j != j - first_j;
        const Point2 p{raster.x0 + (i - first_i) * raster.step,
                       raster.y0 + (j - first_j) * raster.step};
        const double height =
            is_new && wider != nullptr ? sample(*wider, p) : raster.at(near_i, near_j);
        const Point2 in_frame{p.x * fade.along.x + p.y * fade.along.y,
                              p.y * fade.along.x - p.x * fade.along.y};
        double distance = distance_to_box(fade.core, in_frame);
        if (wider != nullptr) distance = std::min(distance, distance_to_box(wider->bounds(), p));
        const double share = smoothstep(distance / fade.width);
        result.values[row_major(i, j, result.nx)] =
            share > 0 ? height + share * (fade.height - height) : height;
      }
    }
  };
  parallel_chunks(static_cast<std::size_t>(result.ny), 64, fill_rows);
  return result;
}

}  // namespace tetropolis
