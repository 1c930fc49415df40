#include "preflight_line.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/geo_place.h"

namespace tetropolis {

namespace {

/// The middle of the points, which are there, and who says so.
std::string where(const RunInput& input) {
  const bool stated = !input.points.crs.empty();
  const std::string& crs = stated ? input.points.crs : input.footprints.crs;
  const auto place = place_of(crs, input.points.extent.moved(input.points.origin));
  if (crs.empty()) return "place unknown (no CRS)";
  return fmt::format("{}{}{}", place ? place_text(*place) + ", " : "", crs_name(crs),
                     stated ? "" : " (of the footprints: the points have none)");
}

}  // namespace

std::string preflight_line(const Preflight& preflight, const RunInput& input) {
  if (input.points.points.size() == 0)
    return fmt::format("input: {}; no points: heights as footprints state them; ground of {}",
                       where(input), input.terrain ? input.terrain->source : "nothing");
  std::vector<int> classes;
  for (const auto& [code, count] : input.points.points_by_class)
    if (count > 0) classes.push_back(code);
  std::string line = fmt::format("input: {}; {:.2g} points per m2, class{} {}", where(input),
                                 preflight.points_per_m2, classes.size() == 1 ? "" : "es",
                                 fmt::join(classes, " "));
  if (preflight.footprints > 0)
    // Never 100 % where something is missing.
    line +=
        fmt::format("; they cover {:.0f} % of the footprints' box, {} of {} footprints have some",
                    std::floor(100 * preflight.overlap), preflight.footprints_with_points,
                    preflight.footprints);
  return line;
}

}  // namespace tetropolis
