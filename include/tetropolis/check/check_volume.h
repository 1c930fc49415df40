// Guarantees 4 and 5 on a written volume, and the shape of its cells and faces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Least, 0.01 %, 0.1 %, 1 % quantile, median, 99 % quantile and greatest of a distribution.
struct Distribution {
  double min = 0, p0_01 = 0, p0_1 = 0, p1 = 0, median = 0, p99 = 0, max = 0;
};

/// Cells whose least dihedral angle is smaller are counted as slivers.
inline constexpr double kSliverDihedralDeg = 12;

/// Shape of the faces as OpenFOAM's checkMesh measures it. Between two cells, non-orthogonality is
/// the angle between a face's normal and the line between the centres of its cells; skewness the
/// distance of the face's centre from where that line meets the face's plane, over the face's
/// extent in this direction (at least a fifth of the distance of the cell centres). On the
/// boundary, skewness is the same with the perpendicular from the cell's centre (at least 0.4 of
/// its length).
struct FaceMeasures {
  std::int64_t internal = 0;  ///< Faces between two cells.
  std::int64_t above_70 = 0;  ///< Of them more than 70 degrees non-orthogonal.
  double max_non_orthogonality_deg = 0;
  double mean_non_orthogonality_deg = 0;  ///< Arc cosine of the mean cosine, as checkMesh has it.
  double max_skewness = 0;                ///< Of all faces.
};

/// Shape of prisms as OpenFOAM's checkMesh measures it.
struct PrismMeasures {
  std::int64_t cells = 0;
  double max_aspect_ratio = 0;
  double least_flatness = 1;  ///< Area of a face over that of its parts; 1: plane.
};

struct VolumeCheck {
  std::int64_t vertices = 0;
  std::int64_t cells = 0;           ///< Tets and prisms.
  std::int64_t inverted = 0;        ///< Cells of zero or negative volume, somewhere.
  double volume = 0;                ///< Sum over the cells.
  std::int64_t boundary_faces = 0;  ///< Faces of one cell only.
  Distribution min_dihedral_deg;    ///< Of the least dihedral angle of each tet.
  double max_dihedral_deg = 0;
  std::int64_t slivers = 0;        ///< Tets below kSliverDihedralDeg.
  double least_vertical_edge = 0;  ///< Metres; infinite if no cell has such an edge.
  FaceMeasures faces;
  Distribution aspect_ratio;  ///< Of tets: longest edge over 2 sqrt(6)
                              ///< inradii.
  PrismMeasures prisms;
  std::vector<std::array<std::int64_t, 3>> boundary;  ///< The boundary faces, outward: triangles
  std::vector<std::array<std::int64_t, 4>> boundary_quads;  ///< and quadrilaterals.
  std::vector<Violation> violations;
};

/// Orientation of every cell, conformity by matching faces (one or two cells each, two with
/// opposite orientation), coincident and unused vertices, closed edge-manifold boundary. Vertex
/// numbers of cells must be in range. Takes some 20 bytes a cell beside the mesh. The same result
/// for any number of threads. Throws Error(kInput) for more than 2^32 vertices.
VolumeCheck check_volume(const TetMesh& mesh, const Progress& progress = {});

}  // namespace tetropolis
