#include "measured_ground.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_index.h"
#include "core/parallel.h"
#include "core/shared_progress.h"

namespace tetropolis {

namespace {

constexpr double kNear = 0.5;  // metres above the terrain

/// Cells over a footprint's box; what points say of each is two bits of a byte.
struct FootprintCells {
  Bounds2 box;
  double width = 2;
  std::size_t columns = 1, rows = 1, first = 0;

  explicit FootprintCells(const Polygon& footprint) : box(bounds(footprint)) {
    constexpr double kShare = 0.1;
    width = std::max(width, kShare * std::sqrt(std::max(box.width() * box.height(), 0.0)));
    columns = static_cast<std::size_t>(box.width() / width) + 1;
    rows = static_cast<std::size_t>(box.height() / width) + 1;
  }
  std::size_t at(Point2 p) const {
    const auto i = static_cast<std::size_t>(std::max(0.0, (p.x - box.xmin) / width));
    const auto j = static_cast<std::size_t>(std::max(0.0, (p.y - box.ymin) / width));
    return first + std::min(j, rows - 1) * columns + std::min(i, columns - 1);
  }
};

}  // namespace

std::vector<std::size_t> find_measured_ground(std::span<const Building> buildings,
                                              const PointLists& roof, const PointCloud& cloud,
                                              const Raster& terrain, const Progress& progress) {
  constexpr std::uint8_t kAny = 1, kOnGround = 2;
  constexpr std::size_t kFew = 3, kTimes = 10;
  constexpr double kMost = 0.6;
  if (buildings.empty() || cloud.size() == 0) return {};
  std::vector<FootprintCells> cells;
  std::vector<const Polygon*> outlines;
  std::size_t size = 0;
  for (const Building& building : buildings) {
    outlines.push_back(&building.footprint);
    cells.emplace_back(building.footprint).first = size;
    size += cells.back().columns * cells.back().rows;
  }
  const FootprintIndex index(outlines, 0);
  std::vector<std::atomic<std::uint8_t>> said(size);
  std::vector<std::atomic<std::uint32_t>> ground(buildings.size());
  SharedProgress shared(progress, static_cast<std::int64_t>(cloud.size()));
  constexpr std::size_t kGrain = std::size_t{1} << 15;
  parallel_chunks(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::uint8_t code = cloud.classification[p];
      if (code == kLowNoise || code == kHighNoise) continue;
      const Point2 at{cloud.x[p], cloud.y[p]};
      index.at(at, [&](auto footprint, bool inside) {
        if (!inside) return;
        const auto b = static_cast<std::size_t>(footprint);
        const bool on_ground = is_ground(code) || cloud.z[p] <= sample(terrain, at) + kNear;
        if (on_ground) ground[b].fetch_add(1, std::memory_order_relaxed);
        said[cells[b].at(at)].fetch_or(on_ground ? kAny | kOnGround : kAny,
                                       std::memory_order_relaxed);
      });
    }
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  std::vector<std::size_t> found;
  for (std::size_t b = 0; b < buildings.size(); ++b) {
    if (ground[b] < kFew || ground[b] < kTimes * roof[b].size()) continue;
    const std::size_t count = cells[b].columns * cells[b].rows;
    std::size_t any = 0, on_ground = 0;
    for (std::size_t c = cells[b].first; c < cells[b].first + count; ++c) {
      any += (said[c] & kAny) != 0 ? 1 : 0;
      on_ground += (said[c] & kOnGround) != 0 ? 1 : 0;
    }
    if (static_cast<double>(on_ground) >= kMost * static_cast<double>(any)) found.push_back(b);
  }
  return found;
}

}  // namespace tetropolis
