// What the writers of volume formats share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/placement.h"
#include "tetropolis/volume/boundary.h"
#include "tetropolis/volume/column_mesh.h"

namespace tetropolis {

/// Appends x, y, z of the nodes of the vertices [begin, end), shifted, as raw doubles.
void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer);

/// Throws Error(kGuarantee) unless `surface` has node and cell numbers of `mesh`, and at each point
/// of the surface is the node it names.
void require_boundary_of(const ColumnMesh& mesh, const SurfaceMesh& surface);

}  // namespace tetropolis
