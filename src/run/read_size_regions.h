// Areas with a size of their own, as the setting `refine` names them.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/pipeline/wind_domain.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// One entry of `refine`: FILE:SIZE or XMIN,YMIN,XMAX,YMAX:SIZE.
struct RefineEntry {
  std::string file;  ///< Empty: `box`.
  Bounds2 box;
  double size = 0;  ///< Metres, > 0.
};

/// Throws Error(kUsage) for what is neither.
RefineEntry parse_refine(const std::string& text);

/// All of them, in the city's CRS, which files are reprojected to; adds the warnings of read_areas.
/// Throws Error(kUsage) as above, Error(kInput) naming a file without polygons or as
/// read_footprints.
std::vector<SizeRegion> read_size_regions(const Config& config, const CityModel& city,
                                          std::vector<Warning>& warnings);

/// What `domain` names, in the coordinates of `crs`: the polygon of a file, of several features the
/// first, or the domain of the city in a folder of results, and the top of its mesh. Empty if it
/// names neither. Throws Error(kInput) as read_footprints and read_city, without a polygon, and for
/// a city in another system.
GivenDomain read_domain(const Config& config, const std::string& crs,
                        std::vector<Warning>& warnings);

}  // namespace tetropolis
