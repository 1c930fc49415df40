// Vertices and faces of CityJSON.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "body_footprint.h"
#include "io/file/json_place.h"

namespace tetropolis {

/// Vertices of the file in the local frame.
struct CityFrame {
  std::vector<Point3> vertices;
  Point2 origin;
};

/// Of the document's `vertices` and `transform`, on the grid of coordinates. The origin is the
/// translation if that is in whole metres, else at the lowest vertex. `settle` may change them, as
/// coordinates of the file, before they are on the grid.
CityFrame read_vertices(const Place& root,
                        const std::function<void(std::vector<Point3>&)>& settle = {});

/// Why an object has no faces, or its faces.
struct ObjectFaces {
  std::vector<Face> faces;
  double lod = 0;  ///< Their level of detail.
  std::string reason;
};

/// The faces of a city object at its highest level of detail from 1 on.
ObjectFaces read_faces(const Place& object, const CityFrame& frame);

}  // namespace tetropolis
