// A vertical plane through a mesh. Private to src/render.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

#include "vec3.h"

namespace tetropolis {

/// Seen from the front: `along` to the right, the part behind it at positive distances.
struct CutPlane {
  Vec3 through;
  Vec3 along;   ///< Of length 1, level.
  Vec3 behind;  ///< The same, at a right angle.

  double distance(Vec3 p) const { return dot(p - through, behind); }
  double position(Vec3 p) const { return dot(p - through, along); }
  Vec3 at(Point2 p) const { return through + p.x * along + (p.y - through.z) * Vec3{0, 0, 1}; }
};

/// The plane whose line runs in the compass direction `azimuth`, degrees, through `through`.
CutPlane plane_along(double azimuth, Vec3 through);

/// A cell in the plane: x along the line, y elevation, metres.
struct CutCell {
  std::array<Point2, 4> corners;  ///< In order around it.
  int size = 3;                   ///< Of these: 3 or 4.
  std::int64_t cell = 0;          ///< Tets first, then prisms.
};

/// Every cell that has vertices on both sides, in their order (prisms are upright); vertices in the
/// plane count as behind it. Cells cover what the volume covers of the plane, once.
std::vector<CutCell> cut_cells(const TetMesh& mesh, const CutPlane& plane);

/// A face in the plane.
struct CutFace {
  std::array<Point2, 2> ends;
  PatchKind kind;
  BuildingIndex building;
};

/// Ground, roofs and walls, likewise.
std::vector<CutFace> cut_faces(const SurfaceMesh& surface, const CutPlane& plane);

}  // namespace tetropolis
