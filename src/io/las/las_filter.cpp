#include "las_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetropolis {

namespace {

/// The numbers whose coordinates, number * scale + offset as it is rounded, lie in [low, high].
/// These do not decrease with the number, so that the ends are found by bisection.
NumberRange numbers_within(double scale, double offset, double low, double high) {
  const auto least_where = [&](const auto& holds) {
    std::int64_t below = kAllNumbers.first - std::int64_t{1};
    std::int64_t above = kAllNumbers.last + std::int64_t{1};
    while (above - below > 1) {
      const std::int64_t middle = below + (above - below) / 2;
      (holds(static_cast<double>(middle) * scale + offset) ? above : below) = middle;
    }
    return above;
  };
  const std::int64_t first = least_where([&](double value) { return value >= low; });
  const std::int64_t behind = least_where([&](double value) { return value > high; });
  if (first >= behind) return {};
  return {static_cast<std::int32_t>(first), static_cast<std::int32_t>(behind - 1)};
}

}  // namespace

LasFilter::LasFilter(const ReadPointsOptions& options, const LasInfo& info)
    : keep_withheld_(options.keep_withheld), skipped_(class_table(options.skipped_classes)) {
  if (!options.crop) return;
  const Bounds2& crop = *options.crop;
  x_ = numbers_within(info.scale[0], info.offset[0], crop.xmin, crop.xmax);
  y_ = numbers_within(info.scale[1], info.offset[1], crop.ymin, crop.ymax);
}

LasBlock LasFilter::keep(const LasBlock& block, LasBlockBuffer& kept) const {
  if (keeps_all(block)) return block;
  std::size_t n = 0;
  for (std::size_t i = 0; i < block.size(); ++i) {
    if (skips(block, i) || !x_.contains(block.x[i]) || !y_.contains(block.y[i])) continue;
    kept.x[n] = block.x[i];
    kept.y[n] = block.y[i];
    kept.z[n] = block.z[i];
    kept.classification[n] = block.classification[i];
    kept.withheld[n++] = block.withheld[i];
  }
  return kept.first(n);
}

bool LasFilter::skips(const LasBlock& block, std::size_t i) const {
  return skipped_[block.classification[i]] || (block.withheld[i] != 0 && !keep_withheld_);
}

bool LasFilter::keeps_all(const LasBlock& block) const {
  if (!x_.covers(block.x_range) || !y_.covers(block.y_range)) return false;
  unsigned skipped = 0;  // no branch in the loop
  for (const std::uint8_t code : block.classification) skipped |= skipped_[code] ? 1U : 0U;
  if (!keep_withheld_)
    for (const std::uint8_t withheld : block.withheld) skipped |= withheld;
  return skipped == 0;
}

BoxCheck::BoxCheck(const LasInfo& info) {
  inside_.fill(kAllNumbers);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::isnan(info.min[axis] + info.max[axis])) continue;  // it says nothing
    const auto [low, high] = std::minmax(info.min[axis], info.max[axis]);
    // Two steps for what rounding may have cut off.
    const double margin = 2 * info.scale[axis];
    inside_[axis] =
        numbers_within(info.scale[axis], info.offset[axis], low - margin, high + margin);
  }
}

std::int64_t BoxCheck::count_outside(const LasBlock& block) const {
  if (inside_[0].covers(block.x_range) && inside_[1].covers(block.y_range) &&
      inside_[2].covers(block.z_range))
    return 0;
  std::int64_t outside = 0;
  for (std::size_t i = 0; i < block.size(); ++i)
    if (!inside_[0].contains(block.x[i]) || !inside_[1].contains(block.y[i]) ||
        !inside_[2].contains(block.z[i]))
      ++outside;
  return outside;
}

}  // namespace tetropolis
