// Planes among the points of a roof. Private to src/city.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct DetectedPlane {
  RoofPlane plane;
  Bounds2 box;  ///< Of its points.
};

/// Planes grown along the edges of the points' Delaunay triangulation, from the flattest seeds on;
/// each of at least 5 points, and as many as 2 m^2 have, no steeper than kMaxRoofSlope. In the
/// order in which they were found. `density`: points per square metre. Source: region growing as in
/// Rabbani, van den Heuvel, Vosselman, "Segmentation of point clouds using smoothness constraint"
/// (2006), on a triangulation.
std::vector<DetectedPlane> detect_planes(std::span<const Point3> points, double density);

}  // namespace tetropolis
