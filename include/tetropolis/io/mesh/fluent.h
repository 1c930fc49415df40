// Fluent's mesh format, as text. Format: Ansys Fluent User's Guide, appendix "Mesh File Format".
#pragma once

#include <filesystem>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Writes nodes and cells numbered as write_vtu does, from 1; the cell zone "air"; interior faces,
/// in one zone, and a face zone per patch with faces: its name, and the type wall or, for top and
/// sides, symmetry, to be set in the solver. Numbers of nodes are written so that they read back
/// exactly. Placement::origin is in a comment. With `zones` each that has cells is a cell zone of
/// its name; cells are then numbered zone by zone, those of "air" first.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams as
/// write_openfoam does. The file appears complete or not at all. Throws Error(kInput) if it cannot
/// be written, Cancelled.
void write_fluent(const std::filesystem::path& path, const ColumnMesh& mesh,
                  const SurfaceMesh& surface, const Placement& placement,
                  const Progress& progress = {}, const CellZones& zones = {});

}  // namespace tetropolis
