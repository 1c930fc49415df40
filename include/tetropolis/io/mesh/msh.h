// Gmsh's mesh format, MSH 4.1 (binary, little endian) and 2.2 (text).
// Format: Geuzaine & Remacle, Gmsh Reference Manual, "MSH file format".
#pragma once

#include <filesystem>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Number of the physical volume "air". Volumes and surfaces are numbered apart.
inline constexpr int kAirPhysicalGroup = 9;

/// Writes the cells as physical volume 9, "air", and the faces of `surface` as physical surfaces
/// with the numbers and names of their patches; patches without faces are left out. Each group is
/// one discrete entity of the same number. Nodes are numbered from 1 in the order of write_vtu;
/// elements from 1: first triangles and quads in the order of `surface` (normals leave the air),
/// then tets and prisms in the order of write_vtu. Placement::origin is in a $Comments section.
/// `zones` are physical volumes 10, 11, ... with their names: of them, not of "air", are the cells
/// in them; zones without cells are left out, and elements come volume by volume.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams as
/// write_xdmf does. The file appears complete or not at all. Throws Error(kInput) if it cannot be
/// written, Cancelled.
void write_msh(const std::filesystem::path& path, const ColumnMesh& mesh,
               const SurfaceMesh& surface, const Placement& placement,
               const Progress& progress = {}, const CellZones& zones = {});

/// The same as text in MSH 2.2, which gmshToFoam and older programs read: groups and entities,
/// nodes and elements have the same numbers (elements are in the order of their numbers). Numbers
/// are written so that they read back exactly.
void write_msh2(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement,
                const Progress& progress = {}, const CellZones& zones = {});

}  // namespace tetropolis
