#include "fill_smoothly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::size_t kRowGrain = 64;

/// A node in the middle of each square of 2 x 2 nodes, with the mean of the known heights in 4 x 4,
/// weighted as bilinear interpolation weighs them. (With means of 2 x 2, slopes depend on where the
/// grid begins: what lies at the edge of squares of all sizes gets a cliff beside it.)
Raster coarser(const Raster& fine) {
  Raster coarse{(fine.nx + 1) / 2,       (fine.ny + 1) / 2, fine.x0 + fine.step / 2,
                fine.y0 + fine.step / 2, 2 * fine.step,     {}};
  coarse.values.resize(row_major(0, coarse.ny, coarse.nx));
  constexpr std::array<double, 4> kWeights{1, 3, 3, 1};
  parallel_chunks(
      static_cast<std::size_t>(coarse.ny), kRowGrain, [&](std::size_t begin, std::size_t end) {
        for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j)
          for (std::int32_t i = 0; i < coarse.nx; ++i) {
            double sum = 0, weight = 0;
            for (std::int32_t v = std::max(2 * j - 1, 0); v < std::min(2 * j + 3, fine.ny); ++v)
              for (std::int32_t u = std::max(2 * i - 1, 0); u < std::min(2 * i + 3, fine.nx); ++u) {
                const double z = fine.at(u, v);
                if (std::isnan(z)) continue;
                const double own = kWeights[static_cast<std::size_t>(u - 2 * i + 1)] *
                                   kWeights[static_cast<std::size_t>(v - 2 * j + 1)];
                sum += own * z;
                weight += own;
              }
            coarse.values[row_major(i, j, coarse.nx)] =
                weight > 0 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
          }
      });
  return coarse;
}

}  // namespace

void fill_smoothly(Raster& raster) {
  const auto is_empty = [](double z) { return std::isnan(z); };
  if (std::none_of(raster.values.begin(), raster.values.end(), is_empty)) return;
  Raster coarse = coarser(raster);
  fill_smoothly(coarse);
  parallel_chunks(
      static_cast<std::size_t>(raster.ny), kRowGrain, [&](std::size_t begin, std::size_t end) {
        for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j)
          for (std::int32_t i = 0; i < raster.nx; ++i)
            if (double& z = raster.values[row_major(i, j, raster.nx)]; is_empty(z))
              z = sample(coarse, {raster.x0 + i * raster.step, raster.y0 + j * raster.step});
      });
}

}  // namespace tetropolis
