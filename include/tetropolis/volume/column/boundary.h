// The boundary of the volume as a triangle mesh, every face tagged.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/patch.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// A triangle surface with its own, gapless vertex numbering.
struct SurfaceMesh {
  std::vector<std::array<double, 3>> points;           ///< Local frame, metres.
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< Of a boundary: counter-clockwise seen
                                                       ///< from outside the meshed volume, normals
                                                       ///< leave the air.
  std::vector<Patch> patch;             ///< Per triangle; ascending, so patches are consecutive.
  PatchTable patches;                   ///< All that `patch` may have.
  std::vector<BuildingIndex> building;  ///< Per triangle: for roofs and walls the building, else
                                        ///< kNoBuilding.
  std::vector<NodeIndex> node;          ///< Per point: its number in the volume mesh; empty if the
                                        ///< surface was read from a file.
  std::vector<CellIndex> cell;          ///< Per triangle: the cell behind it; likewise.

  const PatchInfo& patch_of(std::size_t f) const { return patches.of(patch[f]); }
};

/// The boundary of `mesh`. Every face that belongs to one cell only is there once. Throws
/// Error(kGuarantee) naming the edge if one on the rim of the ground mesh is not tagged with a side
/// of the domain.
SurfaceMesh extract_boundary(const ColumnMesh& mesh);

/// The faces of some patches only, renumbered.
SurfaceMesh select_patches(const SurfaceMesh& surface, std::span<const Patch> patches);

/// Ground, roofs and walls of a boundary as people look at them: its solid patches, renumbered, and
/// turned round, so normals point into the air.
SurfaceMesh city_surface(const SurfaceMesh& boundary);

struct PatchCount {
  std::string name;
  std::int64_t faces = 0;
  friend bool operator==(const PatchCount&, const PatchCount&) = default;
};

/// Number of faces of each patch of `surface.patches`, also of those without faces.
std::vector<PatchCount> count_by_patch(const SurfaceMesh& surface);

/// Whether every edge has exactly two faces that run along it in opposite directions (closed,
/// oriented, edge-manifold); otherwise the number of edges that break it.
struct SurfaceTopology {
  std::int64_t open_edges = 0;          ///< Edges with one face.
  std::int64_t non_manifold_edges = 0;  ///< Edges with more than two faces.
  std::int64_t misoriented_edges = 0;   ///< Edges with two faces in the same direction.
  bool closed() const { return open_edges == 0; }
  bool manifold() const { return non_manifold_edges == 0 && misoriented_edges == 0; }
};
SurfaceTopology check_topology(const SurfaceMesh& surface);

}  // namespace tetropolis
