// Trees, as the setting `canopies` names them.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/run/config.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/cell_zones.h"

namespace tetropolis {

/// The polygons of all files that meet the box of the city's domain, in its CRS, to which files are
/// reprojected; adds their warnings. Attributes of the files named leaf_area_density and crown_base
/// are what Canopy has; the former is config's without one. `measured`: BuiltCity::canopy_heights.
/// Where heights are measured, a polygon has the 90th percentile of the nodes in it. Polygons
/// without a height, or that is not above their crown_base, are left out with a warning. Throws
/// Error(kUsage) as parse_file_and_attribute; Error(kInput) as read_areas, for a file without a
/// polygon or such an attribute, and where heights are to be measured and `measured` is empty.
std::vector<Canopy> read_canopies(const Config& config, const CityModel& city,
                                  const Raster& measured, std::vector<Warning>& warnings);

}  // namespace tetropolis
