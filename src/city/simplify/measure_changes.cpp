#include "measure_changes.h"

#include <algorithm>
#include <cstddef>

#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "core/parallel.h"
#include "core/shared_progress.h"
#include "hausdorff_distance.h"
#include "symmetric_difference.h"

namespace tetropolis {

namespace {

constexpr double kDistanceTolerance = 0.01 * grid::kSteps;

FootprintChange change_of(const Group& group) {
  const std::vector<Polygon> output{group.polygon};
  if (output == group.input) return {};
  std::vector<DifferenceStrip> strips;
  const double changed = symmetric_difference_area(group.input, output, &strips);
  const HausdorffDistance far = hausdorff_distance(group.input, output, strips, kDistanceTolerance);
  return {changed / grid::kSquareMetre, far.distance / grid::kSteps, grid::to_metres(far.at)};
}

}  // namespace

std::vector<FootprintChange> measure_changes(std::span<const Group> groups, SimplifyStats& stats,
                                             const Progress& progress) {
  std::vector<FootprintChange> changes(groups.size());
  SharedProgress shared(progress, static_cast<std::int64_t>(groups.size()));
  parallel_chunks(groups.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) changes[k] = change_of(groups[k]);
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  stats.symmetric_difference = stats.area_dropped;
  for (const Group& group : groups) {
    stats.area_before += total_area(group.input) / grid::kSquareMetre;
    stats.area_after += area(group.polygon) / grid::kSquareMetre;
  }
  for (const FootprintChange& change : changes) {
    stats.symmetric_difference += change.symmetric_difference;
    stats.max_hausdorff_distance =
        std::max(stats.max_hausdorff_distance, change.hausdorff_distance);
  }
  return changes;
}

}  // namespace tetropolis
