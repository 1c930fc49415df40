// VTK HDF: what ParaView 5.11 and VTK 9.2 and later read as fast as anything.
// Format: VTK File Formats (Kitware), "VTKHDF File Format", version 2.0, UnstructuredGrid.
#pragma once

#include <filesystem>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Writes what write_vtu does: points and cells in the same order, the cell data `region` and, with
/// zones, `zone`, and the field data `origin` (three numbers). Streams as write_xdmf does. The file
/// appears complete or not at all. Throws Error(kInput) if it cannot be written, Cancelled.
void write_vtkhdf(const std::filesystem::path& path, const ColumnMesh& mesh,
                  const Placement& placement, const Progress& progress = {},
                  const CellZones& zones = {});

}  // namespace tetropolis
