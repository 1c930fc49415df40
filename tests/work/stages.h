// The stages whose work is counted, on the paper's random city cut to a given number of buildings.
// Each is one function that is never inlined, so that tools find it by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "random_city.h"
#include "volume/layered/smooth.h"

namespace tetropolis::testing {

inline constexpr double kMeshSize = 10;

/// The raw footprints of the random city of this many buildings, at the density of the paper's
/// 3,096 on 2.5 km x 2.5 km.
struct WorkCity {
  std::int64_t buildings = 0;
  std::vector<Polygon> raw;
  const CityInput* input = nullptr;  ///< After simplification.
};
WorkCity work_city(std::int64_t buildings);

struct UniformResult {
  SolverReport ground, roofs;
  std::size_t nodes = 0;
};

Simplification work_simplify(const WorkCity& city);
/// Simplification where footprints crowd, in proportion to the buildings: copies of one, sheds far
/// smaller than their distance, and a star with narrow arms.
Simplification work_crowd(const WorkCity& city);
GroundMesh work_ground(const WorkCity& city);
/// Graded columns.
ColumnMesh work_columns(const WorkCity& city, const GroundMesh& ground);
/// Uniform layers and both solves.
UniformResult work_uniform(const WorkCity& city, const GroundMesh& ground);
/// Shapes of cells and faces. The number of faces.
std::int64_t work_quality(const ColumnMesh& mesh);
SurfaceMesh work_boundary(const ColumnMesh& mesh);
/// volume.vtu, boundary.vtp, surface.stl. Bytes written.
std::int64_t work_write(const ColumnMesh& mesh, const SurfaceMesh& boundary,
                        const std::string& folder);

}  // namespace tetropolis::testing
