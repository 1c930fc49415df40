#include "default_domain.h"

#include <algorithm>

#include "tetropolis/city/clean.h"
#include "tetropolis/geometry/polygon.h"

#include "city/clip.h"

namespace tetropolis {

namespace {

/// Metres between a building and the boundary where there are no points: about a cell.
constexpr double kLeastMargin = 10;

}  // namespace

bool is_mostly_within(const Polygon& polygon, const Bounds2& box) {
  if (box.covers(bounds(polygon))) return true;
  return 2 * total_area(parts_in_domain(polygon, box)) >= area(polygon);
}

Bounds2 default_domain(const BuildCityOptions& options, const FootprintsInput& footprints,
                       const Bounds2& points, Point2 origin) {
  const Bounds2 box = footprints.bounds.moved({-origin.x, -origin.y});
  Bounds2 domain = box.intersection(points).grown(options.domain_margin).intersection(points);
  if (options.boundary_buildings == BoundaryBuildings::kClip || domain.empty()) return domain;
  const double margin = std::min(kLeastMargin, options.domain_margin);
  // Closer to the boundary, buildings are cut back from it.
  const Bounds2 well_inside = points.grown(-2 * options.simplify.min_distance).moved(origin);
  const Bounds2 within = points.moved(origin);
  const Bounds2 reach = within.grown(options.domain_margin);
  for (const Footprint& feature : footprints.features) {
    const Bounds2 raw = bounds(feature.polygon);
    if (!raw.intersects(within) || well_inside.covers(raw)) continue;
    const CleanedFootprint clean =
        clean_footprint(feature.polygon, {options.simplify.parallel_tolerance});
    if (!clean.usable()) continue;
    const Bounds2 whole = bounds(clean.polygon);
    if (whole.intersects(within) && reach.covers(whole) && is_mostly_within(clean.polygon, within))
      domain.extend(whole.grown(margin).moved({-origin.x, -origin.y}));
  }
  return domain;
}

}  // namespace tetropolis
