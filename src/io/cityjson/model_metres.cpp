#include "model_metres.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/metric_crs.h"

#include "io/crs/gdal_support.h"
#include "io/file/input_file.h"

namespace tetropolis {

ModelMetres put_into_metres(const std::filesystem::path& path, const std::string& stated,
                            const std::string& crs, std::vector<Point3>& points) {
  constexpr double kMostLatitude = 90;
  ModelMetres result{crs};
  if (crs.empty() || points.empty()) return result;
  gdal::initialise();
  const gdal::QuietErrors errors;
  const bool degrees = is_geographic(crs);
  const double unit = degrees ? 1 : linear_unit_metres(crs);
  const gdal::Srs whole = gdal::parse_whole_srs(stated);
  result.height_unit =
      gdal::vertical_name(whole.get()).empty() ? unit : gdal::vertical_unit_metres(whole.get());
  if (!is_metre(result.height_unit))
    for (Point3& p : points) p[2] *= result.height_unit;
  if (!degrees && is_metre(unit)) return result;
  if (degrees && std::any_of(points.begin(), points.end(),
                             [](const Point3& p) { return std::abs(p[1]) > kMostLatitude; }))
    for (Point3& p : points) std::swap(p[0], p[1]);
  std::vector<Point2> plan;
  Bounds2 box = Bounds2::nothing();
  for (const Point3& p : points) {
    plan.push_back({p[0], p[1]});
    box.extend(plan.back());
  }
  result.crs =
      degrees ? utm_zone({(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2}) : in_metres(crs);
  plan = reproject(plan, crs, result.crs);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(plan[i].x)) fail_input(path, "has coordinates that are none of its CRS");
    points[i] = {plan[i].x, plan[i].y, points[i][2]};
  }
  return result;
}

}  // namespace tetropolis
