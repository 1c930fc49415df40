#include "read_areas.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"

#include "core/files.h"
#include "io/vector/model_footprints.h"
#include "io/vector/osm/osm_elements.h"

namespace tetropolis {

namespace {

/// Of a reader of footprints, those that matter to areas: they have no heights, and no setting
/// names their CRS.
std::vector<Warning> warnings_of_areas(const std::string& file, const std::string& crs,
                                       std::vector<Warning> warnings) {
  std::erase_if(warnings, [](const Warning& w) { return w.code.starts_with("height_"); });
  const auto unknown = std::erase_if(
      warnings, [](const Warning& w) { return w.code.starts_with("footprints_crs_"); });
  if (unknown > 0 && !crs.empty())
    warnings.push_back({"areas_crs_unknown", 1,
                        fmt::format("{}: states no usable CRS; its areas are taken to be in "
                                    "that of the city ({}); if it is another, store it in the file",
                                    file, crs_name(crs))});
  return warnings;
}

}  // namespace

void warn_of_areas_outside(const std::string& entry, const Bounds2& areas, const Bounds2& domain,
                           std::vector<Warning>& warnings) {
  warnings.push_back(
      {"areas_outside", 1,
       fmt::format("{}: no area meets the domain, x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}; they lie "
                   "in x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}: check its CRS",
                   entry, domain.xmin, domain.xmax, domain.ymin, domain.ymax, areas.xmin,
                   areas.xmax, areas.ymin, areas.ymax)});
}

FootprintsInput read_areas(const std::string& file, const std::string& crs, const Bounds2& domain,
                           bool attributes, std::vector<Warning>& warnings) {
  if (is_file(file)) {
    if (is_osm_file(file))
      throw Error(ErrorKind::kInput,
                  file +
                      ": is an OpenStreetMap extract, of which only buildings are read; export "
                      "its areas first (ogr2ogr areas.gpkg EXTRACT multipolygons)");
    if (is_city_model(file))
      throw Error(
          ErrorKind::kInput,
          file + ": is a city model, of which only buildings are read; give a file of areas");
  }
  ReadFootprintsOptions options;
  options.target_crs = crs;
  options.attributes = attributes;
  FootprintsInput input = read_footprints(file, options);
  for (Warning& warning : warnings_of_areas(file, crs, std::move(input.warnings)))
    warnings.push_back(std::move(warning));
  const auto meets = [&](const Footprint& feature) {
    return bounds(feature.polygon).intersects(domain);
  };
  if (!domain.empty() && !input.features.empty() &&
      std::none_of(input.features.begin(), input.features.end(), meets))
    warn_of_areas_outside(file, input.bounds, domain, warnings);
  return input;
}

}  // namespace tetropolis
