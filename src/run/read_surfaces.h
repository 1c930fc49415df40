// Water, roads and vegetation, as the setting `surface_layers` names them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/ground/surfaces.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// One entry of `surface_layers`: FILE:KIND, or FILE:ATTRIBUTE.
struct SurfaceLayerEntry {
  std::string file;
  std::optional<SurfaceKind> kind;  ///< Of all polygons, or
  std::string attribute;            ///< the one that names the kind of each.
};

/// Throws Error(kUsage) for what is neither.
SurfaceLayerEntry parse_surface_layer(const std::string& text);

/// All of them, in the city's CRS, which files are reprojected to; adds the warnings of read_areas,
/// and one for polygons whose attribute names no kind, which are left out. Throws Error(kUsage) as
/// above, Error(kInput) naming a file without polygons of any kind or as read_footprints.
std::vector<SurfaceArea> read_surfaces(const Config& config, const CityModel& city,
                                       std::vector<Warning>& warnings);

}  // namespace tetropolis
