// Independent checks of written meshes. Nothing here uses the code that made them: topology is
// re-derived from the cells, geometry from the coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// A guarantee that does not hold: how often, and the first place.
struct Violation {
  std::string what;  ///< Short clause, such as "inverted cells".
  std::int64_t count = 0;
  std::string first;  ///< Where it was seen first ("cell 17 at (1.0, 2.0, 3.0)").
};

/// Least, 0.01 %, 0.1 %, 1 % quantile, median and greatest of a distribution.
struct Distribution {
  double min = 0, p0_01 = 0, p0_1 = 0, p1 = 0, median = 0, p99 = 0, max = 0;
};

/// Cells whose least dihedral angle is smaller are counted as slivers.
inline constexpr double kSliverDegrees = 12;

/// Shape of the faces between two cells as OpenFOAM's checkMesh measures it: non-orthogonality is
/// the angle between a face's normal and the line between the centres of its cells; skewness the
/// distance of the face's centre from where that line meets the face's plane, over the face's
/// extent in this direction (at least a fifth of the distance of the cell centres).
struct FaceMeasures {
  std::int64_t internal = 0;  ///< Faces between two cells.
  std::int64_t above_70 = 0;  ///< Of them more than 70 degrees non-orthogonal.
  double max_non_orthogonality_deg = 0;
  double mean_non_orthogonality_deg = 0;  ///< Arc cosine of the mean cosine, as checkMesh has it.
  double max_skewness = 0;
};

struct VolumeCheck {
  std::int64_t vertices = 0;
  std::int64_t cells = 0;
  std::int64_t inverted = 0;        ///< Cells of zero or negative volume.
  double volume = 0;                ///< Sum over the cells.
  std::int64_t boundary_faces = 0;  ///< Faces of one cell only.
  Distribution min_dihedral_deg;    ///< Of the least dihedral angle of each cell.
  double max_dihedral_deg = 0;
  std::int64_t slivers = 0;  ///< Cells below kSliverDegrees.
  FaceMeasures faces;
  Distribution aspect_ratio;                          ///< Longest edge over 2 sqrt(6) inradii.
  std::vector<std::array<std::int64_t, 3>> boundary;  ///< The boundary faces, outward.
  std::vector<Violation> violations;
};

/// Orientation of every cell, conformity by matching faces (one or two cells each, two with
/// opposite orientation), coincident and unused vertices, closed edge-manifold boundary. Vertex
/// numbers of cells must be in range. Takes some 20 bytes a cell beside the mesh. The same result
/// for any number of threads. Throws Error(kInput) for more than 2^32 vertices.
VolumeCheck check_volume(const TetMesh& mesh, const Progress& progress = {});

struct SurfaceCheck {
  std::int64_t vertices = 0;
  std::int64_t triangles = 0;
  bool closed = false;
  bool manifold = false;
  double enclosed_volume = 0;  ///< By the divergence theorem.
  double area = 0;
  std::array<std::int64_t, kPatchCount> faces_by_patch{};
  std::vector<Violation> violations;
};

/// Finite, closed, oriented and edge-manifold; sides lie on the sides of the bounding box, walls
/// are vertical, ground and roofs face down, the roof of each building is flat, buildings are named
/// where they must be and nowhere else, and roof and wall faces that share an edge name the same
/// one.
SurfaceCheck check_surface(const SurfaceMesh& surface);

/// Whether the faces of `surface` are exactly the boundary faces of the volume, by coordinates (0
/// and -0 are the same; what is not finite is the same if its bits are).
std::vector<Violation> check_same_boundary(const TetMesh& mesh, const VolumeCheck& volume,
                                           const SurfaceMesh& surface);

/// Whether `region` names, for every cell, the building in whose footprint the cell's centre lies,
/// or -1; a mesh without `region` is a violation. `shift` is added to the mesh's coordinates to get
/// to the local frame of `city`.
std::vector<Violation> check_regions_of_cells(const TetMesh& mesh, std::array<double, 3> shift,
                                              const CityModel& city);

struct HeightsCheck {
  std::int64_t ground_vertices = 0;
  std::int64_t roof_vertices = 0;
  std::int64_t lowered = 0;  ///< Ground vertices on walls below the DTM by more than the tolerance.
  std::vector<Violation> violations;
};

/// Guarantee 6: |z - DTM| <= 1e-9 m at ground vertices (except below it on walls), |z - h_roof| <=
/// 1e-9 m at roof vertices. `shift` is added to the surface's coordinates to get to the local frame
/// of `dtm` and `city`. Ground vertices that are not finite are violations.
HeightsCheck check_heights(const SurfaceMesh& surface, std::array<double, 3> shift,
                           const Raster& dtm, const CityModel& city);

struct CityCheck {
  std::int64_t buildings = 0;
  std::int64_t dropped = 0;
  double min_clearance = 0;  ///< Between vertices, and vertices and edges, of all rings; metres.
  double area = 0;           ///< Of all footprints, square metres.
  std::vector<Violation> violations;
};

/// Guarantees 1 and 2 on a written city model: each source id once, footprints simple, oriented and
/// disjoint, roofs above ground, and clearance at least `min_distance` between all rings and to the
/// domain's boundary. Without `min_distance` (a raw model) footprints may touch and overlap.
CityCheck check_city(const CityModel& city, std::optional<double> min_distance);

}  // namespace tetropolis
