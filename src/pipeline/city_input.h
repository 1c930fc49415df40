// What the steps of build_city work on. Private to src/pipeline.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/build_city.h"

namespace tetropolis {

struct CityInput {
  PointsInput points;  ///< Local frame.
  /// Points of files in which those of buildings have no class of their own (find_ground).
  std::vector<PointRange> no_buildings;
  FootprintsInput footprints;           ///< Local frame.
  Bounds2 domain;                       ///< Local frame.
  std::optional<Bounds2> covered;       ///< Of default_domain: the box of the points, local frame.
  std::string crs;                      ///< Of points and footprints; empty if nobody says.
  std::optional<TerrainInput> terrain;  ///< Its raster in the local frame.

  bool has_surface = false;  ///< See CitySources.

  bool has_points() const { return points.points.size() > 0; }
};

/// Brings all into one frame and finds the domain: as options.bounds says, or default_domain, or
/// without footprints the box of the points. Without bounds, points far from all others become
/// noise (find_stray_points; "stray_points"). Where there are no points, the box in which heights
/// are known takes their place. Adds warnings. Throws Error(kInput): neither points nor terrain, a
/// terrain that require_raster refuses, degrees, units other than metres, no overlap.
CityInput place_input(CitySources sources, const BuildCityOptions& options,
                      std::vector<Warning>& warnings);

}  // namespace tetropolis
