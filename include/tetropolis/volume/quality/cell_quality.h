// Quality of the cells of a column mesh.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/quality_histogram.h"

namespace tetropolis {

/// Bounds of dihedral angles, degrees.
struct AngleBounds {
  double least = 0;
  double greatest = 180;
};

/// What all cells of a good mesh keep to.
inline constexpr AngleBounds kQualityFloor{8, 160};
/// And the least angle, degrees, of all but so small a share of them.
inline constexpr double kLeastOfMost = 12;
inline constexpr double kShareOfFew = 1e-4;

/// A cell that is far from regular, and why.
struct WorstCell {
  double share_of_floor = 0;  ///< The lesser of min_dihedral_deg over kLeastOfMost and of
                              ///< 180 - max_dihedral_deg over 180 less that of kQualityFloor: below
                              ///< 1 for the cells that a mesh may have few or none of.
  double min_dihedral_deg = 0;
  double max_dihedral_deg = 0;
  Point3 centre{};           ///< Local frame, metres.
  TriangleIndex triangle{};  ///< That it stands over.
  /// "buried roof": beside a building, the ground rises above its roof by more than twice the
  /// triangle's altitude; "steep ground": the floor of its stack rises by more than the triangle's
  /// altitude; "low wall": beside a building, a wall or roof segment shorter than that altitude;
  /// "small detail": the altitude is less than half the cell's vertical edge; "change of size":
  /// none of these.
  std::string_view cause;
};

struct CellQuality {
  QualityHistogram histogram;
  std::vector<WorstCell> worst;  ///< Worst first.
};

/// Over all cells of the mesh, which is valid (require_valid); lists the `worst` worst ones. The
/// same bits for any number of threads.
CellQuality measure_cells(const ColumnMesh& mesh, std::size_t worst = 0);

}  // namespace tetropolis
