#include "tetropolis/io/las/point_arrays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

namespace tetropolis {

namespace {

bool is_finite(const std::array<double, 3>& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

Point2 origin_of(const PointArrays& points, const ReadPointsOptions& options) {
  if (options.origin) return *options.origin;
  if (options.crop) return {std::floor(options.crop->xmin), std::floor(options.crop->ymin)};
  const auto first = std::find_if(points.xyz.begin(), points.xyz.end(), is_finite);
  if (first == points.xyz.end()) return {};
  return {std::floor((*first)[0]), std::floor((*first)[1])};
}

void require_size(const PointArrays& points, std::span<const std::uint8_t> array,
                  const char* name) {
  if (array.empty() || array.size() == points.xyz.size()) return;
  throw Error(ErrorKind::kUsage,
              fmt::format("{}: {} has {} elements for {} points; give one per point", points.source,
                          name, array.size(), points.xyz.size()));
}

void require_room(const PointsInput& input) {
  const Bounds2& box = input.extent;
  const double farthest = std::max({-box.xmin, -box.ymin, box.xmax, box.ymax});
  if (farthest <= PointCoordinate::kMost) return;
  throw Error(ErrorKind::kInput,
              fmt::format("{}: points lie {:.0f} km from ({:.0f}, {:.0f}), but only {:.0f} km can "
                          "be stored; set smaller bounds",
                          input.source, farthest / 1000, input.origin.x, input.origin.y,
                          PointCoordinate::kMost / 1000));
}

}  // namespace

PointsInput take_points(const PointArrays& points, const ReadPointsOptions& options) {
  require_size(points, points.classification, "classification");
  require_size(points, points.withheld, "withheld");
  PointsInput result;
  result.source = points.source;
  result.crs = normalise_crs(options.crs.empty() ? points.crs : options.crs);
  result.origin = origin_of(points, options);
  result.points_read = static_cast<std::int64_t>(points.xyz.size());
  FilePoints all;
  all.path = points.source;
  const ClassTable skipped = class_table(options.skipped_classes);
  std::int64_t not_finite = 0;
  PointCloud& cloud = result.points;
  for (std::size_t p = 0; p < points.xyz.size(); ++p) {
    const auto& [x, y, z] = points.xyz[p];
    const std::uint8_t code =
        points.classification.empty() ? std::uint8_t{kNeverClassified} : points.classification[p];
    ++all.by_class[code];
    if (!is_finite(points.xyz[p])) {
      ++not_finite;
      continue;
    }
    const bool withheld = !points.withheld.empty() && points.withheld[p] != 0;
    if (skipped[code] || (withheld && !options.keep_withheld) ||
        (options.crop && !options.crop->contains({x, y})))
      continue;
    const Point2 local{x - result.origin.x, y - result.origin.y};
    cloud.push_back(local.x, local.y, z, code);
    ++result.points_by_class[code];
    result.extent.extend(local);
  }
  all.kept = {0, cloud.size()};
  result.files.push_back(std::move(all));
  result.points_kept = static_cast<std::int64_t>(cloud.size());
  if (!result.extent.empty()) require_room(result);
  if (not_finite > 0)
    result.warnings.push_back({"points_not_finite", not_finite,
                               fmt::format("{}: {} points have coordinates that are not finite, "
                                           "and are left out",
                                           points.source, not_finite)});
  return result;
}

}  // namespace tetropolis
