// Guarantee 5 on a written boundary, and on what is written of it to look at.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/geometry/domain.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

struct SurfaceCheck {
  std::int64_t vertices = 0;
  std::int64_t triangles = 0;  ///< Faces of three corners;
  std::int64_t quads = 0;      ///< and of four.
  bool closed = false;
  bool manifold = false;
  double enclosed_volume = 0;  ///< By the divergence theorem.
  double area = 0;
  double highest = 0;  ///< Greatest elevation of its vertices, in the file's coordinates.
  double lowest_top = std::numeric_limits<double>::infinity();  ///< Least of the top's.
  Bounds2 box;  ///< Of its vertices in the plan, in the file's coordinates.
  std::vector<PatchCount> faces_by_patch;
  std::vector<Violation> violations;
};

/// Finite, closed, oriented and edge-manifold; sides lie on the sides of the bounding box, or of
/// `domain` (in the surface's coordinates) to a micrometre, which names them; walls are vertical,
/// ground and roofs face down, buildings are named where they must be and nowhere else, and roof
/// and wall faces that share an edge name the same one. Whether roofs are those of the city model,
/// check_heights says.
SurfaceCheck check_surface(const SurfaceMesh& surface, const Domain* domain = nullptr);

/// The same of a city_surface(): ground and roofs face up, and edges with one face lie on the
/// sides. Encloses nothing.
SurfaceCheck check_city_surface(const SurfaceMesh& surface, const Domain* domain = nullptr);

}  // namespace tetropolis
