// Terrain and surface from rasters, for runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// What the headers of rasters say together.
struct RasterHeaders {
  std::vector<std::filesystem::path> terrain, surface;
  std::string crs;                   ///< Of the first that states one.
  Bounds2 box = Bounds2::nothing();  ///< Of surface, else of terrain, in `crs`.
};

/// Of the settings' `dtm` and `dsm`. Errors: those of expand_raster_paths and inspect_raster.
RasterHeaders read_raster_headers(const Config& config);

/// Whether the rasters are in a system in which lengths are lengths on the ground.
bool tells_system(const RasterHeaders& rasters);

/// The system of a city without points: that of the rasters, else of the footprints, in metres,
/// where lengths in it are lengths on the ground; the zone of UTM, with a warning, where they are
/// in neither.
std::string system_without_points(const RasterHeaders& rasters, const FootprintsInput& footprints,
                                  std::vector<Warning>& warnings);

/// In `box` (CRS coordinates; empty: all). Pixels without value take the nearest one, with a
/// warning ("raster_filled"). Errors: those of read_elevations.
TerrainInput read_terrain(const Config& config, const RasterHeaders& rasters,
                          const std::string& crs, const Bounds2& box, Point2 origin,
                          std::vector<Warning>& warnings);

/// A point per cell of the surface in `box`. Errors: those of read_elevations.
PointsInput read_surface(const Config& config, const RasterHeaders& rasters, const std::string& crs,
                         const Bounds2& box, Point2 origin);

/// Ground at `ground_level`, where nothing tells of another, with a warning ("ground_level").
TerrainInput level_ground(const Config& config, const std::string& crs, const Bounds2& box,
                          Point2 origin, std::vector<Warning>& warnings);

}  // namespace tetropolis
