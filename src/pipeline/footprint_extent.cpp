#include "footprint_extent.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tetropolis/city/clean.h"
#include "tetropolis/geometry/polygon.h"

namespace tetropolis {

namespace {

/// Metres: what cleaning moves otherwise than by taking spikes away stays within this, and the
/// domain is then that of the file.
constexpr double kSpike = 1;

class Extent {
 public:
  Extent(std::span<const Footprint> features, double parallel_tolerance)
      : features_(features), parallel_tolerance_(parallel_tolerance) {
    boxes_.reserve(features.size());
    for (const Footprint& feature : features) boxes_.push_back(bounds(feature.polygon));
  }

  /// The greatest value of `reach` over the boxes of footprints that make a building, if any.
  template <class Reach>
  std::optional<double> side(const Reach& reach) {
    struct Candidate {
      double value;
      std::size_t feature;
      bool operator<(const Candidate& other) const { return value < other.value; }
    };
    std::vector<Candidate> heap;
    heap.reserve(boxes_.size());
    for (std::size_t i = 0; i < boxes_.size(); ++i)
      if (!boxes_[i].empty()) heap.push_back({reach(boxes_[i]), i});
    std::make_heap(heap.begin(), heap.end());
    std::optional<double> side;
    for (; !heap.empty() && (!side || heap.front().value > *side); heap.pop_back()) {
      std::pop_heap(heap.begin(), heap.end());
      const auto [value, feature] = heap.back();
      const Bounds2 box = cleaned(feature);
      if (box.empty()) continue;
      const double reached = value - reach(box) <= kSpike ? value : reach(box);
      side = side ? std::max(*side, reached) : reached;
    }
    return side;
  }

 private:
  /// The box of a footprint as it will be; empty where it will be dropped.
  Bounds2 cleaned(std::size_t feature) {
    const auto [entry, is_new] = cleaned_.try_emplace(feature, Bounds2::nothing());
    if (is_new) {
      const CleanedFootprint clean =
          clean_footprint(features_[feature].polygon, {parallel_tolerance_});
      if (clean.usable()) entry->second = bounds(clean.polygon);
    }
    return entry->second;
  }

  std::span<const Footprint> features_;
  double parallel_tolerance_;
  std::vector<Bounds2> boxes_;
  std::unordered_map<std::size_t, Bounds2> cleaned_;
};

}  // namespace

Bounds2 footprint_extent(std::span<const Footprint> features, double parallel_tolerance) {
  Extent extent(features, parallel_tolerance);
  const auto west = extent.side([](const Bounds2& b) { return -b.xmin; });
  if (!west) return Bounds2::nothing();
  const auto south = extent.side([](const Bounds2& b) { return -b.ymin; });
  const auto east = extent.side([](const Bounds2& b) { return b.xmax; });
  const auto north = extent.side([](const Bounds2& b) { return b.ymax; });
  return {-*west, -*south, *east, *north};
}

void bound_by_extent(FootprintsInput& footprints, double parallel_tolerance) {
  if (std::exchange(footprints.is_extent, true)) return;
  const Bounds2 extent = footprint_extent(footprints.features, parallel_tolerance);
  if (!extent.empty()) footprints.bounds = extent;
}

}  // namespace tetropolis
