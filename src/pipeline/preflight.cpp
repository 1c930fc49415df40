#include "tetropolis/pipeline/preflight.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_index.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

/// Those of the footprints that have no point inside among every `stride`-th of the cloud.
std::vector<Polygon> without_points(std::vector<Polygon> footprints, const PointCloud& cloud,
                                    std::size_t stride) {
  if (footprints.empty()) return footprints;
  const FootprintIndex index(pointers_to(footprints), 0);
  std::vector<std::atomic<bool>> hit(footprints.size());
  constexpr std::size_t kGrain = std::size_t{1} << 15;
  parallel_chunks(cloud.size() / stride, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin * stride; p < end * stride; p += stride)
      index.at({cloud.x[p], cloud.y[p]}, [&](auto footprint, bool inside) {
        if (inside) hit[static_cast<std::size_t>(footprint)].store(true, std::memory_order_relaxed);
      });
  });
  std::vector<Polygon> rest;
  for (std::size_t i = 0; i < footprints.size(); ++i)
    if (!hit[i]) rest.push_back(std::move(footprints[i]));
  return rest;
}

}  // namespace

Preflight preflight(const PointsInput& points, const FootprintsInput& footprints,
                    const std::optional<Bounds2>& bounds) {
  Preflight found;
  const Bounds2 covered = points.extent.moved(points.origin);
  if (covered.empty()) return found;
  const double area = covered.width() * covered.height();
  if (area > 0) found.points_per_m2 = static_cast<double>(points.points.size()) / area;
  const Bounds2 wanted = bounds ? footprints.bounds.intersection(*bounds) : footprints.bounds;
  const Bounds2 common = wanted.intersection(covered);
  const double wanted_area = wanted.width() * wanted.height();
  if (!wanted.empty() && !common.empty() && wanted_area > 0)
    found.overlap = common.width() * common.height() / wanted_area;
  std::vector<Polygon> near;
  for (const Footprint& feature : footprints.features) {
    const Bounds2 box = tetropolis::bounds(feature.polygon);
    if (box.empty() || (bounds && !bounds->intersects(box))) continue;
    ++found.footprints;
    // What a broken coordinate makes larger than a city is no building.
    constexpr double kLargest = 1e5;
    if (!covered.intersects(box) || !(std::max(box.width(), box.height()) < kLargest)) continue;
    for_each_vertex(near.emplace_back(feature.polygon), [&](Point2& p) {
      p = {p.x - points.origin.x, p.y - points.origin.y};
    });
  }
  // A few of the points find most of the footprints; the rest is then looked for with all of them.
  constexpr std::size_t kFew = 16;
  const std::size_t candidates = near.size();
  near = without_points(without_points(std::move(near), points.points, kFew), points.points, 1);
  found.footprints_with_points = static_cast<std::int64_t>(candidates - near.size());
  return found;
}

}  // namespace tetropolis
