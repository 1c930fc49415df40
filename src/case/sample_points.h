// Points above the ground where people are.
#pragma once

#include <vector>

#include "foam_mesh.h"

namespace tetropolis {

struct SamplePoints {
  double spacing = 0;  ///< Of their grid [m].
  std::vector<Point3> points;
};

/// The nodes (x, y) = (i + 1/2, j + 1/2) * spacing over faces on the ground (walls that are of
/// no building, and not water), `height` above them, in the town, or everywhere if there is
/// none; row by row from the south. The spacing is doubled until they are 400,000 at most.
SamplePoints sample_points(const FoamMesh& mesh, double height, double spacing);

}  // namespace tetropolis
