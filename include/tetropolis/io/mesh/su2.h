// SU2's native mesh format, text. Format: SU2 documentation, "Mesh File".
#pragma once

#include <filesystem>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Writes nodes and cells numbered as write_vtu does, and a marker per patch with faces, of its
/// name. Numbers of nodes are written so that they read back exactly. Placement::origin is in a
/// comment.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams as
/// write_msh does. The file appears complete or not at all. Throws Error(kInput) if it cannot be
/// written, Cancelled.
void write_su2(const std::filesystem::path& path, const ColumnMesh& mesh,
               const SurfaceMesh& surface, const Placement& placement,
               const Progress& progress = {});

}  // namespace tetropolis
