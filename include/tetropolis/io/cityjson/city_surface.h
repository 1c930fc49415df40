// The faces of a CityJSON model as triangles: what it looks like, roofs as they are.
#pragma once

#include <filesystem>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

struct CitySurface {
  SurfaceMesh surface;  ///< Local frame. Orientation as in the file.
  Point2 origin;        ///< Of the local frame, CRS coordinates.
};

/// Reads the most detailed geometry, from LoD 1 on, of every Building and BuildingPart, each with a
/// number of its own in the order of their keys, and of every TINRelief, which is ground. Faces are
/// roofs where semantics or their slope say that, else walls; GroundSurfaces are left out.
/// Throws Error(kInput) as read_city does; a model without faces has none here.
CitySurface read_city_surface(const std::filesystem::path& path);

}  // namespace tetropolis
