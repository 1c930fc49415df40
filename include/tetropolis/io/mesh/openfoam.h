// OpenFOAM's polyMesh: faces with the cells on their two sides.
// Format: OpenFOAM User Guide, "Mesh description"; face order: openfoamwiki.net, "Write OpenFOAM
// meshes". Binary lists with 32-bit labels and 64-bit scalars, little endian, as `arch` in each
// header tells; OpenFOAM versions of both lines read them since 2016 whatever their own widths are.
#pragma once

#include <filesystem>
#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Writes the files points, faces, owner, neighbour and boundary into `folder`
/// (CASE/constant/polyMesh), which is created if not there. Points and cells are in the order of
/// write_vtu.
///
/// Faces are triangles, and quads at the sides of prisms: internal ones in upper-triangular order
/// (by owner, then neighbour, owner < neighbour, normals from owner to neighbour), then those of
/// `surface`, patch by patch in its order, normals leaving the air. All of surface.patches are
/// there, in their order and even without faces, so one set of boundary conditions serves every
/// city; solid ones (ground, roof, wall) have the type `wall`, the others `patch`.
/// The `note` in the header of points has Placement::origin and the town: the box of the buildings,
/// wider by the height of the highest roof above the lowest ground at a wall; of `buildings`, if
/// they are given, by that of the highest roof that no planned building has. Faces of the ground
/// within the town are the first of theirs.
///
/// `zones`, if there are any, are written into the file cellZones, even those without cells, each
/// with the further entries height, base (metres) and leafAreaDensity (1/m), which OpenFOAM skips;
/// without any, a file cellZones of an earlier mesh is removed.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams: memory
/// beside mesh and surface is a few numbers per ground vertex, triangle and boundary point. The
/// files appear when all are complete. Throws Error(kInput) if they cannot be written or the mesh
/// has more face corners than a 32-bit label can count (about 350 million cells), Cancelled.
void write_openfoam(const std::filesystem::path& folder, const ColumnMesh& mesh,
                    const SurfaceMesh& surface, const Placement& placement,
                    const Progress& progress = {}, const CellZones& zones = {},
                    std::span<const Building> buildings = {});

}  // namespace tetropolis
