// Planes among the points of a roof. Private to src/city.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct DetectPlanesOptions {
  double reach = 0.25;    ///< Metres off a plane, square to it, at which a point is still on it.
  double min_area = 2;    ///< Square metres: planes with fewer points than that has are none.
  double flatness = 0.2;  ///< Metres: rms of a seed and its neighbours off their plane, at most.
};

struct DetectedPlane {
  RoofPlane plane;
  Bounds2 box;  ///< Of its points.
};

/// Planes grown along the edges of the points' Delaunay triangulation, from the flattest seeds on;
/// each of at least max(5, min_area * density) points, no steeper than kMaxRoofSlope. In the order
/// in which they were found. `density`: points per square metre.
/// Source: region growing as in Rabbani, van den Heuvel, Vosselman, "Segmentation of point clouds
/// using smoothness constraint" (2006), on a triangulation.
std::vector<DetectedPlane> detect_planes(std::span<const Point3> points, double density,
                                         const DetectPlanesOptions& options = {});

}  // namespace tetropolis
