#include "clip.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/clean.h"
#include "tetropolis/geometry/polygon.h"

#include "geometry/geos.h"

namespace tetropolis {

namespace {

constexpr double kCrumb = 1;  // square metres: no building, whatever it was cut from

}  // namespace

std::vector<Polygon> parts_in_domain(const Polygon& polygon, const Domain& domain) {
  return geos::intersect(std::array{polygon}, std::array{domain.outline()}, kCoordinateStep)
      .value_or(std::vector<Polygon>());
}

std::vector<Polygon> clean_parts(std::vector<Polygon> parts, double least_area, double* lost_area) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Polygon& a, const Polygon& b) { return area(a) > area(b); });
  std::vector<Polygon> kept;
  double lost = 0;
  for (Polygon& part : parts) {
    if (area(part) < (kept.empty() ? std::min(kCrumb, least_area) : least_area)) {
      lost += area(part);
      continue;
    }
    for_each_vertex(part, [](Point2& p) { p = snap_coordinate(p); });
    // The cut may have left but a sliver, or left vertices a hair apart.
    CleanedFootprint clean = clean_footprint(part, {.parallel_tolerance = 0});
    lost += clean.polygon.outer.empty() ? area(part) : clean.lost_area;
    if (!clean.polygon.outer.empty()) kept.push_back(std::move(clean.polygon));
  }
  if (lost_area != nullptr) *lost_area = lost;
  return kept;
}

std::vector<Polygon> clip_to_domain(const Polygon& polygon, const Domain& domain, double least_area,
                                    double* lost_area) {
  return clean_parts(parts_in_domain(polygon, domain), least_area, lost_area);
}

}  // namespace tetropolis
