// CGNS, in HDF5: what Star-CCM+, Fluent, Tecplot, ParaView and Pointwise read.
// Format: CGNS Standard Interface Data Structures 3.4 and its file mapping for HDF5 (cgns.org).
#pragma once

#include <filesystem>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Writes the base "Base" with the unstructured zone "Zone1": nodes numbered as write_vtu does,
/// from 1; the section "air" of tets, the section "air_layers" of prisms, then a section of
/// triangles per patch and one of quads, "quads_" and the number of the patch (the patch's name
/// where there are no triangles; normals leave the air), all in double precision and 32-bit
/// numbers. Each patch with faces is a family of its name (BCWall or BCFarfield) and a boundary
/// condition of that family on its faces. Placement::origin is the descriptor "origin" of the base.
///
/// Cells in `zones` come after all others, in their order: a section of the zone's name, and one
/// "layers_N" (N from 1 on: its place among the zones) for prisms where it has tets, too. The
/// ZoneSubRegion_t "zone_N" has them all, with the family of the zone's name.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams as
/// write_xdmf does. The file appears complete or not at all. Throws Error(kInput) if it cannot be
/// written, also for more elements than 32 bits count; Cancelled.
void write_cgns(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement,
                const Progress& progress = {}, const CellZones& zones = {});

}  // namespace tetropolis
