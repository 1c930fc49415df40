#include "common_crs.h"

#include <algorithm>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

#include "require_metres.h"

namespace tetropolis {

/// Without any statement about the system, coordinates that all fit on the globe and span less than
/// a few degrees are taken for what they almost certainly are.
void refuse_unmarked_degrees(const Bounds2& box, const std::string& file, const char* setting) {
  constexpr Bounds2 kGlobe{-180, -90, 180, 90}, kSwapped{-90, -180, 90, 180};
  if (box.empty() || std::max(box.width(), box.height()) > 2) return;
  const bool on_globe = kGlobe.covers(box);
  if (!on_globe && !kSwapped.covers(box)) return;
  throw Error(ErrorKind::kInput,
              fmt::format("{}: coordinates look like degrees ({:.5f}, {:.5f}) - ({:.5f}, {:.5f}){}",
                          file, box.xmin, box.ymin, box.xmax, box.ymax,
                          on_globe ? fmt::format("; name their CRS with {}", setting)
                                   : ", latitude first; exchange the two"));
}

std::string common_crs(const std::string& points_crs, const FootprintsInput& footprints) {
  if (!points_crs.empty()) {
    if (!footprints.crs.empty() && !footprints.features.empty() &&
        !same_horizontal_crs(points_crs, footprints.crs))
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: footprints are in {}, points in {}; read them with target_crs",
                              footprints.source, crs_name(footprints.crs), crs_name(points_crs)));
    return points_crs;
  }
  if (footprints.crs.empty()) return {};
  // GeoJSON without a word about it is in degrees; without a footprint it says nothing.
  if (is_geographic(footprints.crs) && footprints.features.empty()) return {};
  if (is_geographic(footprints.crs))
    throw Error(
        ErrorKind::kInput,
        fmt::format(
            "{}: footprints are in degrees ({}) and the point cloud has no CRS of its own; name it "
            "with points_crs (or that of the footprints with footprints_crs, if they are not)",
            footprints.source, crs_name(footprints.crs)));
  if (const double unit = linear_unit_metres(footprints.crs); !is_metre(unit))
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: footprints are in units of {} m ({}) and the point cloud has no CRS of "
                    "its own; name it with points_crs",
                    footprints.source, unit, crs_name(footprints.crs)));
  return footprints.crs;
}

std::string common_crs(const PointsInput& points, const FootprintsInput& footprints) {
  require_metres(points.crs, points.source, "points_crs");
  std::string crs = common_crs(points.crs, footprints);
  if (crs.empty() || footprints.crs.empty())
    refuse_unmarked_degrees(footprints.bounds, footprints.source, "footprints_crs");
  if (crs.empty())
    refuse_unmarked_degrees(points.extent.moved(points.origin), points.source, "points_crs");
  return crs;
}

}  // namespace tetropolis
