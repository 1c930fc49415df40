// The cells over some triangles, one by one.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/cell_quality.h"

namespace tetropolis {

/// As in WorstCell.
double share_of_floor(double least_deg, double greatest_deg);

/// The bounds that cells of this share of the floor keep to.
AngleBounds angles_at(double share_of_floor);

struct CellExtremes {
  double greatest_cosine = -1, least_cosine = 1;  ///< Of the least and greatest dihedral angle.
  double aspect_ratio = 0;                        ///< The greatest.
  std::vector<WorstCell> worst;                   ///< Worst first.
};

/// Lists the `worst` worst. The same bits for any number of threads.
CellExtremes cells_over(const ColumnMesh& mesh, std::span<const TriangleIndex> triangles,
                        std::size_t worst);

}  // namespace tetropolis
