// The paper's random city as the mesh steps see it, and its mesh: what several benchmarks and the
// tests of work start from.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// A city after step 2, and its terrain.
struct CityInput {
  std::vector<Polygon> footprints;
  std::vector<double> roofs;  ///< Elevations.
  Raster dtm;
  Bounds2 domain;
};

/// `buildings` random rectangles on a square of `size` metres, cleaned and simplified, on rolling
/// terrain with a node a metre. Kept: later calls with the same arguments return the same object.
const CityInput& random_city_input(std::int64_t buildings, double size = 2500);

/// Steps 3.2 to 3.5 with default settings but this mesh size.
ColumnMesh columns_over(const CityInput& input, GroundMesh ground, double mesh_size);

/// Steps 3.1 to 3.5.
ColumnMesh mesh_of(const CityInput& input, double mesh_size);

}  // namespace tetropolis
